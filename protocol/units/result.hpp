#pragma once
#include <string>
#include <utility>
#include <variant>

#include "protocol/units/assert.hpp"
#include "protocol/units/error_code.hpp"

namespace trochoid {

/// What a peer did wrong: a code for programs, a sentence for people that says what to do.
struct Error {
    ErrorCode code = ErrorCode::none;
    std::string message;
    bool operator==(const Error&) const = default;
};

/// A value, or the error that explains why there is none. Asking for the wrong one is our bug and asserts.
template <class T>
class [[nodiscard]] Result {
public:
    Result(T value) : state_(std::in_place_index<0>, std::move(value)) {}
    Result(Error error) : state_(std::in_place_index<1>, std::move(error)) {}

    explicit operator bool() const { return state_.index() == 0; }
    bool has_value() const { return state_.index() == 0; }
    T& value() & {
        check_value();
        return std::get<0>(state_);
    }
    const T& value() const& {
        check_value();
        return std::get<0>(state_);
    }
    T&& value() && {
        check_value();
        return std::get<0>(std::move(state_));
    }
    T& operator*() & { return value(); }
    const T& operator*() const& { return value(); }
    T* operator->() { return &value(); }
    const T* operator->() const { return &value(); }
    const Error& error() const {
        TROCHOID_ASSERT(!has_value(), "asked for the error of a success");
        return std::get<1>(state_);
    }

private:
    void check_value() const {
        TROCHOID_ASSERT(has_value(), "asked for a value, but: {}", std::get<1>(state_).message);
    }
    std::variant<T, Error> state_;
};

/// A result that carries nothing but success.
struct Done {
    bool operator==(const Done&) const = default;
};

}  // namespace trochoid
