// The viewer's command line: what it means, whose word counts, and what it refuses.
#include <gtest/gtest.h>

#include "client/scene/presets.hpp"
#include "protocol/units/operator_error.hpp"
#include "tests/unit/viewer/parsed.hpp"

namespace trochoid {
namespace {

TEST(ViewerOptions, read_places_sizes_and_debug_views) {
    const auto options = parsed({"--camera=100.5,30,-2000,180,-5", "--size=640x360", "--debug=boxes,rays",
                                 "--quality=low", "--offscreen"});
    ASSERT_TRUE(options);
    EXPECT_EQ(options->camera.position, (LatticePoint{to_lattice(100.5), to_lattice(-2'000)}));
    EXPECT_DOUBLE_EQ(options->camera.altitude_m, 30);
    EXPECT_EQ(options->camera.width, 640U);
    EXPECT_TRUE(options->draw.rays);
    EXPECT_FALSE(options->draw.patches);
    EXPECT_EQ(options->draw.layers, displayed_layers);
    EXPECT_EQ(parsed({"--layers=-noise,-round"})->draw.layers,
              displayed_layers.without(Layer::noise).without(Layer::round));
    EXPECT_GT(options->draw.error_px, DrawOptions{}.error_px);
    EXPECT_GT(options->seconds, 0);
    EXPECT_EQ(parsed({"--offscreen", "--frames=7"})->seconds, 0) << "frames are an end of their own";
}

TEST(ViewerOptions, choose_every_method) {
    const auto o = parsed({"--mesher",
                           "projected",
                           "--displacement",
                           "fft",
                           "--far",
                           "texture",
                           "--refine",
                           "screen",
                           "--grid",
                           "64x0.5",
                           "--projected",
                           "100x160",
                           "--attention",
                           "2",
                           "--most-triangles",
                           "5000",
                           "--coherent-land",
                           "--hour",
                           "7:30",
                           "--error-px",
                           "3",
                           "--samples",
                           "2",
                           "--no-spray",
                           "--no-foam-history",
                           "--no-ships",
                           "--no-land",
                           "--no-sky",
                           "--no-far-sea",
                           "--birds-eye",
                           "--freeze",
                           "--at",
                           "-5",
                           "--fixed-step",
                           "0.5"});
    const DrawOptions& d = o->draw;
    EXPECT_EQ(d.mesher, MesherKind::projected);
    EXPECT_EQ(d.displacement, Displacement::fft);
    EXPECT_EQ(d.far_method, FarMethod::texture);
    EXPECT_EQ(d.refinement, Refinement::screen);
    EXPECT_EQ(d.grid_cells, 64U);
    EXPECT_FLOAT_EQ(d.grid_spacing_m, 0.5F);
    EXPECT_EQ(d.projected_rows, 100U);
    EXPECT_EQ(d.projected_columns, 160U);
    EXPECT_FLOAT_EQ(d.attention, 2.0F);
    EXPECT_EQ(d.most_triangles, 5000U);
    EXPECT_DOUBLE_EQ(d.hour, 7.5);
    EXPECT_FLOAT_EQ(d.error_px, 3.0F);
    EXPECT_EQ(d.samples, 2U);
    EXPECT_TRUE(d.coherent_land);
    EXPECT_FALSE(d.spray || d.foam_history || d.ships || d.land || d.sky || d.far_sea);
    EXPECT_TRUE(o->birds_eye && o->freeze);
    EXPECT_EQ(o->at_s, -5.0);
    EXPECT_EQ(o->fixed_step_s, 0.5);
    EXPECT_DOUBLE_EQ(parsed({"--target-fps", "50"})->target_ms, 20.0);
    EXPECT_DOUBLE_EQ(parsed({"--target-ms", "12"})->target_ms, 12.0);
}

TEST(ViewerOptions, detail_is_left_to_the_renderer_unless_it_is_named) {
    EXPECT_FALSE(parsed({})->lean);
    EXPECT_FALSE(parsed({"--detail", "auto"})->lean);
    EXPECT_EQ(parsed({"--detail", "full"})->lean, false);
    EXPECT_EQ(parsed({"--detail", "lean"})->lean, true);
    EXPECT_THROW(parsed({"--detail", "some"}), OperatorError);
    EXPECT_FALSE(parsed({})->draw.time_passes);
    EXPECT_TRUE(parsed({"--time-passes"})->draw.time_passes);
}

TEST(ViewerOptions, presets_come_first_and_words_win) {
    for (const Preset& preset : presets()) {
        const auto options = parsed({"--preset", std::string(preset.name)});
        EXPECT_EQ(options->preset, preset.name);
        EXPECT_DOUBLE_EQ(options->draw.hour, preset.hour);
        EXPECT_EQ(options->quality, preset.quality);
        EXPECT_NEAR(options->camera.altitude_m, preset.camera[1], 1e-9);
        const auto own = parsed({"--preset", std::string(preset.name), "--hour", "3", "--quality", "high",
                                 "--camera", "1,2,3,4,5"});
        EXPECT_DOUBLE_EQ(own->draw.hour, 3);
        EXPECT_EQ(own->quality, Quality::high);
        EXPECT_EQ(own->draw.samples, options_for(Quality::high).samples);
        EXPECT_DOUBLE_EQ(own->camera.altitude_m, 2);
    }
}

TEST(ViewerOptions, a_window_takes_what_the_last_one_left) {
    ViewerSettings kept;
    kept.width = 900;
    kept.quality = Quality::high;
    kept.mesher = MesherKind::uniform;
    kept.target_ms = 21;
    kept.numbers = true;
    const auto window = parsed({}, kept);
    EXPECT_EQ(window->camera.width, 900U);
    EXPECT_EQ(window->draw.mesher, MesherKind::uniform);
    EXPECT_EQ(window->draw.samples, options_for(Quality::high).samples);
    EXPECT_DOUBLE_EQ(window->target_ms, 21);
    EXPECT_TRUE(window->panels.numbers);
    const auto named = parsed({"--mesher=patches", "--size=700x500"}, kept);
    EXPECT_EQ(named->camera.width, 700U);
    EXPECT_EQ(named->draw.mesher, MesherKind::patches);
    // Pictures must not depend on what somebody once did in a window.
    EXPECT_EQ(parsed({"--offscreen"}, kept), parsed({"--offscreen"}));
    EXPECT_EQ(parsed({"--no-settings"}, kept), parsed({"--no-settings"}));
    EXPECT_TRUE(window->keeps_settings);
    EXPECT_FALSE(parsed({"--no-settings"})->keeps_settings);
    EXPECT_FALSE(parsed({"--offscreen"})->keeps_settings);
}

/// What is said about words that make no sense.
std::string refusal(const std::vector<std::string>& words) {
    try {
        parsed(words);
    } catch (const OperatorError& error) {
        return error.what();
    }
    ADD_FAILURE() << words[0] << " was taken";
    return {};
}

TEST(ViewerOptions, refuse_what_makes_no_sense) {
    for (const char* word : {"--camera=1,2,3",
                             "--camera=1e300,2,3,0,0",
                             "--camera=0,2,0,nan,0",
                             "--size=0x0",
                             "--size=640x360x2",
                             "--debug=everything",
                             "--quality=best",
                             "--layers=waves",
                             "--seconds=-1",
                             "--second-picture=x.png",
                             "--unheard-of",
                             "--grid=1x2",
                             "--grid=64x0",
                             "--grid=64",
                             "--grid=64xnan",
                             "--grid=64x3",
                             "--grid=64x128",
                             "--grid=64x0.03125",
                             "--grid=100x2",
                             "--grid=0x2",
                             "--grid=2048x2",
                             "--camera=0,0.4,0,0,0",
                             "--camera=0,3001,0,0,0",
                             "--size=15x16",
                             "--size=16385x16",
                             "--projected=1x1",
                             "--attention=9",
                             "--hour=25",
                             "--hour=noon",
                             "--hour=12:75",
                             "--hour=-1",
                             "--frames=-3",
                             "--fixed-step=-1",
                             "--at=inf",
                             "--target-ms=0",
                             "--samples=0",
                             "--scale=2",
                             "--error-px=0",
                             "--most-triangles=1",
                             "--text-scale=-1",
                             "--preset=doldrums"})
        EXPECT_FALSE(refusal({word}).empty()) << word;
    EXPECT_FALSE(refusal({"--target-ms=10", "--target-fps=10"}).empty());
    EXPECT_FALSE(refusal({"--offscreen", "--full-screen"}).empty());
}

TEST(ViewerOptions, what_they_take_is_what_is_drawn) {
    EXPECT_DOUBLE_EQ(parsed({"--camera=0,0.5,0,0,0"})->camera.altitude_m, 0.5);
    EXPECT_DOUBLE_EQ(parsed({"--camera=0,3000,0,0,0"})->camera.altitude_m, 3000);
    for (const char* spacing : {"0.0625", "0.5", "1", "64"})
        EXPECT_FLOAT_EQ(parsed({std::string("--grid=1024x") + spacing})->draw.grid_spacing_m,
                        std::stof(spacing));
    EXPECT_EQ(parsed({"--size=16384x16"})->camera.width, 16'384U);
}

TEST(ViewerOptions, say_what_there_is_where_a_name_is_not) {
    EXPECT_NE(refusal({"--mesher=triangles"}).find("patches, uniform, projected and coherent"),
              std::string::npos);
    EXPECT_NE(refusal({"--displacement=waves"}).find("trains, noise and fft"), std::string::npos);
    EXPECT_NE(refusal({"--far=away"}).find("combined, spectrum and texture"), std::string::npos);
    EXPECT_NE(refusal({"--refine=oil"}).find("distance, screen and frustum"), std::string::npos);
    EXPECT_NE(refusal({"--quality=best"}).find("low, medium and high"), std::string::npos);
    EXPECT_NE(refusal({"--camera=0,1e5,0,0,0"}).find("100000 m, is not within 0.5 to 3000 m"),
              std::string::npos);
    EXPECT_NE(refusal({"--grid=256x3"}).find("a power of two from 0.0625 to 64 m"), std::string::npos);
    EXPECT_NE(refusal({"--size=20000x20"}).find("16 to 16384"), std::string::npos);
    EXPECT_NE(refusal({"--preset=doldrums"}).find("calm, breeze, gale, storm, harbour"), std::string::npos);
}

}  // namespace
}  // namespace trochoid
