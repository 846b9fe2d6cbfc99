#include "tests/determinism/trace.hpp"

#include <fmt/format.h>

#include <type_traits>

namespace trochoid {

void Trace::begin_stage(std::string_view stage) {
    finish();
    stage_ = stage;
    disagreements_before_ = disagreements_;
}

void Trace::finish() {
    if (stage_.empty()) return;
    fmt::print("{} {} {:016x} {}\n", scene_, stage_, hash_, values_);
    std::fflush(stdout);
    stage_.clear();
    hash_ = 0;
    values_ = 0;
}

void Trace::name_place(std::string place, SeaTime tick) {
    place_ = std::move(place);
    tick_ = tick;
}

void Trace::mix_place() {
    for (const char c : place_) mix(static_cast<uint8_t>(c));
    mix(static_cast<uint64_t>(tick_.us));
}

void Trace::disagree(std::string_view field, std::string_view what) {
    constexpr uint64_t most_told = 3;
    if (disagreements_++ - disagreements_before_ >= most_told) return;
    fmt::print(stderr, "error: scene {}, stage {}, {}, sea time {:.6f} s, field {}: {}\n", scene_, stage_,
               place_, static_cast<double>(tick_.us) * 1e-6, field, what);
}

void Trace::begin_line(std::string_view field) {
    fmt::print(lines_, "{}\t{}\t{}\t{}\t{}\t", scene_, stage_, place_, tick_.us, field);
}

void Trace::put(std::string_view field, std::string_view type, uint64_t bits, int digits) {
    mix(bits);
    ++values_;
    if (lines_ == nullptr) return;
    begin_line(field);
    fmt::print(lines_, "{}:{:0{}x}\n", type, bits, digits);
}

template <class T>
void Trace::put_rows(std::string_view field, std::string_view type, std::span<const T> values, int columns) {
    for (const T v : values) mix(static_cast<uint32_t>(v));
    values_ += values.size();
    if (lines_ == nullptr) return;
    begin_line(field);
    std::string text;
    for (const T v : values)
        text += fmt::format("{:0{}x}", static_cast<std::make_unsigned_t<T>>(v), 2 * sizeof v);
    fmt::print(lines_, "{}*{}:{}\n", type, columns, text);
}

void Trace::rows(std::string_view field, std::span<const int32_t> values, int columns) {
    put_rows(field, "i32", values, columns);
}
void Trace::rows(std::string_view field, std::span<const uint16_t> values, int columns) {
    put_rows(field, "u16", values, columns);
}

}  // namespace trochoid
