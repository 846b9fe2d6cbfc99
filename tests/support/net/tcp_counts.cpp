#include "tests/support/net/tcp_counts.hpp"

#include <arpa/inet.h>
#include <linux/tcp.h>
#include <netinet/in.h>
#include <sys/socket.h>

#include <filesystem>
#include <string>

namespace trochoid {

TcpCounts counts_of_connections_to(uint16_t port) {
    TcpCounts sum;
    for (const auto& entry : std::filesystem::directory_iterator("/proc/self/fd")) {
        const int socket = std::stoi(entry.path().filename().string());
        sockaddr_in peer{};
        socklen_t size = sizeof peer;
        if (::getpeername(socket, reinterpret_cast<sockaddr*>(&peer), &size) != 0) continue;
        if (peer.sin_family != AF_INET || ntohs(peer.sin_port) != port) continue;
        tcp_info info{};
        size = sizeof info;
        if (::getsockopt(socket, IPPROTO_TCP, TCP_INFO, &info, &size) != 0) continue;
        sum.bytes_sent += info.tcpi_bytes_sent;
        sum.bytes_received += info.tcpi_bytes_received;
        sum.segments_sent += info.tcpi_segs_out;
        sum.segments_received += info.tcpi_segs_in;
    }
    return sum;
}

}  // namespace trochoid
