#pragma once
#include <bit>
#include <cstdint>
#include <cstdio>
#include <span>
#include <string>
#include <string_view>
#include <utility>

#include "protocol/units/sea_time.hpp"

namespace trochoid {

/// What a build computed, value by value in a fixed order: the hash of it all, and on request every value as a line
/// "SCENE<tab>STAGE<tab>PLACE<tab>TICK<tab>FIELD<tab>TYPE:HEX". Place is a tile, a box, a block or a point; tick is sea time in us;
/// rows of numbers are one line, "TYPE*COLUMNS:HEX…".
class Trace {
public:
    /// `lines` may be null: hashes alone. Not owned.
    Trace(std::string scene, std::FILE* lines) : scene_(std::move(scene)), lines_(lines) {}
    Trace(const Trace&) = delete;
    Trace& operator=(const Trace&) = delete;

    /// Ends the stage before (printing its hash) and begins one.
    void begin_stage(std::string_view stage);
    void at(std::string place, SeaTime tick) {
        name_place(std::move(place), tick);
        mix_place();
    }
    /// Where the values to come are from, for lines and disagreements.
    void name_place(std::string place, SeaTime tick);
    /// Takes the place into the hash.
    void mix_place();
    /// Two ways of computing one value on this machine differ: says so on the error stream (the first few of a stage), and counts.
    void disagree(std::string_view field, std::string_view what);
    uint64_t disagreements() const { return disagreements_; }
    void f32(std::string_view field, float v) { put(field, "f32", std::bit_cast<uint32_t>(v), 8); }
    void f64(std::string_view field, double v) { put(field, "f64", std::bit_cast<uint64_t>(v), 16); }
    void i64(std::string_view field, int64_t v) { put(field, "i64", static_cast<uint64_t>(v), 16); }
    void u64(std::string_view field, uint64_t v) { put(field, "u64", v, 16); }
    void u32(std::string_view field, uint32_t v) { put(field, "u32", v, 8); }
    /// Rows of numbers, `columns` to a row.
    void rows(std::string_view field, std::span<const int32_t> values, int columns);
    void rows(std::string_view field, std::span<const uint16_t> values, int columns);
    /// Ends the last stage.
    void finish();

private:
    /// One product a value: under an emulator a byte-wise hash would cost more than what it watches.
    void mix(uint64_t v) {
        hash_ = (hash_ ^ v) * 0x9e3779b97f4a7c15ULL;
        hash_ ^= hash_ >> 32;
    }
    void put(std::string_view field, std::string_view type, uint64_t bits, int digits);
    void begin_line(std::string_view field);
    template <class T>
    void put_rows(std::string_view field, std::string_view type, std::span<const T> values, int columns);

    std::string scene_;
    std::FILE* lines_ = nullptr;
    std::string stage_;
    std::string place_;
    SeaTime tick_;
    uint64_t hash_ = 0;
    uint64_t values_ = 0;
    uint64_t disagreements_ = 0;
    uint64_t disagreements_before_ = 0;  // of the stages before
};

}  // namespace trochoid
