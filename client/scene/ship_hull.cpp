#include "client/scene/ship_hull.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>

namespace trochoid {

namespace {

struct Paint {
    glm::vec3 colour;
    float gloss;
};
constexpr Paint antifouling{{0.170F, 0.035F, 0.025F}, 0.05F};
constexpr Paint navy{{0.022F, 0.040F, 0.075F}, 0.35F};
constexpr Paint white{{0.66F, 0.66F, 0.63F}, 0.12F};
constexpr Paint buff{{0.47F, 0.30F, 0.10F}, 0.12F};
constexpr Paint black{{0.02F, 0.02F, 0.02F}, 0.10F};
constexpr Paint deck_red{{0.150F, 0.070F, 0.048F}, 0.04F};
constexpr Paint teak{{0.30F, 0.19F, 0.10F}, 0.05F};
constexpr Paint hatch_grey{{0.23F, 0.25F, 0.24F}, 0.06F};
constexpr Paint glass{{0.012F, 0.016F, 0.020F}, 0.9F};

/// A hull's lines. Heights in lengths.
struct Lines {
    float draught;
    float freeboard;  ///< of the bulwark's top amidships
    float bow_sheer;  ///< rise towards the bow
    float stern_sheer;
    float bulwark;   ///< of the deck below its top
    float entrance;  ///< where the bow begins to taper, share of the length from the stern
    float transom;   ///< breadth at the stern, share of the beam
    Paint sides;
    Paint deck;
};

constexpr int hull_stations = 24;
constexpr int hull_levels = 6;

float smooth(float t) {
    t = std::clamp(t, 0.0F, 1.0F);
    return t * t * (3.0F - 2.0F * t);
}

class Yard {
public:
    std::vector<HullVertex> take() { return std::move(out_); }

    void hull(const Lines& lines) {
        for (const float side : {-1.0F, 1.0F}) plate(lines, side);
        stern(lines);
        deck(lines);
    }

    /// A block with its sides along the axes; its top may be shorter: `rake` is taken off the front's, `rear_rake` off the rear's.
    void block(glm::vec3 low, glm::vec3 high, const Paint& paint, float rake = 0, float rear_rake = 0) {
        const auto corner = [&](bool front, bool top, bool right) {
            const float x = front ? high.x - (top ? rake : 0.0F) : low.x + (top ? rear_rake : 0.0F);
            return glm::vec3(x, top ? high.y : low.y, right ? high.z : low.z);
        };
        const auto side = [&](glm::vec3 a, glm::vec3 b, glm::vec3 c, glm::vec3 d) {
            flat(a, b, c, d, paint);
        };
        side(corner(true, false, false), corner(true, false, true), corner(true, true, true),
             corner(true, true, false));
        side(corner(false, false, true), corner(false, false, false), corner(false, true, false),
             corner(false, true, true));
        side(corner(false, false, false), corner(true, false, false), corner(true, true, false),
             corner(false, true, false));
        side(corner(true, false, true), corner(false, false, true), corner(false, true, true),
             corner(true, true, true));
        side(corner(false, true, false), corner(true, true, false), corner(true, true, true),
             corner(false, true, true));
    }

    /// An upright tube with a lid. Radius in lengths.
    void tube(glm::vec3 foot, float radius, float height, const Paint& paint, float lean = 0) {
        constexpr int sides = 10;
        const auto at = [&](int i, bool top) {
            const float angle = 6.2831853F * static_cast<float>(i) / sides;
            return foot + glm::vec3(radius * std::cos(angle) - (top ? lean : 0.0F), top ? height : 0.0F,
                                    radius * hull_slimness * std::sin(angle));
        };
        const auto outward = [](int i) {
            const float angle = 6.2831853F * static_cast<float>(i) / sides;
            return glm::vec3(std::cos(angle), 0, std::sin(angle));
        };
        const glm::vec3 lid = foot + glm::vec3(-lean, height, 0);
        for (int i = 0; i < sides; ++i) {
            quad({at(i, false), at(i + 1, false), at(i + 1, true), at(i, true)},
                 {outward(i), outward(i + 1), outward(i + 1), outward(i)}, paint);
            for (const glm::vec3 p : {lid, at(i, true), at(i + 1, true)})
                out_.push_back({p, {0, 1, 0}, black.colour, 0.0F});
        }
    }

private:
    static float sheer(const Lines& l, float t) {
        const float ahead = std::max(0.0F, (t - 0.6F) / 0.4F);
        const float behind = std::max(0.0F, (0.25F - t) / 0.25F);
        return l.freeboard + l.bow_sheer * ahead * ahead + l.stern_sheer * behind * behind;
    }

