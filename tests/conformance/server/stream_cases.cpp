#include <fmt/format.h>

#include "protocol/wire/requirements.hpp"
#include "tests/conformance/server/refusals.hpp"

// what comes before any message.
namespace trochoid::conformance::server {

namespace {

using Header = std::array<uint8_t, frame_header_bytes>;

Header header(uint32_t length, uint32_t zero = 0) {
    Header bytes{};
    for (size_t i = 0; i < 4; ++i) {
        bytes[i] = static_cast<uint8_t>(length >> (8 * i));
        bytes[4 + i] = static_cast<uint8_t>(zero >> (8 * i));
    }
    return bytes;
}

/// A frame was read, whatever became of its payload: it is not refused for its length.
void expect_read(ServerPeer& peer) {
    const Deadline deadline(peer.target().patience);
    while (!peer.goodbye() && peer.receive(deadline.left())) {
    }
    if (!peer.goodbye()) {
        if (peer.stream().state() != Stream::State::open) throw Failed{"the stream ended without a goodbye"};
        return;
    }
    const ErrorCode code = peer.goodbye()->code;
    if (code == ErrorCode::frame_too_long || code == ErrorCode::malformed_frame)
        throw Failed{fmt::format("the frame was refused with code {} ({})", static_cast<unsigned>(code),
                                 peer.goodbye()->message)};
}

Bytes hello_bytes() { return encode(ClientMessage{ServerPeer::usual_hello()}); }

void add_magic(Catalogue& all) {
    // The first three bytes tell the kinds of stream apart; from the fourth on, only this one is meant.
    for (size_t i = 3; i < stream_magic.size(); ++i)
        all.push_back(server_case(fmt::format("R-101/byte-{}-wrong", i),
                                  fmt::format("Byte {} of the magic is wrong", i), [i](ServerTrial& trial) {
                                      ServerPeer& peer = trial.connect();
                                      auto magic = stream_magic;
                                      magic[i] ^= 0x20U;
                                      peer.send_bytes(magic);
                                      peer.expect_goodbye(ErrorCode::wrong_magic);
                                  }));
    all.push_back(server_case("R-101/hello-without-magic", "A frame comes where the magic is due",
                              [](ServerTrial& trial) {
                                  ServerPeer& peer = trial.connect();
                                  peer.send_bytes(frame(hello_bytes()));
                                  peer.expect_goodbye(ErrorCode::wrong_magic);
                              }));
    all.push_back(server_case("R-101/magic-twice",
                              "The magic comes twice: its second coming is a wrong header",
                              [](ServerTrial& trial) {
                                  ServerPeer& peer = trial.connect();
                                  peer.send_bytes(stream_magic);
                                  peer.send_bytes(stream_magic);
                                  peer.expect_goodbye(ErrorCode::malformed_frame, requirement::frame_header,
                                                      {ErrorCode::frame_too_long});
                              }));
    all.push_back(
        server_case("R-101/byte-by-byte", "Magic and hello come byte by byte", [](ServerTrial& trial) {
            ServerPeer& peer = trial.connect();
            Bytes all_of_it(stream_magic.begin(), stream_magic.end());
            const Bytes hello = frame(hello_bytes());
            all_of_it.insert(all_of_it.end(), hello.begin(), hello.end());
            for (const uint8_t byte : all_of_it) peer.send_bytes({&byte, 1});
            peer.await<ServerHello>("hello");
            peer.expect_service();
        }));
    all.push_back(server_case("R-101/one-write", "Magic, hello and a clock request come in one write",
                              [](ServerTrial& trial) {
                                  ServerPeer& peer = trial.connect();
                                  Bytes together(stream_magic.begin(), stream_magic.end());
                                  const auto add = [&](const ClientMessage& message) {
                                      const Bytes framed = frame(encode(message));
                                      together.insert(together.end(), framed.begin(), framed.end());
                                  };
                                  add(ServerPeer::usual_hello());
                                  add(ClockRequest{peer.next_sequence(), monotonic_us()});
                                  peer.send_bytes(together);
                                  peer.await<ServerHello>("hello");
                                  peer.await<ClockReply>("clock reply");
                              }));
    all.push_back(
        server_case("R-101/ends-within", "The stream ends within the magic", [](ServerTrial& trial) {
            ServerPeer& peer = trial.connect();
            peer.send_bytes(std::span(stream_magic).first(5));
            peer.stream().finish();
            peer.expect_silent_end();
        }));
}

/// The header after a login.
Case bad_header(std::string id, std::string title, Header bytes, ErrorCode code) {
    return server_case(std::move(id), std::move(title), [bytes, code](ServerTrial& trial) {
        ServerPeer& peer = trial.log_in();
        peer.send_bytes(bytes);
        peer.expect_goodbye(code);
    });
}

/// The header where the hello is due; `above`: added to the limit of frames before the login.
Case bad_first_header(std::string id, std::string title, std::optional<uint32_t> above, Header bytes,
                      ErrorCode code) {
    return server_case(std::move(id), std::move(title), [above, bytes, code](ServerTrial& trial) {
        ServerPeer& peer = trial.connect();
        peer.send_magic();
        peer.send_bytes(above ? header(trial.target().hello.limits.frame_before_login + *above) : bytes);
        peer.expect_goodbye(code);
    });
}

void add_headers(Catalogue& all) {
    for (int i = 0; i < 4; ++i)
        all.push_back(bad_header(fmt::format("R-102/zero-byte-{}", i),
                                 fmt::format("Byte {} of the header's zero is 1", i),
                                 header(64, 1U << (8 * i)), ErrorCode::malformed_frame));
    all.push_back(bad_header("R-102/zero-all-ones", "The header's zero is all ones", header(64, UINT32_MAX),
                             ErrorCode::malformed_frame));
    all.push_back(bad_header("R-102/length-0", "A frame of length 0", header(0), ErrorCode::malformed_frame));
    all.push_back(bad_first_header("R-102/first-length-0", "A first frame of length 0", {}, header(0),
                                   ErrorCode::malformed_frame));
    all.push_back(bad_first_header("R-102/first-zero", "A first header whose zero is not", {},
                                   header(64, 256), ErrorCode::malformed_frame));
    all.push_back(bad_first_header("R-103/first-too-long",
                                   "The first frame is a byte longer than allowed before the login", 1, {},
                                   ErrorCode::frame_too_long));
    all.push_back(bad_first_header("R-103/first-64-KiB",
                                   "The first frame is as long as frames may be after the login", {},
                                   header(65536), ErrorCode::frame_too_long));
    all.push_back(bad_first_header("R-103/first-4-GiB", "The first header announces 4 GiB", {},
                                   header(UINT32_MAX), ErrorCode::frame_too_long));
    all.push_back(
        bad_header("R-103/2-GiB", "A header announces 2 GiB", header(1U << 31), ErrorCode::frame_too_long));
    all.push_back(
        bad_header("R-103/4-GiB", "A header announces 4 GiB", header(UINT32_MAX), ErrorCode::frame_too_long));
    all.push_back(server_case("R-103/too-long", "A frame is a byte longer than the hello's limit",
                              [](ServerTrial& trial) {
                                  ServerPeer& peer = trial.log_in();
                                  peer.send_bytes(header(peer.hello().limits.frame_after_login + 1));
                                  peer.expect_goodbye(ErrorCode::frame_too_long);
                              }));
    all.push_back(server_case("R-103/longest-first",
                              "A first frame of just the limit is read: it fails only as a buffer",
                              [](ServerTrial& trial) {
                                  ServerPeer& peer = trial.connect();
                                  peer.send_magic();
                                  peer.send_payload(Bytes(trial.target().hello.limits.frame_before_login));
                                  expect_read(peer);
                              }));
    all.push_back(server_case("R-103/longest", "A frame of just the limit is read: it fails only as a buffer",
                              [](ServerTrial& trial) {
                                  ServerPeer& peer = trial.log_in();
                                  peer.send_payload(Bytes(peer.hello().limits.frame_after_login));
                                  expect_read(peer);
                              }));
}

void add_pieces(Catalogue& all) {
    all.push_back(server_case("R-102/byte-by-byte", "Frames come byte by byte", [](ServerTrial& trial) {
        ServerPeer& peer = trial.log_in();
        for (int i = 0; i < 3; ++i) {
            const ClockRequest request{peer.next_sequence(), monotonic_us()};
            for (const uint8_t byte : frame(encode(ClientMessage{request}))) peer.send_bytes({&byte, 1});
            peer.await<ClockReply>("clock reply",
                                   [&](const ClockReply& r) { return r.sequence == request.sequence; });
        }
    }));
    all.push_back(
        server_case("R-102/many-in-one-write", "Twenty frames come in one write", [](ServerTrial& trial) {
            ServerPeer& peer = trial.log_in();
            Bytes together;
            uint32_t last = 0;
            for (int i = 0; i < 20; ++i) {
                last = peer.next_sequence();
                const Bytes framed = frame(encode(ClientMessage{ClockRequest{last, monotonic_us()}}));
                together.insert(together.end(), framed.begin(), framed.end());
            }
            peer.send_bytes(together);
            uint32_t answered = 0;
            while (answered < last) {
                const auto reply = peer.await<ClockReply>("clock reply");
                if (reply.sequence <= answered)
                    throw Failed{fmt::format("reply {} came after reply {}", reply.sequence, answered)};
                answered = reply.sequence;
            }
        }));
    all.push_back(
        server_case("R-102/ends-within-header", "The stream ends within a header", [](ServerTrial& trial) {
            ServerPeer& peer = trial.log_in();
            const Header whole = header(64);
            peer.send_bytes(std::span(whole).first(3));
            peer.stream().finish();
            peer.settle(Milliseconds(50));
            peer.expect_silent_end();
        }));
    all.push_back(
        server_case("R-102/ends-within-frame", "The stream ends within a frame", [](ServerTrial& trial) {
            ServerPeer& peer = trial.log_in();
            peer.send_bytes(header(64));
            peer.send_bytes(Bytes(40));
            peer.stream().finish();
            peer.settle(Milliseconds(50));
            peer.expect_silent_end();
        }));
    all.push_back(server_case("R-102/reset-within-frame", "The connection is reset within a frame",
                              [](ServerTrial& trial) {
                                  ServerPeer& peer = trial.log_in();
                                  peer.send_bytes(header(4096));
                                  peer.send_bytes(Bytes(100));
                                  peer.stream().abort();
                              }));
    all.push_back(server_case("R-102/limit-changes",
                              "A long frame in the same write as the hello is judged by the later limit",
                              [](ServerTrial& trial) {
                                  ServerPeer& peer = trial.connect();
                                  Bytes together(stream_magic.begin(), stream_magic.end());
                                  const auto add = [&](const Bytes& payload) {
                                      const Bytes framed = frame(payload);
                                      together.insert(together.end(), framed.begin(), framed.end());
                                  };
                                  add(hello_bytes());
                                  add(Bytes(trial.target().hello.limits.frame_before_login + 8));
                                  peer.send_bytes(together);
                                  expect_read(peer);
                              }));
}

}  // namespace

void add_stream_cases(Catalogue& all) {
    add_magic(all);
    add_headers(all);
    add_pieces(all);
}

}  // namespace trochoid::conformance::server
