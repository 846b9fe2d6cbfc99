#include "tests/support/net/form_server.hpp"

#include <openssl/ssl.h>

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/ssl/stream.hpp>
#include <boost/asio/write.hpp>
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/http/empty_body.hpp>
#include <boost/beast/http/message.hpp>
#include <boost/beast/http/read.hpp>
#include <boost/beast/websocket/ssl.hpp>
#include <boost/beast/websocket/stream.hpp>
#include <functional>
#include <sstream>
#include <type_traits>
#include <utility>
#include <vector>

#include "protocol/codec/codec.hpp"
#include "protocol/units/assert.hpp"
#include "protocol/wire/frame.hpp"

namespace trochoid {

namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = beast::http;
namespace ssl = asio::ssl;
namespace websocket = beast::websocket;
using boost::system::error_code;
using Tcp = asio::ip::tcp;
using Milliseconds = FormServer::Milliseconds;
using Request = http::request<http::empty_body>;

/// What ends a step: handlers of every kind come down to it.
using Ended = std::function<void(error_code, size_t)>;

/// One client's stream, whatever its form.
struct Wire {
    Wire() = default;
    Wire(const Wire&) = delete;
    Wire& operator=(const Wire&) = delete;
    virtual ~Wire() = default;
    virtual Tcp::socket& socket() = 0;
    virtual SSL* tls() { return nullptr; }
    virtual void shake_hands(const Ended& done) { done({}, 0); }
    virtual void read_request(beast::flat_buffer& into, Request& request, Ended done) = 0;
    virtual void upgrade(const Request& /*request*/, const std::string& /*subprotocol*/, const Ended& done) {
        done({}, 0);
    }
    /// Appends some bytes, or a whole message.
    virtual void read(beast::flat_buffer& into, Ended done) = 0;
    virtual void write(std::span<const uint8_t> bytes, bool text, Ended done) = 0;
    /// Below any WebSocket.
    virtual void write_stream(std::span<const uint8_t> bytes, Ended done) = 0;
    virtual bool is_proper_end(const error_code& end) const = 0;
};

template <class Layer>
Layer make_layer(asio::io_context& io, ssl::context& context) {
    if constexpr (std::is_same_v<Layer, Tcp::socket>)
        return Layer(io);
    else
        return Layer(io, context);
}

template <class Layer>
struct StreamWire : Wire {
    static constexpr bool secure = !std::is_same_v<Layer, Tcp::socket>;
    Layer layer;
    StreamWire(asio::io_context& io, ssl::context& context) : layer(make_layer<Layer>(io, context)) {}
    Tcp::socket& socket() override {
        if constexpr (secure)
            return layer.next_layer();
        else
            return layer;
    }
    SSL* tls() override {
        if constexpr (secure)
            return layer.native_handle();
        else
            return nullptr;
    }
    void shake_hands(const Ended& done) override {
        if constexpr (secure)
            layer.async_handshake(ssl::stream_base::server, [done](error_code e) { done(e, 0); });
        else
            done({}, 0);
    }
    void read_request(beast::flat_buffer& into, Request& request, Ended done) override {
        http::async_read(layer, into, request, std::move(done));
    }
    void read(beast::flat_buffer& into, Ended done) override {
        layer.async_read_some(into.prepare(65536), [&into, done = std::move(done)](error_code e, size_t n) {
            into.commit(n);
            done(e, n);
        });
    }
    void write(std::span<const uint8_t> bytes, bool /*text*/, Ended done) override {
        write_stream(bytes, std::move(done));
    }
    void write_stream(std::span<const uint8_t> bytes, Ended done) override {
        asio::async_write(layer, asio::buffer(bytes.data(), bytes.size()), std::move(done));
    }
    /// TLS: close_notify came before the end; else that would be a truncated stream.
    bool is_proper_end(const error_code& end) const override { return end == asio::error::eof; }
};

template <class Layer>
struct WebWire final : StreamWire<Layer> {
    websocket::stream<Layer&, false> web;
    WebWire(asio::io_context& io, ssl::context& context) : StreamWire<Layer>(io, context), web(this->layer) {}
    void upgrade(const Request& request, const std::string& subprotocol, const Ended& done) override {
        web.set_option(websocket::stream_base::decorator([subprotocol](websocket::response_type& response) {
            if (!subprotocol.empty()) response.set(http::field::sec_websocket_protocol, subprotocol);
        }));
        web.auto_fragment(false);
        web.async_accept(request, [done](error_code e) { done(e, 0); });
    }
    void read(beast::flat_buffer& into, Ended done) override { web.async_read(into, std::move(done)); }
    void write(std::span<const uint8_t> bytes, bool text, Ended done) override {
        web.text(text);
        web.async_write(asio::buffer(bytes.data(), bytes.size()), std::move(done));
    }
    bool is_proper_end(const error_code& end) const override { return end == websocket::error::closed; }
};

}  // namespace