    /// Half breadth in beams; level 0 = keel, 1 = bulwark's top.
    static float half_breadth(const Lines& l, float t, float level) {
        const float bow = std::clamp((t - l.entrance) / (1.0F - l.entrance), 0.0F, 1.0F);
        // Fine below, flared above.
        const float ahead = 1.0F - std::pow(bow, 1.5F + 1.6F * level);
        const float transom = l.transom * (0.55F + 0.45F * level);
        const float behind = transom + (1.0F - transom) * smooth(t / (0.34F - 0.16F * level));
        const float bilge = 0.80F + 0.20F * std::sqrt(std::min(1.0F, 2.2F * level));
        return 0.5F * ahead * behind * bilge;
    }

    /// A point of the plating; the stem rakes forward with the height.
    static glm::vec3 plating(const Lines& l, float t, int level, float side) {
        const float top = sheer(l, t);
        const std::array<float, hull_levels> heights{-l.draught,          -0.45F * l.draught, 0.0F,
                                                     0.16F * l.freeboard, 0.55F * top,        top};
        const float y = heights[static_cast<size_t>(level)];
        const float share = (y + l.draught) / (top + l.draught);
        const float overhang = 0.075F * (1.0F - share) * smooth((t - 0.62F) / 0.38F);
        return {t - 0.5F - overhang, y, side * half_breadth(l, t, share)};
    }

    static glm::vec3 in_lengths(glm::vec3 p) { return {p.x, p.y, p.z / hull_slimness}; }

    static glm::vec3 plating_normal(const Lines& l, float t, int level, float side) {
        const float e = 0.5F / hull_stations;
        const glm::vec3 along = in_lengths(plating(l, std::min(t + e, 1.0F), level, side)) -
                                in_lengths(plating(l, std::max(t - e, 0.0F), level, side));
        const glm::vec3 up = in_lengths(plating(l, t, std::min(level + 1, hull_levels - 1), side)) -
                             in_lengths(plating(l, t, std::max(level - 1, 0), side));
        const glm::vec3 n = glm::cross(along, up) * -side;
        return glm::length(n) > 1e-9F ? -glm::normalize(n) : glm::vec3(0, 0, side);
    }

    void plate(const Lines& l, float side) {
        for (int i = 0; i < hull_stations; ++i)
            for (int j = 0; j + 1 < hull_levels; ++j) {
                const float t0 = station(i);
                const float t1 = station(i + 1);
                quad({plating(l, t0, j, side), plating(l, t1, j, side), plating(l, t1, j + 1, side),
                      plating(l, t0, j + 1, side)},
                     {plating_normal(l, t0, j, side), plating_normal(l, t1, j, side),
                      plating_normal(l, t1, j + 1, side), plating_normal(l, t0, j + 1, side)},
                     j < 3 ? antifouling : l.sides);
            }
    }

    void stern(const Lines& l) {
        for (int j = 0; j + 1 < hull_levels; ++j)
            flat(plating(l, 0, j, 1), plating(l, 0, j, -1), plating(l, 0, j + 1, -1), plating(l, 0, j + 1, 1),
                 j < 3 ? antifouling : l.sides);
    }

    void deck(const Lines& l) {
        const auto edge = [&](float t, float side) {
            // On the flat plates between the two uppermost levels, and a little inside of them.
            const glm::vec3 top = plating(l, t, hull_levels - 1, side);
            const glm::vec3 below = plating(l, t, hull_levels - 2, side);
            glm::vec3 p = glm::mix(top, below, l.bulwark / (top.y - below.y));
            p.z *= 0.985F;
            return p;
        };
        for (int i = 0; i < hull_stations; ++i)
            flat(edge(station(i), -1), edge(station(i + 1), -1), edge(station(i + 1), 1), edge(station(i), 1),
                 l.deck);
    }

    /// Closer together towards the bow.
    static float station(int i) {
        const float s = static_cast<float>(i) / hull_stations;
        return s * (1.35F - 0.35F * s);
    }

    void flat(glm::vec3 a, glm::vec3 b, glm::vec3 c, glm::vec3 d, const Paint& paint) {
        glm::vec3 n = glm::cross(in_lengths(c) - in_lengths(a), in_lengths(d) - in_lengths(b));
        n = glm::length(n) > 1e-9F ? glm::normalize(n) : glm::vec3(0, 1, 0);
        // Decks, roofs and lids look up; what stands upright looks away from the inside by its order.
        if (n.y < -0.5F) n = -n;
        quad({a, b, c, d}, {n, n, n, n}, paint);
    }

