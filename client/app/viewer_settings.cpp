#include "client/app/viewer_settings.hpp"

#include <fmt/format.h>
#include <toml++/toml.h>

#include <cmath>
#include <cstdlib>
#include <fstream>
#include <sstream>
#include <system_error>

#include "protocol/units/operator_error.hpp"

namespace trochoid {

namespace {

std::string variable(const char* name) {
    const char* value = std::getenv(name);  // NOLINT(concurrency-mt-unsafe): before any thread starts
    return value != nullptr ? value : "";
}

/// Takes keys of a table one by one and remembers those that make no sense.
class Reader {
public:
    explicit Reader(const toml::table& table) : table_(table) {}

    void number(const char* key, uint32_t& value, int64_t lowest, int64_t highest) {
        const toml::node* node = table_.get(key);
        if (node == nullptr) return;
        const auto given = node->value_exact<int64_t>();
        if (given && *given >= lowest && *given <= highest)
            value = static_cast<uint32_t>(*given);
        else
            bad(key, fmt::format("a whole number from {} to {}", lowest, highest));
    }
    void number(const char* key, double& value, double lowest, double highest) {
        const toml::node* node = table_.get(key);
        if (node == nullptr) return;
        const auto given = node->value<double>();
        if (given && std::isfinite(*given) && *given >= lowest && *given <= highest)
            value = *given;
        else
            bad(key, fmt::format("a number from {} to {}", lowest, highest));
    }
    void flag(const char* key, bool& value) {
        const toml::node* node = table_.get(key);
        if (node == nullptr) return;
        if (const auto given = node->value_exact<bool>())
            value = *given;
        else
            bad(key, "true or false");
    }
    template <class T, class Named>
    void name(const char* key, T& value, Named named, const char* names) {
        const toml::node* node = table_.get(key);
        if (node == nullptr) return;
        const auto given = node->value_exact<std::string>();
        const std::optional<T> found = given ? named(*given) : std::nullopt;
        if (found)
            value = *found;
        else
            bad(key, names);
    }
    const std::string& complaints() const { return complaints_; }

private:
    void bad(const char* key, const std::string& wanted) {
        complaints_ += fmt::format("{}{} wants {}", complaints_.empty() ? "" : "; ", key, wanted);
    }

    const toml::table& table_;
    std::string complaints_;
};

std::string read(Reader& reader, ViewerSettings& s) {
    reader.number("width", s.width, fewest_pixels, most_pixels);
    reader.number("height", s.height, fewest_pixels, most_pixels);
    reader.flag("full_screen", s.full_screen);
    reader.flag("numbers", s.numbers);
    reader.name("quality", s.quality, quality_named, "low, medium or high");
    reader.name("mesher", s.mesher, mesher_named, "patches, uniform, projected or coherent");
    reader.name("far", s.far_method, far_method_named, "combined, spectrum or texture");
    reader.name("refine", s.refinement, refinement_named, "distance, screen or frustum");
    reader.number("target_ms", s.target_ms, 0.0, 10'000.0);
    return reader.complaints();
}

std::string text_of(const ViewerSettings& s) {
    const toml::table table{
        {"width", static_cast<int64_t>(s.width)},
        {"height", static_cast<int64_t>(s.height)},
        {"full_screen", s.full_screen},
        {"numbers", s.numbers},
        {"quality", std::string(name_of(s.quality))},
        {"mesher", std::string(name_of(s.mesher))},
        {"far", std::string(name_of(s.far_method))},
        {"refine", std::string(name_of(s.refinement))},
        {"target_ms", s.target_ms},
    };
    std::ostringstream text;
    text
        << "# What trochoid-viewer keeps from one window to the next; viewer-reference.md explains each key.\n"
        << table << '\n';
    return text.str();
}

}  // namespace

std::filesystem::path settings_file() {
    std::filesystem::path folder = variable("XDG_CONFIG_HOME");
    // A relative path there is to be ignored, says the XDG base directory specification.
    if (!folder.is_absolute()) {
        const std::filesystem::path home = variable("HOME");
        if (home.empty()) return {};
        folder = home / ".config";
    }
    return folder / "trochoid" / "viewer.toml";
}

KeptSettings load_settings(const std::filesystem::path& file) {
    KeptSettings kept;
    std::error_code none;
    if (file.empty() || !std::filesystem::exists(file, none)) return kept;
    const auto complain = [&](const std::string& what) {
        kept.complaint =
            fmt::format("The settings {} are not used: {}. Mend or remove the file; it stays as it is.",
                        file.string(), what);
    };
    std::ifstream stream(file, std::ios::binary);
    std::ostringstream text;
    text << stream.rdbuf();
    if (!stream || !std::filesystem::is_regular_file(file, none)) {
        complain("the file cannot be read");
        return kept;
    }
    try {
        const toml::table table = toml::parse(text.str());
        Reader reader(table);
        if (const std::string bad = read(reader, kept.values); !bad.empty())
            kept.complaint = fmt::format(
                "Part of the settings {} is not used: {}. Mend or remove the file; it stays as it is.",
                file.string(), bad);
    } catch (const toml::parse_error& error) {
        complain(fmt::format("line {}: {}", error.source().begin.line, error.description()));
    }
    return kept;
}

void save_settings(const std::filesystem::path& file, const ViewerSettings& settings) {
    if (file.empty()) return;
    std::error_code failure;
    std::filesystem::create_directories(file.parent_path(), failure);
    std::filesystem::path beside = file;
    beside += ".new";
    {
        std::ofstream stream(beside, std::ios::binary | std::ios::trunc);
        stream << text_of(settings);
        stream.close();
        if (!stream) failure = std::make_error_code(std::errc::io_error);
    }
    if (!failure) std::filesystem::rename(beside, file, failure);
    if (failure) {
        std::error_code ignored;
        std::filesystem::remove(beside, ignored);
        throw OperatorError(fmt::format(
            "Cannot keep the settings in {}: {}. Make the folder writable, or take --no-settings.",
            file.string(), failure.message()));
    }
}

}  // namespace trochoid