struct FormServer::Impl {
    explicit Impl(ServerForm f) : form(std::move(f)) {
        if (!form.tls) return;
        identity.use_certificate_chain(asio::buffer(form.certificate));
        identity.use_private_key(asio::buffer(form.key), ssl::context::pem);
        if (form.old_tls) SSL_CTX_set_max_proto_version(identity.native_handle(), TLS1_2_VERSION);
        SSL_CTX_set_alpn_select_cb(identity.native_handle(), &choose_protocol, &form);
    }

    ServerForm form;
    asio::io_context context;
    ssl::context identity{ssl::context::tls_server};
    Tcp::acceptor acceptor{context, {asio::ip::address_v4::loopback(), 0}};
    uint16_t port = acceptor.local_endpoint().port();
    std::unique_ptr<Wire> wire;
    Request request;
    beast::flat_buffer arrived;
    std::optional<FrameReader> frames;
    error_code end;

    static int choose_protocol(SSL*, const unsigned char** chosen, unsigned char* chosen_length,
                               const unsigned char* offered, unsigned offered_length, void* context) {
        const std::string& wanted = static_cast<const ServerForm*>(context)->protocol;
        if (wanted.empty()) return SSL_TLSEXT_ERR_NOACK;
        for (unsigned at = 0; at < offered_length; at += offered[at] + 1U)
            if (std::string(reinterpret_cast<const char*>(offered) + at + 1, offered[at]) == wanted) {
                *chosen = offered + at + 1;
                *chosen_length = offered[at];
                return SSL_TLSEXT_ERR_OK;
            }
        return SSL_TLSEXT_ERR_ALERT_FATAL;
    }

    /// Starts a step and runs it to its end, or to the deadline; then the client is dropped.
    template <class Start>
    bool runs(Milliseconds within, Start start) {
        bool done = false;
        end = {};
        start([this, &done](error_code e, size_t) {
            done = true;
            end = e;
        });
        context.restart();
        context.run_for(within);
        if (done) return !end;
        error_code ignored;
        acceptor.cancel(ignored);
        if (wire) wire->socket().close(ignored);
        context.restart();
        context.run();
        end = asio::error::timed_out;
        return false;
    }

    bool take_client(Milliseconds within) {
        wire.reset();
        arrived.clear();
        request = {};
        frames.emplace(FrameReader::Opening::magic, 1U << 20);
        wire = make_wire();
        if (!runs(within, [this](Ended done) {
                acceptor.async_accept(wire->socket(), [done = std::move(done)](error_code e) { done(e, 0); });
            }))
            return false;
        wire->socket().set_option(Tcp::no_delay(true));
        return runs(within, [this](const Ended& done) { wire->shake_hands(done); });
    }
    std::unique_ptr<Wire> make_wire() {
        using Tls = ssl::stream<Tcp::socket>;
        if (form.tls && form.web) return std::make_unique<WebWire<Tls>>(context, identity);
        if (form.tls) return std::make_unique<StreamWire<Tls>>(context, identity);
        if (form.web) return std::make_unique<WebWire<Tcp::socket>>(context, identity);
        return std::make_unique<StreamWire<Tcp::socket>>(context, identity);
    }
    bool read_request(Milliseconds within) {
        return runs(within, [this](Ended done) { wire->read_request(arrived, request, std::move(done)); });
    }
    bool write(std::span<const uint8_t> bytes, bool text) {
        return runs(patience, [&](Ended done) { wire->write(bytes, text, std::move(done)); });
    }
    /// A payload out of what has arrived.
    std::optional<Bytes> next_payload() {
        const auto* begin = static_cast<const uint8_t*>(arrived.data().data());
        std::span<const uint8_t> input(begin, arrived.size());
        if (form.web) {
            if (input.empty()) return std::nullopt;
            Bytes whole(input.begin(), input.end());
            arrived.clear();
            return whole;
        }
        const size_t before = input.size();
        Result<std::optional<Bytes>> payload = frames->next(input);
        TROCHOID_ASSERT(payload.has_value(), "the client's stream is broken: {}", payload.error().message);
        arrived.consume(before - input.size());
        return std::move(*payload);
    }
};

