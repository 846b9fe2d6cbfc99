#include "tests/support/net/byte_pipe.hpp"

#include <openssl/err.h>
#include <openssl/pem.h>
#include <openssl/ssl.h>

#include <algorithm>
#include <array>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/write.hpp>
#include <vector>

namespace trochoid {

namespace {

namespace asio = boost::asio;
using boost::system::error_code;
using Tcp = asio::ip::tcp;
using Clock = std::chrono::steady_clock;

// A connected socket that can be waited on with a deadline.
class WaitingSocket {
public:
    WaitingSocket(uint16_t port, const std::string& address, const std::string& from) {
        const Tcp::endpoint server(asio::ip::make_address(address), port);
        socket.open(server.protocol());
        if (!from.empty()) socket.bind({asio::ip::make_address(from), 0});
        socket.connect(server);
        socket.set_option(Tcp::no_delay(true));
    }
    bool wait(Tcp::socket::wait_type what, Clock::time_point until) {
        bool done = false;
        socket.async_wait(what, [&](const error_code& failed) { done = !failed; });
        context.restart();
        context.run_for(std::max(until - Clock::now(), Clock::duration::zero()));
        if (!done) {
            socket.cancel();
            context.restart();
            context.run();
        }
        return done;
    }
    asio::io_context context;
    Tcp::socket socket{context};
};

class TcpPipe final : public BytePipe {
public:
    TcpPipe(uint16_t port, const std::string& address, const std::string& from) : at_(port, address, from) {}

    bool write(std::span<const uint8_t> bytes) override {
        error_code failed;
        asio::write(at_.socket, asio::buffer(bytes.data(), bytes.size()), failed);
        return !failed;
    }
    size_t read(std::span<uint8_t> into, Milliseconds within) override {
        if (ended_ || !at_.wait(Tcp::socket::wait_read, Clock::now() + within)) return 0;
        error_code failed;
        const size_t bytes = at_.socket.read_some(asio::buffer(into.data(), into.size()), failed);
        ended_ = bool(failed);
        properly_ = failed == asio::error::eof;
        return failed ? 0 : bytes;
    }
    bool ended() const override { return ended_; }
    void finish_writing() override {
        error_code ignored;
        at_.socket.shutdown(Tcp::socket::shutdown_send, ignored);
    }
    void close() override {
        error_code ignored;
        at_.socket.close(ignored);
        ended_ = true;
    }
    bool ended_properly() const override { return ended_ && properly_; }

private:
    WaitingSocket at_;
    bool ended_ = false;
    bool properly_ = false;
};

// A filter that lets one byte through at a time.
int drip(BIO* bio, const char* from, int bytes) {
    BIO* const next = BIO_next(bio);
    const int done = BIO_write(next, from, std::min(bytes, 1));
    BIO_clear_retry_flags(bio);
    BIO_copy_next_retry(bio);
    return done;
}

const BIO_METHOD* drip_method() {
    static BIO_METHOD* const method = [] {
        BIO_METHOD* const made = BIO_meth_new(BIO_get_new_index() | BIO_TYPE_FILTER, "drip");
        BIO_meth_set_write(made, drip);
        BIO_meth_set_read(made, [](BIO* bio, char* into, int bytes) {
            const int done = BIO_read(BIO_next(bio), into, bytes);
            BIO_clear_retry_flags(bio);
            BIO_copy_next_retry(bio);
            return done;
        });
        BIO_meth_set_ctrl(made, [](BIO* bio, int what, long number, void* thing) {
            return BIO_ctrl(BIO_next(bio), what, number, thing);
        });
        BIO_meth_set_create(made, [](BIO* bio) {
            BIO_set_init(bio, 1);
            return 1;
        });
        return made;
    }();
    return method;
}

class TlsPipe final : public BytePipe {
public:
    TlsPipe(uint16_t port, const TlsWish& wish) : at_(port, "127.0.0.1", wish.from) {
        at_.socket.non_blocking(true);
        SSL_CTX_set_min_proto_version(context_.get(), TLS1_2_VERSION);
        if (wish.old_tls) SSL_CTX_set_max_proto_version(context_.get(), TLS1_2_VERSION);
        if (!wish.trusted.empty()) trust(wish.trusted);
        ssl_.reset(SSL_new(context_.get()));
        BIO* bio = BIO_new_socket(at_.socket.native_handle(), BIO_NOCLOSE);
        if (wish.drip) bio = BIO_push(BIO_new(drip_method()), bio);
        SSL_set_bio(ssl_.get(), bio, bio);
        SSL_set_tlsext_host_name(ssl_.get(), wish.host.c_str());
        if (!wish.trusted.empty()) SSL_set1_host(ssl_.get(), wish.host.c_str());
        if (!wish.groups.empty()) SSL_set1_groups_list(ssl_.get(), wish.groups.c_str());
        if (!wish.protocols.empty())
            SSL_set_alpn_protos(ssl_.get(), reinterpret_cast<const unsigned char*>(wish.protocols.data()),
                                static_cast<unsigned>(wish.protocols.size()));
    }
    bool shake_hands() {
        return run([this] { return SSL_connect(ssl_.get()); }, Clock::now() + patience) == 1;
    }
    bool write(std::span<const uint8_t> bytes) override {
        if (ended_) return false;
        return bytes.empty() ||
               run([&] { return SSL_write(ssl_.get(), bytes.data(), static_cast<int>(bytes.size())); },
                   Clock::now() + patience) > 0;
    }
    size_t read(std::span<uint8_t> into, Milliseconds within) override {
        if (ended_) return 0;
        const int bytes =
            run([&] { return SSL_read(ssl_.get(), into.data(), static_cast<int>(into.size())); },
                Clock::now() + within);
        return bytes > 0 ? static_cast<size_t>(bytes) : 0;
    }
    bool ended() const override { return ended_; }
    void finish_writing() override {
        SSL_shutdown(ssl_.get());
        error_code ignored;
        at_.socket.shutdown(Tcp::socket::shutdown_send, ignored);
    }
    void close() override {
        error_code ignored;
        at_.socket.close(ignored);
        ended_ = true;
    }
    bool ended_properly() const override {
        return ended_ && (SSL_get_shutdown(ssl_.get()) & SSL_RECEIVED_SHUTDOWN) != 0;
    }
    std::string protocol() const {
        const unsigned char* name = nullptr;
        unsigned length = 0;
        SSL_get0_alpn_selected(ssl_.get(), &name, &length);
        return {reinterpret_cast<const char*>(name), length};
    }

private:
    void trust(const std::string& pem) {
        BIO* const text = BIO_new_mem_buf(pem.data(), static_cast<int>(pem.size()));
        X509* const authority = PEM_read_bio_X509(text, nullptr, nullptr, nullptr);
        X509_STORE_add_cert(SSL_CTX_get_cert_store(context_.get()), authority);
        SSL_CTX_set_verify(context_.get(), SSL_VERIFY_PEER, nullptr);
        X509_free(authority);
        BIO_free(text);
    }
    // Until the call is done, the stream has ended, or time is up (0).
    template <class Call>
    int run(Call call, Clock::time_point until) {
        while (true) {
            ERR_clear_error();
            const int done = call();
            if (done > 0) return done;
            switch (SSL_get_error(ssl_.get(), done)) {
                case SSL_ERROR_WANT_READ:
                    if (!at_.wait(Tcp::socket::wait_read, until)) return 0;
                    break;
                case SSL_ERROR_WANT_WRITE:
                    if (!at_.wait(Tcp::socket::wait_write, until)) return 0;
                    break;
                default: ended_ = true; return 0;
            }
        }
    }

