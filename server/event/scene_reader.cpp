#include "server/event/scene_reader.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "protocol/units/operator_error.hpp"

namespace trochoid {

namespace {

std::string range_text(NumberRange range, std::string_view unit) {
    return fmt::format("{:.10g} to {:.10g}{}{}", range.least, range.most, unit.empty() ? "" : " ", unit);
}

constexpr NumberRange world_metres{to_metres(-world_bound), to_metres(world_bound)};

std::string place_text() {
    return fmt::format("[x, z], metres east and south, each {}", range_text(world_metres, ""));
}

}  // namespace

SceneReader::SceneReader(std::string file, std::string path, const toml::table& table)
    : file_(std::move(file)), path_(std::move(path)), table_(table) {}

const toml::node* SceneReader::find(std::string_view key) {
    known_.emplace(key);
    return table_.get(key);
}

std::string SceneReader::name_of(std::string_view key) const {
    return path_.empty() ? fmt::format("'{}'", key) : fmt::format("'{}' of {}", key, path_);
}

void SceneReader::refuse(std::string_view key, std::string_view complaint) const {
    const toml::node* node = table_.get(key);
    const auto line = node != nullptr ? node->source().begin.line : table_.source().begin.line;
    throw OperatorError(fmt::format("{}:{}: {} {}", file_, line, name_of(key), complaint));
}

void SceneReader::missing(std::string_view key, std::string_view what) const {
    refuse(key, fmt::format("is missing: give {}", what));
}

double SceneReader::number(std::string_view key, NumberRange range, std::string_view unit,
                           std::optional<double> fallback) {
    const toml::node* node = find(key);
    const std::string wanted = range_text(range, unit);
    if (node == nullptr) {
        if (!fallback) missing(key, "a number, " + wanted);
        return *fallback;
    }
    const std::optional<double> value = node->is_number() ? node->value<double>() : std::nullopt;
    if (!value) refuse(key, fmt::format("is not a number: give {}", wanted));
    // Written so that NaN is refused too.
    if (!(*value >= range.least && *value <= range.most))
        refuse(key, fmt::format("is {:.10g}: give {}", *value, wanted));
    return *value;
}

int64_t SceneReader::integer(std::string_view key, int64_t least, int64_t most,
                             std::optional<int64_t> fallback) {
    const toml::node* node = find(key);
    if (node == nullptr) {
        if (!fallback) missing(key, fmt::format("a whole number, {} to {}", least, most));
        return *fallback;
    }
    if (!node->is_integer()) refuse(key, fmt::format("is not a whole number: give {} to {}", least, most));
    const int64_t value = node->as_integer()->get();
    if (value < least || value > most) refuse(key, fmt::format("is {}: give {} to {}", value, least, most));
    return value;
}

std::string SceneReader::text(std::string_view key, size_t longest, std::optional<std::string> fallback) {
    const toml::node* node = find(key);
    if (node == nullptr) {
        if (!fallback) missing(key, fmt::format("a text of 1 to {} bytes", longest));
        return *fallback;
    }
    if (!node->is_string()) refuse(key, fmt::format("is not a text: give 1 to {} bytes in quotes", longest));
    std::string value = node->as_string()->get();
    if (value.empty() || value.size() > longest)
        refuse(key, fmt::format("is a text of {} bytes: give 1 to {}", value.size(), longest));
    for (const char c : value)
        if ((c >= 0 && c < 0x20) || c == 0x7f) refuse(key, "holds a control character: remove it");
    return value;
}

size_t SceneReader::choice(std::string_view key, const std::vector<std::string_view>& words,
                           size_t fallback) {
    const toml::node* node = find(key);
    if (node == nullptr) return fallback;
    const std::string wanted = fmt::format("give \"{}\"", fmt::join(words, "\" or \""));
    if (!node->is_string()) refuse(key, "is not a text: " + wanted);
    const std::string& value = node->as_string()->get();
    for (size_t i = 0; i < words.size(); ++i)
        if (words[i] == value) return i;
    refuse(key, fmt::format("is \"{}\": {}", value, wanted));
}

bool SceneReader::boolean(std::string_view key, bool fallback) {
    const toml::node* node = find(key);
    if (node == nullptr) return fallback;
    if (!node->is_boolean()) refuse(key, "is neither true nor false: give one of them");
    return node->as_boolean()->get();
}

std::optional<LatticePoint> SceneReader::place_in(const toml::node& node) const {
    const toml::array* pair = node.as_array();
    if (pair == nullptr || pair->size() != 2) return std::nullopt;
    double metres[2] = {};
    for (size_t i = 0; i < 2; ++i) {
        const toml::node& item = *pair->get(i);
        const std::optional<double> value = item.is_number() ? item.value<double>() : std::nullopt;
        if (!value || !(*value >= world_metres.least && *value <= world_metres.most)) return std::nullopt;
        metres[i] = *value;
    }
    return LatticePoint{to_lattice(metres[0]), to_lattice(metres[1])};
}

LatticePoint SceneReader::place(std::string_view key) {
    const std::string wanted = place_text();
    const toml::node* node = find(key);
    if (node == nullptr) missing(key, wanted);
    const toml::array* pair = node->as_array();
    if (pair == nullptr || pair->size() != 2) refuse(key, "is not a pair: give " + wanted);
    const std::optional<LatticePoint> place = place_in(*node);
    if (!place) refuse(key, fmt::format("has an element that is no number in range: give {}", wanted));
    return *place;
}

std::vector<LatticePoint> SceneReader::places(std::string_view key, size_t least, size_t most) {
    const std::string wanted = fmt::format("{} to {} places, each {}", least, most, place_text());
    const toml::node* node = find(key);
    if (node == nullptr) missing(key, wanted);
    const toml::array* list = node->as_array();
    if (list == nullptr) refuse(key, "is not a list of places: give " + wanted);
    if (list->size() < least || list->size() > most)
        refuse(key, fmt::format("has {} places: give {}", list->size(), wanted));
    std::vector<LatticePoint> places;
    for (const toml::node& item : *list) {
        const std::optional<LatticePoint> place = place_in(item);
        if (!place)
            refuse(key, fmt::format("has a place, number {}, that is no pair of numbers in range: give {}",
                                    places.size() + 1, wanted));
        places.push_back(*place);
    }
    return places;
}

const toml::table* SceneReader::table(std::string_view key) {
    const toml::node* node = find(key);
    if (node == nullptr) return nullptr;
    if (!node->is_table()) refuse(key, fmt::format("is not a table: write [{}]", key));
    return node->as_table();
}

std::vector<const toml::table*> SceneReader::tables(std::string_view key) {
    const toml::node* node = find(key);
    if (node == nullptr) return {};
    const toml::array* array = node->as_array();
    if (array == nullptr) refuse(key, fmt::format("is not a list of tables: write [[{}]]", key));
    std::vector<const toml::table*> list;
    for (const toml::node& item : *array) {
        if (!item.is_table()) refuse(key, fmt::format("is not a list of tables: write [[{}]]", key));
        list.push_back(item.as_table());
    }
    return list;
}

void SceneReader::finish() const {
    for (const auto& [key, value] : table_)
        if (!known_.contains(key.str()))
            throw OperatorError(fmt::format("{}:{}: unknown key {}: remove it, or write one of {}", file_,
                                            value.source().begin.line, name_of(key.str()),
                                            fmt::join(known_, ", ")));
}

}  // namespace trochoid
