#include "server/net/door_policy.hpp"

#include <algorithm>

namespace trochoid {

namespace {

std::string lower(std::string_view text) {
    std::string result(text);
    for (char& c : result)
        if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
    return result;
}

// "localhost:80" and "[::1]:80" without port and brackets.
std::string host_name(std::string_view host) {
    if (!host.empty() && host.front() == '[') {
        const size_t end = host.find(']');
        return end == std::string_view::npos ? std::string() : lower(host.substr(1, end - 1));
    }
    return lower(host.substr(0, host.find(':')));
}

bool is_loopback_name(std::string_view name) { return name == "localhost" || is_loopback_address(name); }

}  // namespace

bool DoorPolicy::origin_allowed(std::string_view origin) const {
    if (origin.empty()) return true;
    const std::string given = lower(origin);
    for (const std::string& allowed : origins)
        if (allowed == "*" || lower(allowed) == given) return true;
    for (const std::string_view scheme : {"http://", "https://"})
        if (given.starts_with(scheme) && is_loopback_name(host_name(given.substr(scheme.size()))))
            return true;
    return false;
}

bool DoorPolicy::host_allowed(std::string_view host) const {
    const std::string name = host_name(host);
    if (is_loopback_name(name)) return true;
    for (const std::string& allowed : hosts)
        if (allowed == "*" || (is_numeric_address(allowed) ? lower(allowed) : host_name(allowed)) == name)
            return true;
    return std::any_of(addresses.begin(), addresses.end(), [&](const std::string& address) {
        // A page that had its own name point here still sends that name: a number is never such a name.
        const bool any = address == "0.0.0.0" || address == "::";
        return any ? is_numeric_address(name) : lower(address) == name;
    });
}

}  // namespace trochoid
