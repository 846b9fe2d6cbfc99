#pragma once
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "protocol/wire/requirements.hpp"
#include "tests/conformance/server/refusals.hpp"

// Rows of wrong and right fields, and the cases that they make.
namespace trochoid::conformance::server {

inline constexpr Answer out_of_range{ErrorCode::value_out_of_range, requirement::ranges};
inline constexpr Answer infinite_or_nan{ErrorCode::not_finite, requirement::finite_numbers};
inline constexpr Answer not_unit{ErrorCode::not_a_unit_quaternion, requirement::unit_quaternion};
inline constexpr Answer absent{ErrorCode::missing_field, requirement::fields_present};

/// A float field of a value: what is just too little, the least, the most, what is just too much. NaN: there is no such bound.
template <class Value>
struct FloatRow {
    const char* name;
    float Value::*field;
    float below;
    float least;
    float most;
    float above;
};
inline constexpr float no_bound = std::numeric_limits<float>::quiet_NaN();

/// An integer field: each wrong value, then the bounds that are right.
template <class Value, class Number>
struct NumberRow {
    const char* name;
    Number Value::*field;
    std::vector<Number> wrong;
    std::vector<Number> right;
};

/// Cases of a message made from a value by `message`; `stem` begins their names ("view").
template <class Value, class Message>
class Rows {
public:
    Rows(Catalogue& all, std::string stem, Value legal, Message message)
        : all_(all), stem_(std::move(stem)), legal_(std::move(legal)), message_(std::move(message)) {}

    void add(const FloatRow<Value>& row) {
        constexpr float infinite = std::numeric_limits<float>::infinity();
        const auto with = [&](float value) {
            Value changed = legal_;
            changed.*row.field = value;
            return message_(changed);
        };
        refuse(116, row.name, "nan", "is not a number", with(no_bound), infinite_or_nan);
        refuse(116, row.name, "inf", "is infinite", with(infinite), infinite_or_nan);
        refuse(116, row.name, "minus-inf", "is minus infinite", with(-infinite), infinite_or_nan);
        if (!std::isnan(row.below))
            refuse(117, row.name, "low", "is too small", with(row.below), out_of_range);
        if (!std::isnan(row.above))
            refuse(117, row.name, "high", "is too large", with(row.above), out_of_range);
        if (!std::isnan(row.least)) accept(117, row.name, "least", "is the least allowed", with(row.least));
        if (!std::isnan(row.most)) accept(117, row.name, "most", "is the most allowed", with(row.most));
    }

    template <class Number>
    void add(const NumberRow<Value, Number>& row) {
        const auto with = [&](Number value) {
            Value changed = legal_;
            changed.*row.field = value;
            return message_(changed);
        };
        for (const Number value : row.wrong)
            refuse(117, row.name, text(value), "is " + text(value), with(value), out_of_range);
        for (const Number value : row.right)
            accept(117, row.name, text(value), "is " + text(value) + ", which is allowed", with(value));
    }

    /// Anything else about the value.
    template <class Change>
    void wrong(int number, const std::string& name, const std::string& title, Answer answer, Change change) {
        Value changed = legal_;
        change(changed);
        all_.push_back(refused("R-" + std::to_string(number) + "/" + stem_ + "-" + name, title,
                               message_(changed), answer));
    }
    template <class Change>
    void right(int number, const std::string& name, const std::string& title, Change change) {
        Value changed = legal_;
        change(changed);
        all_.push_back(
            taken("R-" + std::to_string(number) + "/" + stem_ + "-" + name, title, message_(changed)));
    }

private:
    template <class Number>
    static std::string text(Number value) {
        std::string out = std::to_string(value);
        if (out[0] == '-') out.replace(0, 1, "minus-");
        return out;
    }
    void refuse(int number, const char* field, const std::string& kind, const std::string& does, Bytes bytes,
                Answer answer) {
        all_.push_back(
            refused(id(number, field, kind), stem_ + ": " + field + " " + does, std::move(bytes), answer));
    }
    void accept(int number, const char* field, const std::string& kind, const std::string& does,
                Bytes bytes) {
        all_.push_back(taken(id(number, field, kind), stem_ + ": " + field + " " + does, std::move(bytes)));
    }
    std::string id(int number, const char* field, const std::string& kind) const {
        return "R-" + std::to_string(number) + "/" + stem_ + "-" + field + "-" + kind;
    }

    Catalogue& all_;
    std::string stem_;
    Value legal_;
    Message message_;
};

/// Texts that no field may hold, with a word for each.
struct BadText {
    const char* name;
    const char* title;
    std::string bytes;
};
const std::vector<BadText>& bad_texts();

}  // namespace trochoid::conformance::server
