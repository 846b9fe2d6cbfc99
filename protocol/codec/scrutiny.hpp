#pragma once
#include <fmt/format.h>

#include <cmath>
#include <concepts>
#include <cstdint>
#include <limits>
#include <string>

#include "flatbuffers/flatbuffers.h"
#include "protocol/units/lattice.hpp"
#include "protocol/units/result.hpp"
#include "protocol/units/sea_time.hpp"

namespace trochoid {

/// Most bytes of a name, of a token, of a sentence for people (UTF-8, no control characters).
inline constexpr size_t longest_name = 256;
inline constexpr size_t longest_token = 1024;
inline constexpr size_t longest_sentence = 512;
/// A PROJ string.
inline constexpr size_t longest_projection = 4096;

/// Monotonic clock readings lie within ±2^56 us (2,283 years): with any rate no sea time overflows.
inline constexpr int64_t stamp_bound = int64_t{1} << 56;

/// Semantic validation while decoding. Values pass through; the first refusal is kept, so a decoder reads straight on and
/// asks once at its end. Names are those of the schema's fields.
class Scrutiny {
public:
    bool refused() const { return error_.code != ErrorCode::none; }
    const Error& error() const { return error_; }

    void refuse(ErrorCode code, std::string sentence) {
        if (!refused()) error_ = {code, std::move(sentence)};
    }
    void require(bool holds, const char* sentence, ErrorCode code = ErrorCode::value_out_of_range) {
        if (!holds) refuse(code, sentence);
    }
    /// Takes over a model value's own validation.
    void require(const Result<Done>& valid) {
        if (!valid) refuse(valid.error().code, valid.error().message);
    }

    /// A table, string or vector that the type demands: null is missing_field.
    template <class T>
    const T* present(const char* name, const T* value) {
        if (value == nullptr) refuse(ErrorCode::missing_field, fmt::format("{} is missing", name));
        return value;
    }

    template <std::integral T>
    T within(const char* name, T value, T least, T most) {
        if (value < least || value > most)
            refuse(ErrorCode::value_out_of_range,
                   fmt::format("{} is {}, not in {} to {}", name, value, least, most));
        return value;
    }
    template <std::floating_point T>
    T within(const char* name, T value, T least, T most) {
        if (!std::isfinite(value))
            refuse(ErrorCode::not_finite, fmt::format("{} is not finite", name));
        else if (value < least || value > most)
            refuse(ErrorCode::value_out_of_range,
                   fmt::format("{} is {}, not in {} to {}", name, value, least, most));
        return value;
    }
    float finite(const char* name, float value) {
        return within(name, value, std::numeric_limits<float>::lowest(), std::numeric_limits<float>::max());
    }

    LatticePoint place(const char* name, int64_t x, int64_t z) {
        const LatticePoint p{x, z};
        if (!inside_world(p))
            refuse(ErrorCode::value_out_of_range,
                   fmt::format("{} is outside the world (|x|, |z| <= 2^35 lattice units)", name));
        return p;
    }
    SeaTime sea_time(const char* name, int64_t us) {
        return {within(name, us, -sea_time_bound, sea_time_bound)};
    }
    int64_t stamp(const char* name, int64_t us) { return within(name, us, -stamp_bound, stamp_bound); }

    /// A required string of at most `most` bytes, well-formed UTF-8 without control characters (it ends up in logs).
    std::string text(const char* name, const flatbuffers::String* value, size_t most);

    /// A required vector of at most `most` elements whose elements lie as their type demands (the verifier of 2.0.8
    /// checks the alignment of the length only). Null after a refusal.
    template <class Vector>
    const Vector* list(const char* name, const Vector* vector, size_t most,
                       ErrorCode too_many = ErrorCode::value_out_of_range) {
        return present(name, vector) == nullptr ? nullptr : optional_list(name, vector, most, too_many);
    }
    template <class Vector>
    const Vector* optional_list(const char* name, const Vector* vector, size_t most,
                                ErrorCode too_many = ErrorCode::value_out_of_range) {
        if (vector == nullptr) return nullptr;
        if (vector->size() > most) {
            refuse(too_many, fmt::format("{} has {} entries, more than {}", name, vector->size(), most));
            return nullptr;
        }
        using Element = std::remove_cv_t<std::remove_pointer_t<typename Vector::return_type>>;
        if (vector->size() > 0 && reinterpret_cast<uintptr_t>(vector->Data()) % alignof(Element) != 0) {
            refuse(ErrorCode::verification_failed, fmt::format("{} is misaligned", name));
            return nullptr;
        }
        return vector;
    }

private:
    Error error_;
};

/// A sentence as it may travel: cut to longest_sentence at a character's border, control characters made blanks.
std::string sentence_for_wire(std::string_view sentence);

}  // namespace trochoid
