#include "tests/conformance/server/refusals.hpp"

#include <utility>

namespace trochoid::conformance::server {

Case refused(std::string id, std::string title, Bytes payload, Answer answer) {
    return server_case(std::move(id), std::move(title),
                       [payload = std::move(payload), answer](ServerTrial& trial) {
                           ServerPeer& peer = trial.log_in();
                           peer.send_payload(payload);
                           peer.expect_goodbye(answer.code, answer.requirement);
                       });
}

Case refused_first(std::string id, std::string title, Bytes payload, Answer answer) {
    return server_case(std::move(id), std::move(title),
                       [payload = std::move(payload), answer](ServerTrial& trial) {
                           ServerPeer& peer = trial.connect();
                           peer.send_magic();
                           peer.send_payload(payload);
                           peer.expect_goodbye(answer.code, answer.requirement);
                       });
}

Case taken(std::string id, std::string title, Bytes payload) {
    return server_case(std::move(id), std::move(title), [payload = std::move(payload)](ServerTrial& trial) {
        ServerPeer& peer = trial.log_in();
        peer.send_payload(payload);
        peer.expect_service();
    });
}

Case taken_first(std::string id, std::string title, Bytes payload) {
    return server_case(std::move(id), std::move(title), [payload = std::move(payload)](ServerTrial& trial) {
        ServerPeer& peer = trial.connect();
        peer.send_magic();
        peer.send_payload(payload);
        peer.await<ServerHello>("hello");
        peer.expect_service();
    });
}

}  // namespace trochoid::conformance::server
