#include "server/net/peer_address.hpp"

#include <boost/asio/ip/address.hpp>

namespace trochoid {

namespace {

namespace ip = boost::asio::ip;

ip::address parsed(std::string_view text, bool& numeric) {
    boost::system::error_code failed;
    ip::address address = ip::make_address(std::string(text), failed);
    numeric = !failed;
    if (numeric && address.is_v6() && address.to_v6().is_v4_mapped())
        address = ip::make_address_v4(ip::v4_mapped, address.to_v6());
    return address;
}

}  // namespace

PeerAddress peer_address(std::string_view peer) {
    const size_t colon = peer.rfind(':');
    std::string_view host = peer.substr(0, colon == std::string_view::npos ? peer.size() : colon);
    if (host.size() > 2 && host.front() == '[' && host.back() == ']') host = host.substr(1, host.size() - 2);
    bool numeric = false;
    const ip::address address = parsed(host, numeric);
    if (!numeric) return {};
    PeerAddress result{address.is_loopback(), address.is_v6(), 0};
    if (address.is_v4()) {
        result.network = address.to_v4().to_uint();
    } else {
        const ip::address_v6::bytes_type bytes = address.to_v6().to_bytes();
        for (size_t i = 0; i < 8; ++i) result.network = (result.network << 8) | bytes[i];
    }
    return result;
}

bool is_numeric_address(std::string_view host) {
    bool numeric = false;
    parsed(host, numeric);
    return numeric;
}

bool is_loopback_address(std::string_view host) {
    bool numeric = false;
    const ip::address address = parsed(host, numeric);
    return numeric && address.is_loopback();
}

std::shared_ptr<void> AddressCounts::enter(const PeerAddress& address) {
    ++(*counts_)[address];
    return {nullptr, [counts = counts_, address](void*) {
                const auto at = counts->find(address);
                if (--at->second == 0) counts->erase(at);
            }};
}

uint32_t AddressCounts::count(const PeerAddress& address) const {
    const auto at = counts_->find(address);
    return at == counts_->end() ? 0 : at->second;
}

}  // namespace trochoid
