#include "protocol/units/version.hpp"

#include <fmt/format.h>

namespace trochoid {

std::string_view software_version() { return TROCHOID_VERSION; }

std::string version_text(std::string_view program) {
    return fmt::format("{} {} (protocol {}-{}, model {})", program, software_version(), protocol_version_min,
                       protocol_version_max, model_version);
}

}  // namespace trochoid
