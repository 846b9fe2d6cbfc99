#pragma once
// In the place of spdlog for legs of the matrix: no cross compiler has it, and nobody reads the log there.
namespace spdlog {

namespace level {
enum level_enum { off };
}
inline void set_level(level::level_enum) {}
template <class... Arguments>
void info(const Arguments&...) {}
template <class... Arguments>
void warn(const Arguments&...) {}
template <class... Arguments>
void error(const Arguments&...) {}

}  // namespace spdlog
