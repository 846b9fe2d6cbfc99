#include "tests/fuzz/hostile/field_rules.hpp"

#include <fmt/format.h>

#include <fstream>
#include <limits>
#include <sstream>
#include <stdexcept>

namespace trochoid {

namespace {

ErrorCode code_named(const std::string& name) {
    if (name == "value_out_of_range") return ErrorCode::value_out_of_range;
    if (name == "not_a_unit_quaternion") return ErrorCode::not_a_unit_quaternion;
    if (name == "too_many_trains") return ErrorCode::too_many_trains;
    if (name == "too_many_regions") return ErrorCode::too_many_regions;
    if (name == "too_many_boxes") return ErrorCode::too_many_boxes;
    if (name == "too_many_legs") return ErrorCode::too_many_legs;
    if (name == "region_too_large") return ErrorCode::region_too_large;
    if (name == "verification_failed") return ErrorCode::verification_failed;
    throw std::runtime_error(fmt::format("'{}' is no code of these rules", name));
}

/// "-2^61", "2^32-1", "10^6", "0.01", "max".
double number(const std::string& text) {
    if (text == "max") return static_cast<double>(std::numeric_limits<float>::max());
    const auto power = text.find('^');
    if (power == std::string::npos) return std::stod(text);
    size_t read = 0;
    double value = 1.0;
    const double base = std::stod(text.substr(0, power));
    const std::string rest = text.substr(power + 1);
    for (int i = std::stoi(rest, &read); i > 0; --i) value *= base < 0.0 ? -base : base;
    if (read < rest.size()) value += std::stod(rest.substr(read));
    return base < 0.0 ? -value : value;
}

FieldRule read_rule(std::istringstream& in) {
    FieldRule rule;
    std::string word;
    in >> word;
    if (word == "any") return rule;
    if (word == "bool") return rule.kind = FieldRule::Kind::flag, rule;
    if (word == "codes") return rule.kind = FieldRule::Kind::codes, rule;
    if (word == "size") return rule.kind = FieldRule::Kind::size, rule;
    if (word == "required" || word == "optional") {
        rule.required = word == "required";
        rule.kind = FieldRule::Kind::presence;
        if (!(in >> word)) return rule;
        rule.kind = word == "list" ? FieldRule::Kind::list : FieldRule::Kind::text;
        in >> word;
        rule.most_entries = static_cast<uint32_t>(number(word));
        if (in >> word) rule.above = code_named(word);
        return rule;
    }
    rule.kind = FieldRule::Kind::range;
    rule.most = number("max");
    rule.least = -rule.most;
    if (word == "finite") return rule;
    rule.least = number(word);
    in >> word >> word;  // ".."
    rule.most = number(word);
    if (in >> word) rule.below = rule.above = code_named(word);
    if (in >> word) rule.above = code_named(word);
    return rule;
}

}  // namespace

FieldRules::FieldRules(const std::string& file) {
    std::ifstream text(file);
    if (!text) throw std::runtime_error(file + ": cannot be read");
    for (std::string line; std::getline(text, line);) {
        if (line.empty() || line[0] == '#') continue;
        std::istringstream in(line);
        Line made;
        in >> made.field;
        made.ends_path = made.field[0] == '*';
        if (made.ends_path) made.field.erase(0, 1);
        try {
            made.rule = read_rule(in);
        } catch (const std::exception& error) {
            throw std::runtime_error(fmt::format("{}: '{}': {}", file, line, error.what()));
        }
        lines_.push_back(std::move(made));
    }
}

const FieldRule& FieldRules::of(const WireSlot& slot) const {
    for (const Line& line : lines_)
        if (line.ends_path ? slot.path.ends_with(line.field) : slot.name == line.field) return line.rule;
    throw std::runtime_error(
        fmt::format("tests/fuzz/hostile/field_rules.txt has no line for {} ({})", slot.name, slot.path));
}

}  // namespace trochoid
