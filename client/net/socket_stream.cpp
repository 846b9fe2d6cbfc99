#include "client/net/socket_stream.hpp"

#include <openssl/ssl.h>

#include <array>
#include <boost/asio/write.hpp>
#include <utility>

#include "client/net/net_loop_asio.hpp"
#include "client/net/tcp_dial.hpp"
#include "client/net/tls_trust.hpp"

namespace trochoid {

namespace asio = boost::asio;
using asio::ip::tcp;
using ErrorOfSystem = boost::system::error_code;

namespace {

/// What plain and TLS streams have in common: bytes, once the layer stands.
template <class Layer>
class SocketStream : public ClientStream, public std::enable_shared_from_this<SocketStream<Layer>> {
public:
    void read(Arrived done) override {
        layer_.async_read_some(asio::buffer(chunk_),
                               [this, self = this->shared_from_this(), done = std::move(done)](
                                   const ErrorOfSystem& error, size_t count) {
                                   if (closed_) return;
                                   if (error)
                                       done(end_of_connection(error, endpoint_));
                                   else
                                       done(std::span<const uint8_t>(chunk_).first(count));
                               });
    }
    void write(std::span<const uint8_t> bytes, Written done) override {
        asio::async_write(layer_, asio::buffer(bytes.data(), bytes.size()),
                          [this, self = this->shared_from_this(), done = std::move(done)](
                              const ErrorOfSystem&, size_t count) {
                              if (!closed_) done(count);
                          });
    }
    void close() override {
        ErrorOfSystem ignored;
        closed_ = true;
        dial_.give_up();
        layer_.lowest_layer().close(ignored);
    }

protected:
    template <class... Made>
    SocketStream(NetLoop& loop, const Endpoint& endpoint, Made&... made)
        : endpoint_(endpoint), dial_(loop), layer_(loop.impl().io, made...) {}

    Endpoint endpoint_;
    TcpDial dial_;
    Layer layer_;
    bool closed_ = false;
    std::array<uint8_t, 16384> chunk_{};
};

class TcpStream final : public SocketStream<tcp::socket> {
public:
    TcpStream(NetLoop& loop, const Endpoint& endpoint) : SocketStream(loop, endpoint) {}
    const char* awaits() const override { return "nothing answered"; }
    void dial(Dialled done) override {
        dial_.connect(layer_, endpoint_,
                      [self = shared_from_this(), done = std::move(done)](const Result<Done>& outcome) {
                          done(outcome);
                      });
    }
    void shut() override {
        ErrorOfSystem ignored;
        layer_.shutdown(tcp::socket::shutdown_send, ignored);
    }
};

/// First of the bases, so that it outlives the layer made with it.
struct Trusting {
    explicit Trusting(const Endpoint& endpoint) : trust(endpoint) {}
    TlsTrust trust;
};

class TlsStream final : private Trusting, public SocketStream<TlsTrust::Stream> {
public:
    TlsStream(NetLoop& loop, const Endpoint& endpoint)
        : Trusting(endpoint), SocketStream(loop, endpoint, trust.context()) {}
    const char* awaits() const override {
        return connected_ ? "no TLS handshake came from what listens" : "nothing answered";
    }
    void dial(Dialled done) override {
        dial_.connect(layer_.next_layer(), endpoint_,
                      [this, self = shared_from_this(), done = std::move(done)](const Result<Done>& outcome) {
                          connected_ = true;
                          if (!outcome) return done(outcome);
                          if (const auto ready = trust.prepare(layer_, "trochoid"); !ready)
                              return done(ready);
                          shake_hands(done);
                      });
    }
    void read(Arrived done) override {
        if (shut_) return drain(std::move(done));
        SocketStream::read([this, done = std::move(done)](const Result<std::span<const uint8_t>>& bytes) {
            if (shut_)
                drain(done);
            else
                done(bytes);
        });
    }
    void shut() override {
        // As if the server's close_notify had come: OpenSSL would take whatever else comes after ours for a breach, and the
        // end of our stream would be a reset that takes our last words with it.
        SSL_set_shutdown(layer_.native_handle(), SSL_RECEIVED_SHUTDOWN);
        shut_ = true;
        layer_.async_shutdown([this, self = shared_from_this()](const ErrorOfSystem&) {
            ErrorOfSystem ignored;
            if (!closed_) layer_.next_layer().shutdown(tcp::socket::shutdown_send, ignored);
        });
    }

private:
    void shake_hands(const Dialled& done) {
        layer_.async_handshake(asio::ssl::stream_base::client,
                               [this, self = shared_from_this(), done](const ErrorOfSystem& error) {
                                   if (closed_) return;
                                   done(error ? Result<Done>(trust.failure(error)) : Result<Done>(Done{}));
                               });
    }
    /// Past TLS, to the end of the stream.
    void drain(Arrived done) {
        layer_.next_layer().async_read_some(asio::buffer(chunk_),
                                            [this, self = shared_from_this(), done = std::move(done)](
                                                const ErrorOfSystem& error, size_t) mutable {
                                                if (closed_) return;
                                                if (!error) return drain(std::move(done));
                                                done(end_of_connection(error, endpoint_));
                                            });
    }
    bool connected_ = false;
    bool shut_ = false;
};

}  // namespace

std::shared_ptr<ClientStream> make_tcp_stream(NetLoop& loop, const Endpoint& endpoint) {
    return std::make_shared<TcpStream>(loop, endpoint);
}

std::shared_ptr<ClientStream> make_tls_stream(NetLoop& loop, const Endpoint& endpoint) {
    return std::make_shared<TlsStream>(loop, endpoint);
}

}  // namespace trochoid
