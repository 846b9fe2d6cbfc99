#pragma once
#include <optional>
#include <string>

#include "server/net/door_policy.hpp"
#include "server/net/http_answer.hpp"

namespace trochoid {

/// What an answer depends on besides the request.
struct HttpSituation {
    const DoorPolicy& policy;
    bool ready = false;     ///< the scene is open
    bool draining = false;  ///< the server is shutting down
    bool encrypt = false;   ///< the peer needs TLS for what is not public, and has none
    bool too_many = false;  ///< the peer's address has too many connections
};

/// Whether the request is for the metrics (and may be: asked after `http_answer_to` gave nothing).
bool asks_for_metrics(const HttpRequest& request);

/// The answer to a request; nothing: give it the metrics, or do the upgrade that it asks for.
std::optional<HttpAnswer> http_answer_to(const HttpRequest& request, const HttpSituation& situation);

}  // namespace trochoid
