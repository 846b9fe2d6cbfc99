#include "client/net/web_stream.hpp"

#include <fmt/format.h>

#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/websocket/ssl.hpp>
#include <boost/beast/websocket/stream.hpp>
#include <optional>
#include <type_traits>
#include <utility>
#include <vector>

#include "client/net/net_loop_asio.hpp"
#include "client/net/stranger.hpp"
#include "client/net/tcp_dial.hpp"
#include "client/net/tls_trust.hpp"
#include "protocol/units/version.hpp"
#include "protocol/wire/session_rules.hpp"

// The only source with Beast: it costs most of a minute to compile.
namespace trochoid {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = beast::http;
namespace websocket = beast::websocket;
using asio::ip::tcp;
using ErrorOfSystem = boost::system::error_code;
using Response = websocket::response_type;

namespace {

constexpr const char* subprotocol = "trochoid";

/// Name and port as HTTP wants them: without the port where it is the usual one.
std::string host_header(const Endpoint& endpoint) {
    const bool usual = endpoint.port == (endpoint.transport == Transport::wss ? 443 : 80);
    const std::string whole = host_and_port(endpoint);
    return usual ? whole.substr(0, whole.rfind(':')) : whole;
}

/// "HTTP 403: the first line of what it says"
std::string quoted(const Response& response) {
    const std::string& body = response.body();
    const std::string line = printable(std::string_view(body).substr(0, body.find_first_of("\r\n")), 200);
    return fmt::format("HTTP {}{}{}", response.result_int(), line.empty() ? "" : ": ", line);
}

/// Why an HTTP server would not make the connection a WebSocket.
std::string declined(const Response& response, const Endpoint& endpoint) {
    const std::string server = to_text(endpoint);
    const std::string says = quoted(response);
    switch (response.result()) {
        case http::status::forbidden:
            return fmt::format(
                "the server at {} takes no connections under the name {} ({}){}", server, endpoint.host, says,
                response.body().empty() ? ": use one of its addresses, or start it with --allow-host" : "");
        case http::status::not_found:
            return fmt::format("the web server at {} has no WebSocket ({}): check --connect", server, says);
        case http::status::upgrade_required:
            if (!is_encrypted(endpoint.transport))
                return fmt::format("the server at {} wants encryption ({}): use --connect {}", server, says,
                                   to_text(with_encryption(endpoint, true)));
            break;
        case http::status::too_many_requests:
        case http::status::service_unavailable:
            return fmt::format("the server at {} takes nobody at the moment ({}): try again later", server,
                               says);
        default: break;
    }
    const auto location = response.find(http::field::location);
    if (location != response.end())
        return fmt::format("the web server at {} points to {} ({}): check --connect", server,
                           printable({location->value().data(), location->value().size()}, 120), says);
    return fmt::format("the web server at {} refuses the WebSocket ({}): check --connect", server, says);
}

/// Why there is no WebSocket.
Error no_upgrade(const ErrorOfSystem& error, const Response& response, const Endpoint& endpoint) {
    if (error == websocket::error::upgrade_declined) return {ErrorCode::none, declined(response, endpoint)};
    const std::string server = to_text(endpoint);
    if (is_end_of_stream(error) || error == http::error::end_of_stream ||
        error == http::error::partial_message)
        return {ErrorCode::none,
                fmt::format("the server at {} closed the connection instead of making it a WebSocket: check "
                            "--connect, or use {}",
                            server, is_encrypted(endpoint.transport) ? "tls://" : "wss:// or tcp://")};
    const ErrorOfSystem http_error = http::error::bad_version;
    const ErrorOfSystem web_error = websocket::error::no_upgrade;
    if (error.category() == http_error.category() || error.category() == web_error.category())
        return {ErrorCode::none,
                fmt::format("what listens at {} is no server of WebSockets ({}): check --connect, or use {}",
                            server, error.message(),
                            is_encrypted(endpoint.transport) ? "tls://" : "wss:// or tcp://")};
    return end_of_connection(error, endpoint);
}

template <class Layer>
class WebStream final : public ClientStream, public std::enable_shared_from_this<WebStream<Layer>> {
    static constexpr bool secure = !std::is_same_v<Layer, tcp::socket>;

public:
    WebStream(NetLoop& loop, const Endpoint& endpoint) requires(!secure)
        : endpoint_(endpoint), dial_(loop), socket_(loop.impl().io) {
        prepare();
    }
    WebStream(NetLoop& loop, const Endpoint& endpoint) requires(secure)
        : endpoint_(endpoint), dial_(loop), trust_(endpoint), socket_(loop.impl().io, trust_->context()) {
        prepare();
    }

    const char* awaits() const override { return awaits_; }
    bool keeps_messages() const override { return true; }
    void set_longest(uint32_t bytes) override { longest_ = bytes; }

    void dial(Dialled done) override {
        tcp::socket* socket = nullptr;
        if constexpr (secure)
            socket = &socket_.next_layer().next_layer();
        else
            socket = &socket_.next_layer();
        dial_.connect(
            *socket, endpoint_,
            [this, self = this->shared_from_this(), done = std::move(done)](const Result<Done>& outcome) {
                if (!outcome) return done(outcome);
                if constexpr (secure)
                    shake_hands(done);
                else
                    upgrade(done);
            });
    }

