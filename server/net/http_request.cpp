#include "server/net/http_request.hpp"

#include <fmt/format.h>

#include <boost/asio/buffer.hpp>
#include <boost/beast/http/empty_body.hpp>
#include <boost/beast/http/parser.hpp>
#include <boost/beast/http/rfc7230.hpp>

namespace trochoid {

namespace {

namespace http = boost::beast::http;

std::string text(boost::beast::string_view view) { return {view.data(), view.size()}; }

}  // namespace

std::variant<HttpRequest, HttpRefusal> read_http_head(std::string_view head) {
    http::request_parser<http::empty_body> parser;
    parser.header_limit(longest_http_head);
    boost::system::error_code failed;
    parser.put(boost::asio::buffer(head.data(), head.size()), failed);
    if (failed == http::error::header_limit)
        return HttpRefusal{431, fmt::format("the head is longer than {} bytes", longest_http_head)};
    if (failed == http::error::bad_version) return HttpRefusal{505, "HTTP/1.1 is spoken here"};
    if (failed || !parser.is_header_done())
        return HttpRefusal{400, fmt::format("this is no HTTP request ({})",
                                            failed ? failed.message() : "its head does not end")};
    const auto& request = parser.get();

    HttpRequest result;
    result.has_body = parser.chunked() || parser.content_length().value_or(0) > 0;
    result.method = text(request.method_string());
    result.target = text(request.target());
    result.names_host = request.version() >= 11;
    result.host = text(request[http::field::host]);
    result.origin = text(request[http::field::origin]);
    if (request.count(http::field::host) > 1 || request.count(http::field::origin) > 1)
        return HttpRefusal{400, "Host and Origin may be named once"};
    result.websocket_version = text(request[http::field::sec_websocket_version]);
    result.websocket_key = text(request[http::field::sec_websocket_key]);
    result.upgrade = http::token_list(request[http::field::upgrade]).exists("websocket") &&
                     http::token_list(request[http::field::connection]).exists("upgrade");
    const auto protocols = request.equal_range(http::field::sec_websocket_protocol);
    for (auto field = protocols.first; field != protocols.second; ++field)
        for (const auto token : http::token_list(field->value())) result.subprotocols.push_back(text(token));
    return result;
}

}  // namespace trochoid