FormServer::FormServer(const ServerForm& form) : impl_(std::make_unique<Impl>(form)) {}
FormServer::~FormServer() = default;

uint16_t FormServer::port() const { return impl_->port; }

bool FormServer::accept(Milliseconds within) {
    Impl& my = *impl_;
    if (!my.take_client(within)) return false;
    if (!my.form.web) return true;
    return my.read_request(within) && my.runs(within, [&my](const Ended& done) {
        my.wire->upgrade(my.request, my.form.subprotocol, done);
    });
}

bool FormServer::answer_http(const std::string& bytes) {
    Impl& my = *impl_;
    const std::span<const uint8_t> answer(reinterpret_cast<const uint8_t*>(bytes.data()), bytes.size());
    if (!my.take_client(patience) || !my.read_request(patience)) return false;
    const bool sent = my.runs(patience, [&](Ended done) { my.wire->write_stream(answer, std::move(done)); });
    error_code ignored;
    my.wire->socket().shutdown(Tcp::socket::shutdown_send, ignored);
    return sent;
}

std::string FormServer::request() const {
    std::ostringstream text;
    text << impl_->request.base();
    return text.str();
}

std::string FormServer::chosen_protocol() const {
    const unsigned char* name = nullptr;
    unsigned length = 0;
    SSL_get0_alpn_selected(impl_->wire->tls(), &name, &length);
    return length == 0 ? std::string() : std::string(reinterpret_cast<const char*>(name), length);
}

std::string FormServer::asked_name() const {
    const char* name = SSL_get_servername(impl_->wire->tls(), TLSEXT_NAMETYPE_host_name);
    return name == nullptr ? std::string() : name;
}

std::optional<ClientHello> FormServer::log_in(const ServerHello& hello) {
    if (!accept()) return std::nullopt;
    const auto first = receive();
    if (!first || !std::holds_alternative<ClientHello>(*first)) return std::nullopt;
    if (!send(hello)) return std::nullopt;
    return std::get<ClientHello>(*first);
}

bool FormServer::send(const ServerMessage& message) {
    const Bytes payload = encode(message);
    return impl_->write(impl_->form.web ? payload : frame(payload), false);
}

bool FormServer::send_bytes(std::span<const uint8_t> bytes) { return impl_->write(bytes, false); }

bool FormServer::send_text(const std::string& text) {
    return impl_->write({reinterpret_cast<const uint8_t*>(text.data()), text.size()}, true);
}

std::optional<ClientMessage> FormServer::receive(Milliseconds within) {
    Impl& my = *impl_;
    while (true) {
        if (const std::optional<Bytes> payload = my.next_payload()) {
            Result<ClientMessage> message = decode_client(*payload);
            TROCHOID_ASSERT(message.has_value(), "the client sent: {}", message.error().message);
            return std::move(*message);
        }
        if (!my.runs(within, [&my](Ended done) { my.wire->read(my.arrived, std::move(done)); }))
            return std::nullopt;
    }
}

bool FormServer::ends_properly() {
    Impl& my = *impl_;
    while (my.runs(patience, [&my](Ended done) { my.wire->read(my.arrived, std::move(done)); }))
        my.arrived.clear();
    return my.wire->is_proper_end(my.end);
}

void FormServer::hang_up() {
    error_code ignored;
    if (impl_->wire) impl_->wire->socket().close(ignored);
}

}  // namespace trochoid
