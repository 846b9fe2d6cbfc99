// The libraries that are not header-only here, compiled once for a leg instead of in every file: no cross compiler has
// them. {fmt} 9 as in its own src/format.cc.
#define TOML_IMPLEMENTATION
#include <toml++/toml.h>

#include <fmt/format-inl.h>

// Highway's own choice of an instruction set; the legs of x86-64 have the library, all others one set, known at compile time.
#if !defined(__x86_64__)
#include "protocol/model/simd/highway.hpp"
// After the choice of targets.
#include <hwy/targets.h>
namespace hwy {
int64_t SupportedTargets() { return HWY_STATIC_TARGET; }
void SetSupportedTargetsForTest(int64_t) {}
ChosenTarget& GetChosenTarget() {
    static ChosenTarget chosen;
    return chosen;
}
}  // namespace hwy
#endif

FMT_BEGIN_NAMESPACE
namespace detail {
template FMT_API auto dragonbox::to_decimal(float x) noexcept -> dragonbox::decimal_fp<float>;
template FMT_API auto dragonbox::to_decimal(double x) noexcept -> dragonbox::decimal_fp<double>;
template FMT_API locale_ref::locale_ref(const std::locale& loc);
template FMT_API auto locale_ref::get<std::locale>() const -> std::locale;
template FMT_API auto thousands_sep_impl(locale_ref) -> thousands_sep_result<char>;
template FMT_API auto decimal_point_impl(locale_ref) -> char;
template FMT_API void buffer<char>::append(const char*, const char*);
template FMT_API void vformat_to(buffer<char>&, string_view, basic_format_args<FMT_BUFFER_CONTEXT(char)>,
                                 locale_ref);
template FMT_API auto thousands_sep_impl(locale_ref) -> thousands_sep_result<wchar_t>;
template FMT_API auto decimal_point_impl(locale_ref) -> wchar_t;
template FMT_API void buffer<wchar_t>::append(const wchar_t*, const wchar_t*);
}  // namespace detail
FMT_END_NAMESPACE
