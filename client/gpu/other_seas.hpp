#pragma once
#include <memory>

#include "client/gpu/gl_objects.hpp"
#include "client/scene/draw_options.hpp"
#include "client/scene/fft_sea.hpp"
#include "client/scene/sea_weather.hpp"
#include "protocol/model/surface_noise.hpp"
#include "protocol/units/sea_time.hpp"

namespace trochoid {

/// What displaces the mesh in place of the wave trains (Displacement): gradient noise or a Fourier tile, as high and as long as the
/// sea at the camera. Uploads nothing while the trains do it.
class OtherSeas {
public:
    OtherSeas();
    /// Makes this moment's tables and binds them.
    void prepare(Displacement displacement, const SeaWeather& weather, SeaTime now);

private:
    struct Block;
    void fill_noise(Block& block, const SeaWeather& weather, SeaTime now);
    void fill_fft(Block& block, const SeaWeather& weather, SeaTime now);

    GlBuffer block_;
    GlTexture displaced_;
    GlTexture slopes_;
    std::unique_ptr<FftSea> fft_;
    SurfaceNoise noise_;
    float noise_height_ = -1;  // significant height that noise_ was made for, m
};

}  // namespace trochoid