    void read(Arrived done) override {
        // One more than may come shows that it is too long; what a header announces allocates nothing.
        socket_.async_read_some(message_, longest_ + 1 - message_.size(),
                                [this, self = this->shared_from_this(), done = std::move(done)](
                                    const ErrorOfSystem& error, size_t) mutable {
                                    if (!closed_) take(error, std::move(done));
                                });
    }
    void write(std::span<const uint8_t> bytes, Written done) override {
        socket_.async_write(asio::buffer(bytes.data(), bytes.size()),
                            [this, self = this->shared_from_this(), done = std::move(done)](
                                const ErrorOfSystem&, size_t count) {
                                if (!closed_) done(count);
                            });
    }
    void shut() override {
        shut_ = true;
        socket_.async_close(websocket::close_code::normal,
                            [self = this->shared_from_this()](const ErrorOfSystem&) {});
    }
    void close() override {
        ErrorOfSystem ignored;
        closed_ = true;
        dial_.give_up();
        beast::get_lowest_layer(socket_).close(ignored);
    }

private:
    void prepare() {
        socket_.binary(true);
        socket_.auto_fragment(false);
        socket_.read_message_max(0);  // read() counts
        socket_.set_option(websocket::stream_base::decorator([](websocket::request_type& request) {
            request.set(http::field::sec_websocket_protocol, subprotocol);
            request.set(http::field::user_agent, fmt::format("Trochoid/{}", software_version()));
        }));
    }
    void shake_hands(const Dialled& done) {
        if constexpr (secure) {
            awaits_ = "no TLS handshake came from what listens";
            if (const auto ready = trust_->prepare(socket_.next_layer(), "http/1.1"); !ready)
                return done(ready);
            socket_.next_layer().async_handshake(
                asio::ssl::stream_base::client,
                [this, self = this->shared_from_this(), done](const ErrorOfSystem& error) {
                    if (closed_) return;
                    if (error) return done(trust_->failure(error));
                    upgrade(done);
                });
        }
    }
    void upgrade(const Dialled& done) {
        awaits_ = "no answer to the WebSocket's upgrade came from what listens";
        socket_.async_handshake(response_, host_header(endpoint_), "/",
                                [this, self = this->shared_from_this(), done](const ErrorOfSystem& error) {
                                    if (!closed_) done(upgraded(error));
                                });
    }
    Result<Done> upgraded(const ErrorOfSystem& error) {
        if (error) return no_upgrade(error, response_, endpoint_);
        // RFC 6455, 4.1: what was not offered cannot be agreed to.
        if (response_.find(http::field::sec_websocket_extensions) != response_.end())
            return Error{ErrorCode::none,
                         fmt::format("the server at {} wants a WebSocket extension that nobody asked for: "
                                     "check --connect",
                                     to_text(endpoint_))};
        if (response_[http::field::sec_websocket_protocol] != subprotocol)
            return Error{ErrorCode::none,
                         fmt::format("the server at {} has WebSockets, but not Trochoid's: check --connect",
                                     to_text(endpoint_))};
        response_ = {};
        return Done{};
    }
    void take(const ErrorOfSystem& error, Arrived done) {
        if (error) return end(error, done);
        if (!socket_.got_binary()) {
            message_.clear();
            return done(Error{ErrorCode::malformed_frame, "a WebSocket message is text: send binary ones"});
        }
        if (message_.size() > longest_) {
            message_.clear();
            return done(Error{ErrorCode::frame_too_long,
                              fmt::format("a message is longer than the limit of {} bytes", longest_)});
        }
        if (!socket_.is_message_done()) return read(std::move(done));
        const auto* begin = static_cast<const uint8_t*>(message_.data().data());
        const std::vector<uint8_t> whole(begin, begin + message_.size());
        message_.clear();
        done(std::span<const uint8_t>(whole));
    }
    /// Ours goes on to its close_notify also where the server's close frame did not come.
    void end(const ErrorOfSystem& error, const Arrived& done) {
        if constexpr (secure) {
            if (shut_)
                return socket_.next_layer().async_shutdown(
                    [this, self = this->shared_from_this(), error, done](const ErrorOfSystem&) {
                        if (!closed_) done(ended(error));
                    });
        }
        done(ended(error));
    }
    Error ended(const ErrorOfSystem& error) const {
        const websocket::close_reason& reason = socket_.reason();
        if (error != websocket::error::closed) return end_of_connection(error, endpoint_);
        if (reason.code == websocket::close_code::normal || reason.code == websocket::close_code::none)
            return end_of_connection(asio::error::eof, endpoint_);
        return {ErrorCode::none,
                fmt::format("the server at {} closed the WebSocket ({} {})", to_text(endpoint_), reason.code,
                            printable({reason.reason.data(), reason.reason.size()}, 120))};
    }

    Endpoint endpoint_;
    TcpDial dial_;
    std::optional<TlsTrust> trust_;  // where it is secure
    websocket::stream<Layer, false> socket_;
    Response response_;
    beast::flat_buffer message_;
    uint32_t longest_ = Limits{}.frame_to_client;
    const char* awaits_ = "nothing answered";
    bool closed_ = false;
    bool shut_ = false;
};

}  // namespace

std::shared_ptr<ClientStream> make_web_stream(NetLoop& loop, const Endpoint& endpoint) {
    if (endpoint.transport == Transport::wss)
        return std::make_shared<WebStream<TlsTrust::Stream>>(loop, endpoint);
    return std::make_shared<WebStream<tcp::socket>>(loop, endpoint);
}

}  // namespace trochoid
