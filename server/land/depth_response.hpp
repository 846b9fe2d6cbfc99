#pragma once
#include "server/land/land_settings.hpp"

namespace trochoid {

/// What depth does to waves of one wave length that come from the open sea: the reference is the sea outside the terrain, so
/// water at least as deep as `deep` (one wave length, or the open sea's depth where that is less) changes nothing.
class DepthResponse {
public:
    /// turns_per_metre: 1 / wave length in the open sea, open_depth metres deep; height: the box's significant height in metres.
    DepthResponse(double turns_per_metre, double open_depth, double height, const LandSettings& settings);

    /// Depth in metres from which on wave number and growth are exactly the open sea's.
    double deep() const { return deep_; }
    /// Depth in metres from which on nothing at all changes: `deep`, or more where high waves break earlier.
    double untouched() const { return untouched_; }
    /// Depth in metres at and below which wave number and growth stay as they are there.
    double shallowest() const { return shallowest_; }

    /// k(D) / k of the open sea, >= 1, exactly 1 from `deep` on.
    double wave_number(double depth) const;
    /// Growth of the amplitude without breaking, exactly 1 from `deep` on, never below 0.
    double growth(double depth) const;
    /// Largest gain before the box's waves break, 0 on land; at least 2 where depth does not limit.
    double breaking_gain(double depth) const;
    /// Largest share of the open sea's height, before growth, that the depth lets pass: 0 on land, at most 1.
    double share_limit(double depth) const;
    /// Whether share_limit is surely 1 at this and all greater depths.
    bool all_passes_from(double depth) const;
    /// The same from the depth's breaking gain and growth.
    static double share_of(double gain, double growth) { return gain >= growth ? 1.0 : gain / growth; }
    /// Whether growth changes below the shallowest depth too.
    bool growth_falls_to_shore() const { return shoaling_ == Shoaling::decrease; }

private:
    Shoaling shoaling_;
    double kd_per_metre_;
    double deep_ = 0.0;
    double untouched_ = 0.0;
    double shallowest_ = 0.0;
    double wave_number_at_deep_ = 1.0;
    double growth_at_deep_ = 1.0;
    double paper_growth_;
    double shore_decrease_;
    double breaking_per_metre_ = 0.0;
};

}  // namespace trochoid
