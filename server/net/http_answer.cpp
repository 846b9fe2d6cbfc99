#include "server/net/http_answer.hpp"

#include <fmt/format.h>

#include <utility>

namespace trochoid {

namespace {

std::string_view reason(unsigned status) {
    switch (status) {
        case 200: return "OK";
        case 400: return "Bad Request";
        case 403: return "Forbidden";
        case 404: return "Not Found";
        case 405: return "Method Not Allowed";
        case 408: return "Request Timeout";
        case 413: return "Content Too Large";
        case 426: return "Upgrade Required";
        case 429: return "Too Many Requests";
        case 431: return "Request Header Fields Too Large";
        case 503: return "Service Unavailable";
        case 505: return "HTTP Version Not Supported";
        default: return "Answer";
    }
}

}  // namespace

std::string text_of(const HttpAnswer& answer, bool head_only) {
    std::string text = fmt::format(
        "HTTP/1.1 {} {}\r\nContent-Type: {}\r\nContent-Length: {}\r\nCache-Control: no-store\r\n"
        "X-Content-Type-Options: nosniff\r\n",
        answer.status, reason(answer.status), answer.content_type, answer.body.size());
    bool connection_named = false;
    for (const std::string& header : answer.headers) {
        text += header + "\r\n";
        connection_named = connection_named || header.starts_with("Connection:");
    }
    if (!connection_named) text += "Connection: close\r\n";
    text += "\r\n";
    if (!head_only) text += answer.body;
    return text;
}

HttpAnswer sentence(unsigned status, std::string_view words, std::vector<std::string> headers) {
    return {status, fmt::format("{}\n", words), std::move(headers)};
}

}  // namespace trochoid
