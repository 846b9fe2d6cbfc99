#include <fmt/format.h>

#include <cstring>

#include "tests/conformance/client/refusals.hpp"
#include "tests/conformance/kit_sea.hpp"

// frames towards a client.
namespace trochoid::conformance::client {

namespace {

constexpr Due malformed{ErrorCode::malformed_frame, requirement::frame_header};
constexpr Due too_long{ErrorCode::frame_too_long, requirement::frame_length};

Bytes header(uint32_t length, uint32_t zero) {
    Bytes bytes(frame_header_bytes);
    std::memcpy(bytes.data(), &length, sizeof length);
    std::memcpy(bytes.data() + sizeof length, &zero, sizeof zero);
    return bytes;
}

/// Bytes that are no frame, before our hello or after it.
void add(Catalogue& all, const std::string& id, const std::string& title, const Bytes& bytes, Due due) {
    all.push_back(client_case(id, title, [bytes, due](ClientTrial& trial) {
        ClientPeer& peer = trial.welcome();
        peer.send_bytes(bytes);
        peer.expect_goodbye(due);
    }));
}
void add_first(Catalogue& all, const std::string& id, const std::string& title, const Bytes& bytes, Due due) {
    all.push_back(client_case(id, title, [bytes, due](ClientTrial& trial) {
        ClientPeer& peer = trial.accept();
        peer.await_hello();
        peer.send_bytes(bytes);
        peer.expect_goodbye(due);
    }));
}

void add_limits(Catalogue& all) {
    constexpr uint32_t usual = Limits{}.frame_to_client;
    add(all, "R-103/one-too-long", "A frame one byte longer than the limit", header(usual + 1, 0), too_long);
    add(all, "R-103/4-gib", "A frame of 4 GiB", header(UINT32_MAX, 0), too_long);
    add_first(all, "R-103/first-too-long", "A first frame longer than the default limit",
              header(usual + 1, 0), too_long);
    all.push_back(client_case(
        "R-103/own-limit", "Our hello says 4,096 bytes, then a frame of 4,097 comes", [](ClientTrial& trial) {
            constexpr uint32_t limit = 4096;
            ClientPeer& peer =
                trial.welcome([](ServerHello& hello) { hello.limits.frame_to_client = limit; });
            peer.send_bytes(header(limit + 1, 0));
            peer.expect_goodbye(too_long);
        }));
    all.push_back(client_case(
        "R-103/own-frames", "Our hello allows the client frames of 1,024 bytes: it sends none that is longer",
        [](ClientTrial& trial) {
            ClientPeer& peer =
                trial.welcome([](ServerHello& hello) { hello.limits.frame_after_login = 1024; });
            peer.expect_service();
            peer.listen(Milliseconds(500));
        }));
    all.push_back(client_case(
        "R-103/raised-limit", "Our hello says 64 KiB, then a frame of 20 KiB comes", [](ClientTrial& trial) {
            ClientPeer& peer =
                trial.welcome([](ServerHello& hello) { hello.limits.frame_to_client = 65536; });
            InterestState state = small_sea();
            for (int32_t i = 0; i < 700; ++i) {
                PatchDescriptor patch;
                patch.key = {15, 100 + i, 5};
                patch.boxes = {{{1}, 3}};
                state.patches[patch.key] = patch;
            }
            peer.send_result(state, true, 60000);
            peer.await_ack(1);
        }));
}

}  // namespace

void add_stream_cases(Catalogue& all) {
    add(all, "R-102/length-0", "A frame of length 0", header(0, 0), malformed);
    add(all, "R-102/word-1", "The header's second word is 1", header(64, 1), malformed);
    add(all, "R-102/word-max", "The header's second word is all ones", header(64, UINT32_MAX), malformed);
    add(all, "R-103/big-endian", "The header is big-endian", header(0x48000000, 0), too_long);
    add_first(all, "R-102/first-word", "The first header's second word is not 0", header(64, 0x01000000),
              malformed);
    add_first(all, "R-102/first-length-0", "The first frame has length 0", header(0, 0), malformed);
    const std::string_view magic = "TROCHOID";
    add_first(all, "R-102/magic-from-server", "The magic comes from the server, which has none",
              Bytes(magic.begin(), magic.end()), malformed);
    add_limits(all);
    all.push_back(
        client_case("R-102/byte-by-byte", "A result that comes one byte at a time", [](ClientTrial& trial) {
            ClientPeer& peer = trial.welcome();
            InterestState state;
            state.boxes = small_sea().boxes;
            for (const Delta& piece : peer.pieces_to(state, true))
                for (const uint8_t byte : frame(encode(ServerMessage{piece}))) peer.send_bytes({&byte, 1});
            peer.hold(1, state);
            peer.await_ack(1);
        }));
    all.push_back(
        client_case("R-102/joined", "A hello and a result in one stretch of bytes", [](ClientTrial& trial) {
            ClientPeer& peer = trial.accept();
            peer.await_hello();
            peer.prepare(peer.usual_hello());
            Bytes bytes = frame(encode(ServerMessage{peer.ours()}));
            for (const Delta& piece : peer.pieces_to(small_sea(), true)) {
                const Bytes more = frame(encode(ServerMessage{piece}));
                bytes.insert(bytes.end(), more.begin(), more.end());
            }
            peer.send_bytes(bytes);
            peer.hold(1, small_sea());
            peer.await_ack(1);
        }));
    all.push_back(
        client_case("R-102/cut", "The stream ends in the middle of a frame", [](ClientTrial& trial) {
            ClientPeer& peer = trial.welcome();
            peer.send_bytes(header(100, 0));
            peer.stream().finish();
            peer.expect_end();
        }));
}

}  // namespace trochoid::conformance::client
