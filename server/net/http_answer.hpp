#pragma once
#include <string>
#include <string_view>
#include <vector>

#include "server/net/http_request.hpp"

namespace trochoid {

/// An answer after which the connection closes.
struct HttpAnswer {
    unsigned status = 200;
    std::string body;                  ///< text; ends with a line's end
    std::vector<std::string> headers;  ///< further ones, "Allow: GET, HEAD"
    std::string content_type = "text/plain; charset=utf-8";
    bool operator==(const HttpAnswer&) const = default;
};

/// The bytes of an answer; `head_only`: to a HEAD request, without its body.
std::string text_of(const HttpAnswer& answer, bool head_only);

/// An answer that is one sentence.
HttpAnswer sentence(unsigned status, std::string_view words, std::vector<std::string> headers = {});

}  // namespace trochoid
