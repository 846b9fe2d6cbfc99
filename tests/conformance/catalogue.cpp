#include <algorithm>
#include <set>

#include "protocol/units/assert.hpp"
#include "tests/conformance/client_trial.hpp"
#include "tests/conformance/server_trial.hpp"

namespace trochoid::conformance {

Catalogue whole_catalogue() {
    Catalogue all;
    server::add_stream_cases(all);
    server::add_front_cases(all);
    server::add_tls_cases(all);
    server::add_buffer_cases(all);
    server::add_field_cases(all);
    server::add_session_cases(all);
    server::add_clock_cases(all);
    server::add_result_cases(all);
    server::add_evaluation_cases(all);
    server::add_arithmetic_cases(all);
    server::add_terrain_cases(all);
    server::add_command_cases(all);
    server::add_land_change_cases(all);
    server::add_login_cases(all);
    server::add_probe_cases(all);
    server::add_golden_cases(all);
    client::add_hello_cases(all);
    client::add_stream_cases(all);
    client::add_web_cases(all);
    client::add_tls_cases(all);
    client::add_buffer_cases(all);
    client::add_field_cases(all);
    client::add_result_field_cases(all);
    client::add_patch_plane_cases(all);
    client::add_session_cases(all);
    client::add_clock_cases(all);
    client::add_result_cases(all);
    client::add_terrain_cases(all);
    client::add_return_cases(all);
    client::add_golden_cases(all);
    client::add_evolution_cases(all);
    std::stable_sort(all.begin(), all.end(), [](const Case& a, const Case& b) {
        if (a.side != b.side) return a.side < b.side;
        return requirement_of_case(a.id) < requirement_of_case(b.id);
    });
    std::set<std::pair<Side, std::string>> ids;
    for (const Case& it : all)
        TROCHOID_ASSERT(ids.emplace(it.side, it.id).second, "two cases are called {}", it.id);
    return all;
}

}  // namespace trochoid::conformance