    void quad(const std::array<glm::vec3, 4>& p, const std::array<glm::vec3, 4>& n, const Paint& paint) {
        for (const size_t i : {0U, 1U, 2U, 0U, 2U, 3U})
            out_.push_back({p[i], n[i], paint.colour, paint.gloss});
    }

    std::vector<HullVertex> out_;
};

}  // namespace

std::vector<HullVertex> freighter_hull() {
    const Lines lines{0.040F, 0.050F, 0.034F, 0.006F, 0.009F, 0.74F, 0.86F, navy, deck_red};
    Yard yard;
    yard.hull(lines);
    const float deck = lines.freeboard - lines.bulwark;
    // Hatches with their coamings, and the posts between.
    for (int i = 0; i < 4; ++i) {
        const float x = -0.20F + 0.135F * static_cast<float>(i);
        yard.block({x, deck - 0.01F, -0.30F}, {x + 0.105F, deck + 0.014F, 0.30F}, hatch_grey);
        if (i == 1 || i == 3) {
            yard.tube({x - 0.015F, deck, 0.0F}, 0.0045F, 0.095F, buff);
            yard.block({x - 0.013F, deck + 0.082F, -0.02F}, {x + 0.088F, deck + 0.087F, 0.02F}, buff);
        }
    }
    // Forecastle and its mast.
    yard.block({0.360F, deck - 0.01F, -0.22F}, {0.425F, deck + 0.022F, 0.22F}, deck_red, 0.004F);
    yard.tube({0.395F, deck, 0.0F}, 0.003F, 0.085F, white);
    // The house in tiers, each with a band of windows, and the bridge with its wings.
    yard.block({-0.400F, deck - 0.01F, -0.42F}, {-0.245F, deck + 0.028F, 0.42F}, white);
    yard.block({-0.375F, deck + 0.028F, -0.38F}, {-0.252F, deck + 0.052F, 0.38F}, white);
    yard.block({-0.360F, deck + 0.052F, -0.36F}, {-0.258F, deck + 0.076F, 0.36F}, white);
    yard.block({-0.310F, deck + 0.076F, -0.50F}, {-0.262F, deck + 0.098F, 0.50F}, white, 0.003F);
    yard.block({-0.304F, deck + 0.085F, -0.485F}, {-0.2595F, deck + 0.094F, 0.485F}, glass, 0.003F);
    for (const float y : {0.036F, 0.060F})
        for (int i = 0; i < 5; ++i) {
            const float z = -0.29F + 0.145F * static_cast<float>(i);
            yard.block({-0.30F, deck + y, z - 0.03F},
                       {-0.2505F - (y > 0.05F ? 0.006F : 0.0F), deck + y + 0.008F, z + 0.03F}, glass);
        }
    yard.block({-0.360F, deck + 0.036F, -0.384F}, {-0.270F, deck + 0.043F, 0.384F}, glass);
    yard.tube({-0.285F, deck + 0.098F, 0.0F}, 0.003F, 0.045F, white);
    // The funnel, its top black.
    yard.tube({-0.375F, deck + 0.026F, 0.0F}, 0.0185F, 0.082F, buff, 0.006F);
    yard.tube({-0.381F, deck + 0.108F, 0.0F}, 0.0188F, 0.016F, black, 0.001F);
    return yard.take();
}

std::vector<HullVertex> launch_hull() {
    const Lines lines{0.045F, 0.085F, 0.045F, 0.004F, 0.020F, 0.55F, 0.90F, white, teak};
    Yard yard;
    yard.hull(lines);
    const float deck = lines.freeboard - lines.bulwark;
    yard.block({-0.16F, deck - 0.02F, -0.33F}, {0.20F, deck + 0.050F, 0.33F}, white, 0.025F);
    yard.block({-0.155F, deck + 0.050F, -0.315F}, {0.155F, deck + 0.098F, 0.315F}, glass, 0.045F, 0.01F);
    yard.block({-0.185F, deck + 0.098F, -0.34F}, {0.125F, deck + 0.112F, 0.34F}, white);
    yard.block({0.19F, deck - 0.01F, -0.22F}, {0.31F, deck + 0.034F, 0.22F}, white, 0.05F);
    yard.block({-0.46F, deck - 0.03F, -0.30F}, {-0.40F, deck + 0.020F, 0.30F}, teak);
    yard.tube({-0.05F, deck + 0.112F, 0.0F}, 0.006F, 0.12F, white);
    return yard.take();
}

}  // namespace trochoid