    WaitingSocket at_;
    std::unique_ptr<SSL_CTX, decltype(&SSL_CTX_free)> context_{SSL_CTX_new(TLS_client_method()),
                                                               SSL_CTX_free};
    std::unique_ptr<SSL, decltype(&SSL_free)> ssl_{nullptr, SSL_free};
    bool ended_ = false;
};

}  // namespace

bool BytePipe::write(const std::string& text) {
    return write(std::span(reinterpret_cast<const uint8_t*>(text.data()), text.size()));
}

std::string BytePipe::read_all(Milliseconds within) {
    const auto until = Clock::now() + within;
    std::string all;
    std::array<uint8_t, 4096> buffer{};
    while (!ended() && Clock::now() < until) {
        const size_t bytes =
            read(buffer, std::chrono::duration_cast<Milliseconds>(until - Clock::now()) + Milliseconds(1));
        all.append(reinterpret_cast<const char*>(buffer.data()), bytes);
    }
    return all;
}

std::unique_ptr<BytePipe> connect_tcp(uint16_t port, const std::string& address, const std::string& from) {
    return std::make_unique<TcpPipe>(port, address, from);
}

std::unique_ptr<BytePipe> connect_tls(uint16_t port, const TlsWish& wish) {
    auto pipe = std::make_unique<TlsPipe>(port, wish);
    if (!pipe->shake_hands()) return nullptr;
    return pipe;
}

std::string chosen_protocol(const BytePipe& tls) {
    const auto* pipe = dynamic_cast<const TlsPipe*>(&tls);
    return pipe == nullptr ? std::string() : pipe->protocol();
}

}  // namespace trochoid
