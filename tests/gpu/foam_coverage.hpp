#pragma once
#include "client/gpu/render_target.hpp"
#include "client/gpu/renderer.hpp"
#include "tests/gpu/fixture_sea.hpp"

namespace trochoid {

/// How much of an open sea the viewer's shaders whiten, measured in pictures straight down.
class FoamCoverage {
public:
    /// A sea without borders whose own waves tell of a wind of `wind_m_s`, 3 to 35 m/s. Needs a current OpenGL context.
    explicit FoamCoverage(double wind_m_s);

    /// Mean share of foam, 0 to 1, over a square of `side_m`, `moments` moments, each `apart_s` after the one before. The first
    /// comes after 12 s, which foam takes to become as much as it ever is.
    double mean(double side_m, int moments, double apart_s);
    /// The same picture once more in colours, with the share of foam of each of its pixels.
    struct Look {
        Picture colours;
        std::vector<double> share;
    };
    Look look(double side_m, double hour);
    /// Wind at 10 m that the viewer takes from the waves, m/s.
    double wind_m_s() const { return wind_m_s_; }

    static constexpr uint32_t pixels = 256;

private:
    void pass_time(double seconds, const Camera& camera);
    Picture draw(const RenderTarget& target, const Camera& camera, const DrawOptions& options);

    FixtureSource source_{TerrainGrid{}};
    Renderer renderer_;
    RenderTarget target_{pixels, pixels, 1};
    RenderTarget unseen_{16, 16, 1};  // between the moments nobody looks, but foam goes on
    SeaTime now_{60'000'000};
    double wind_m_s_ = 0;
};

/// Share of the sea under whitecaps, W = 2.95e-6 U^3.52 (Monahan and O'Muircheartaigh 1980).
double monahan_share(double wind_m_s);

}  // namespace trochoid
