#include "client/scene/fft_sea.hpp"

#include <fftw3.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace trochoid {

namespace {

constexpr double gravity = 9.81;
using Complex = std::complex<float>;

/// Wind at 19.5 m of a fully risen sea: Hs = 0.21 U^2 / g.
double wind_of_height(double significant_height) { return std::sqrt(significant_height * gravity / 0.21); }

/// Pierson and Moskowitz over the plane of wave vectors, with cos^2 spreading about the heading: m^4.
double spectrum_of(glm::dvec2 k, double wind, glm::dvec2 heading) {
    const double length = std::hypot(k.x, k.y);
    if (length == 0) return 0;
    const double along = (k.x * heading.x + k.y * heading.y) / length;
    if (along <= 0) return 0;
    const double omega = std::sqrt(gravity * length);
    const double by_omega = 8.1e-3 * gravity * gravity / std::pow(omega, 5.0) *
                            std::exp(-0.74 * std::pow(gravity / (wind * omega), 4.0));
    const double group_speed = 0.5 * gravity / omega;
    return by_omega * group_speed / length * (2.0 / std::numbers::pi) * along * along;
}

/// Two normal deviates by Box and Muller from a counter, the same with every standard library.
glm::dvec2 normal_pair(uint64_t counter) {
    const auto uniform = [](uint64_t v) {
        v = (v ^ (v >> 30U)) * 0xbf58476d1ce4e5b9U;
        v = (v ^ (v >> 27U)) * 0x94d049bb133111ebU;
        return (static_cast<double>((v ^ (v >> 31U)) >> 11U) + 0.5) * 0x1p-53;
    };
    const double radius = std::sqrt(-2 * std::log(uniform(2 * counter * 0x9e3779b97f4a7c15U)));
    const double angle = 2 * std::numbers::pi * uniform((2 * counter + 1) * 0x9e3779b97f4a7c15U);
    return {radius * std::cos(angle), radius * std::sin(angle)};
}

}  // namespace

double peak_wavelength_of(double significant_height) {
    const double omega = 2 * std::numbers::pi / peak_period_of(significant_height);
    return 2 * std::numbers::pi * gravity / (omega * omega);
}

double peak_period_of(double significant_height) {
    // d/d omega of the spectrum vanishes where omega = (0.8 * 0.74)^(1/4) g / U.
    return 2 * std::numbers::pi * wind_of_height(significant_height) / (std::pow(0.592, 0.25) * gravity);
}

/// FFTW's arrays and plan: four transforms in place, each of two real fields packed into one complex one.
struct FftSea::Transform {
    explicit Transform(uint32_t side) {
        const size_t count = size_t{side} * side;
        const auto n = static_cast<int>(side);
        for (fftwf_complex*& field : fields) field = fftwf_alloc_complex(count);
        plan = fftwf_plan_dft_2d(n, n, fields[0], fields[0], FFTW_BACKWARD, FFTW_ESTIMATE);
    }
    Transform(const Transform&) = delete;
    Transform& operator=(const Transform&) = delete;
    ~Transform() {
        fftwf_destroy_plan(plan);
        for (fftwf_complex* field : fields) fftwf_free(field);
    }
    void set(size_t field, size_t at, Complex value) const {
        fields[field][at][0] = value.real();
        fields[field][at][1] = value.imag();
    }
    std::array<fftwf_complex*, 4> fields{};
    fftwf_plan plan = nullptr;
};

FftSea::FftSea(const FftSeaSettings& settings)
    : settings_(settings), transform_(std::make_unique<Transform>(settings.side)) {
    const size_t count = size_t{settings.side} * settings.side;
    displaced_.resize(count);
    slopes_.resize(count);
    make_spectrum();
}

FftSea::~FftSea() = default;

void FftSea::make_spectrum() {
    const auto n = static_cast<int>(settings_.side);
    const double tile_m = std::ldexp(1.0, static_cast<int>(settings_.tile_log2) - 10);
    const double dk = 2 * std::numbers::pi / tile_m;
    const double wind = wind_of_height(std::max(static_cast<double>(settings_.significant_height), 1e-3));
    const auto count = static_cast<size_t>(n) * static_cast<size_t>(n);
    amplitude_.assign(count, Complex(0));
    omega_.assign(count, 0.0);
    std::vector<double> slopes(count, 0.0);
    double variance = 0;
    for (int row = 0; row < n; ++row)
        for (int column = 0; column < n; ++column) {
            const auto at = static_cast<size_t>(row) * static_cast<size_t>(n) + static_cast<size_t>(column);
            const glm::dvec2 k(dk * (column < n / 2 ? column : column - n),
                               dk * (row < n / 2 ? row : row - n));
            const glm::dvec2 dice_thrown = normal_pair((uint64_t{settings_.seed} << 32U) + at + 1);
            omega_[at] = std::sqrt(gravity * std::hypot(k.x, k.y));
            // The highest frequencies have no opposite number; they are left out.
            if (row == n / 2 || column == n / 2) continue;
            const double energy = spectrum_of(k, wind, glm::dvec2(settings_.heading)) * dk * dk;
            const double amplitude = std::sqrt(0.25 * energy);
            amplitude_[at] = Complex(static_cast<float>(dice_thrown.x * amplitude),
                                     static_cast<float>(dice_thrown.y * amplitude));
            // Each vector stands for itself and its opposite: twice |h0|^2.
            const double power = 2.0 * static_cast<double>(std::norm(amplitude_[at]));
            variance += power;
            slopes[at] = power * (k.x * k.x + k.y * k.y);
        }
    // What the dice and the tile's size have changed of the height is put right.
    const double wanted = static_cast<double>(settings_.significant_height) / 4.0;
    const double scale = variance > 0 ? wanted / std::sqrt(variance) : 0.0;
    for (Complex& a : amplitude_) a *= static_cast<float>(scale);
    for (size_t level = 0; level < slope_variance_.size(); ++level) {
        const int limit = n >> (level + 1);
        double sum = 0;
        for (int row = 0; row < n; ++row)
            for (int column = 0; column < n; ++column) {
                const int x = std::abs(column < n / 2 ? column : column - n);
                const int z = std::abs(row < n / 2 ? row : row - n);
                if (std::max(x, z) <= limit)
                    sum += slopes[static_cast<size_t>(row) * static_cast<size_t>(n) +
                                  static_cast<size_t>(column)];
            }
        slope_variance_[level] = static_cast<float>(sum * scale * scale);
    }
}

void FftSea::transform(double seconds) {
    const auto n = static_cast<size_t>(settings_.side);
    const auto half = static_cast<ptrdiff_t>(n / 2);
    const float dk = static_cast<float>(2 * std::numbers::pi /
                                        std::ldexp(1.0, static_cast<int>(settings_.tile_log2) - 10));
    constexpr Complex i(0, 1);
    for (size_t row = 0; row < n; ++row)
        for (size_t column = 0; column < n; ++column) {
            const size_t at = row * n + column;
            const size_t opposite = ((n - row) % n) * n + (n - column) % n;
            const double turn = std::fmod(omega_[at] * seconds, 2 * std::numbers::pi);
            const Complex wave(static_cast<float>(std::cos(turn)), static_cast<float>(-std::sin(turn)));
            const Complex h = amplitude_[at] * wave + std::conj(amplitude_[opposite] * wave);
            const auto signed_of = [half, n](size_t v) {
                const auto s = static_cast<ptrdiff_t>(v);
                return static_cast<float>(s < half ? s : s - static_cast<ptrdiff_t>(n));
            };
            const glm::vec2 k = glm::vec2(signed_of(column), signed_of(row)) * dk;
            const float length = std::max(std::hypot(k.x, k.y), 1e-9F);
            const Complex ax = -i * (k.x / length) * h;
            const Complex az = -i * (k.y / length) * h;
            transform_->set(0, at, h + i * ax);
            transform_->set(1, at, az + i * (k.x * k.y / length * h));
            transform_->set(2, at, i * k.x * h + i * (i * k.y * h));
            transform_->set(3, at, k.x * k.x / length * h + i * (k.y * k.y / length * h));
        }
    for (fftwf_complex* field : transform_->fields) fftwf_execute_dft(transform_->plan, field, field);
    const auto& f = transform_->fields;
    for (size_t at = 0; at < n * n; ++at) {
        displaced_[at] = {f[0][at][1], f[0][at][0], f[1][at][0], f[1][at][1]};
        slopes_[at] = {f[2][at][0], f[2][at][1], f[3][at][0], f[3][at][1]};
    }
}

}  // namespace trochoid
