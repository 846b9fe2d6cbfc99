#include "server/net/tls_transport.hpp"

#include <fmt/format.h>
#include <openssl/bio.h>
#include <openssl/err.h>
#include <openssl/ssl.h>

#include <algorithm>
#include <utility>

#include "protocol/units/assert.hpp"
#include "protocol/wire/requirements.hpp"
#include "server/net/soon.hpp"

namespace trochoid {

namespace {

// OpenSSL's view of a Transport, so that it needs no buffers of its own for what goes in and out.
int read_bio(BIO* bio, char* into, int bytes) {
    BIO_clear_retry_flags(bio);
    auto* const inner = static_cast<Transport*>(BIO_get_data(bio));
    const auto moved = inner->read({reinterpret_cast<uint8_t*>(into), static_cast<size_t>(bytes)});
    if (moved.closed) return 0;
    if (moved.bytes == 0) {
        BIO_set_retry_read(bio);
        return -1;
    }
    return static_cast<int>(moved.bytes);
}

int write_bio(BIO* bio, const char* from, int bytes) {
    BIO_clear_retry_flags(bio);
    auto* const inner = static_cast<Transport*>(BIO_get_data(bio));
    const auto moved = inner->write({reinterpret_cast<const uint8_t*>(from), static_cast<size_t>(bytes)});
    if (moved.closed) return -1;
    if (moved.bytes == 0) {
        BIO_set_retry_write(bio);
        return -1;
    }
    return static_cast<int>(moved.bytes);
}

long control_bio(BIO*, int what, long, void*) { return what == BIO_CTRL_FLUSH ? 1 : 0; }

const BIO_METHOD* transport_method() {
    static const std::unique_ptr<BIO_METHOD, decltype(&BIO_meth_free)> method = [] {
        std::unique_ptr<BIO_METHOD, decltype(&BIO_meth_free)> made(
            BIO_meth_new(BIO_get_new_index() | BIO_TYPE_SOURCE_SINK, "trochoid transport"), BIO_meth_free);
        BIO_meth_set_read(made.get(), read_bio);
        BIO_meth_set_write(made.get(), write_bio);
        BIO_meth_set_ctrl(made.get(), control_bio);
        return made;
    }();
    return method.get();
}

// What a failed handshake, or a record that does not decrypt, is counted as.
Error fault_of(unsigned long code, bool established) {
    const int reason = ERR_GET_REASON(code);
    const bool version = reason == SSL_R_UNSUPPORTED_PROTOCOL || reason == SSL_R_WRONG_SSL_VERSION ||
                         reason == SSL_R_VERSION_TOO_LOW || reason == SSL_R_TLSV1_ALERT_PROTOCOL_VERSION;
    if (version) return {ErrorCode::protocol_version, "TLS 1.3 is needed: connect with that"};
    const char* text = ERR_reason_error_string(code);
    return {ErrorCode::malformed_frame,
            fmt::format("{}: {}; connect again with TLS 1.3",
                        established ? "the TLS stream is broken" : "the TLS handshake failed",
                        text == nullptr ? "no reason is given" : text)};
}

class TlsStream final : public TlsTransport {
public:
    TlsStream(IoLoop& loop, const TlsIdentity& identity, std::unique_ptr<Transport> inner)
        : inner_(std::move(inner)), ssl_(SSL_new(identity.context()), SSL_free), soon_(loop) {
        BIO* const bio = BIO_new(transport_method());
        TROCHOID_ASSERT(ssl_ && bio != nullptr, "OpenSSL is out of memory");
        BIO_set_data(bio, inner_.get());
        BIO_set_init(bio, 1);
        SSL_set_bio(ssl_.get(), bio, bio);
        SSL_set_accept_state(ssl_.get());
    }
    ~TlsStream() override = default;

    const std::string& peer() const override { return inner_->peer(); }
    bool established() const override { return SSL_is_init_finished(ssl_.get()) == 1; }
    std::optional<StreamFault> fault() const override { return fault_; }

    void when_readable(std::function<void()> ready) override {
        if ((fault_ && !fault_told_) || SSL_pending(ssl_.get()) > 0)
            soon_.call(std::move(ready));
        else if (read_wants_write_)
            inner_->when_writable(std::move(ready));
        else
            inner_->when_readable(std::move(ready));
    }
    void when_writable(std::function<void()> ready) override { inner_->when_writable(std::move(ready)); }

    Moved read(std::span<uint8_t> into) override;
    Moved write(std::span<const uint8_t> bytes) override;
    void finish(ErrorCode why) override;
    void close() override {
        soon_.forget();
        inner_->close();
    }

private:
    Moved drain_broken(std::span<uint8_t> into);

    std::unique_ptr<Transport> inner_;
    std::unique_ptr<SSL, decltype(&SSL_free)> ssl_;
    Soon soon_;
    std::optional<StreamFault> fault_;
    bool fault_told_ = false;
    bool read_wants_write_ = false;
    bool close_notify_waits_ = false;
    size_t record_begun_ =
        0;  // bytes of a record that is encrypted but not all taken; the next write goes on with it
};

// After a fault nothing is readable; what arrives is dropped, so that closing does not reset our last words away.
Transport::Moved TlsStream::drain_broken(std::span<uint8_t> into) {
    fault_told_ = true;
    return {0, inner_->read(into).closed};
}

Transport::Moved TlsStream::read(std::span<uint8_t> into) {
    if (fault_) return drain_broken(into);
    ERR_clear_error();
    size_t bytes = 0;
    const int done = SSL_read_ex(ssl_.get(), into.data(), into.size(), &bytes);
    read_wants_write_ = false;
    if (done == 1) return {bytes, false};
    switch (SSL_get_error(ssl_.get(), done)) {
        case SSL_ERROR_WANT_READ: return {};
        case SSL_ERROR_WANT_WRITE: read_wants_write_ = true; return {};
        case SSL_ERROR_SSL: {
            const unsigned long code = ERR_peek_error();
            ERR_clear_error();
            if (ERR_GET_REASON(code) == SSL_R_UNEXPECTED_EOF_WHILE_READING) return {0, true};
            fault_ = StreamFault{fault_of(code, established()), requirement::encryption};
            return {};
        }
        default: return {0, true};
    }
}

Transport::Moved TlsStream::write(std::span<const uint8_t> bytes) {
    if (bytes.empty()) return {};
    if (fault_ || !established()) return {0, true};
    TROCHOID_ASSERT(bytes.size() >= record_begun_, "{} bytes are written again, but {} were begun",
                    bytes.size(), record_begun_);
    ERR_clear_error();
    size_t taken = 0;
    const size_t now = record_begun_ > 0 ? record_begun_ : bytes.size();
    const int done = SSL_write_ex(ssl_.get(), bytes.data(), now, &taken);
    if (done == 1) {
        record_begun_ = 0;
        return {taken, false};
    }
    if (SSL_get_error(ssl_.get(), done) != SSL_ERROR_WANT_WRITE) {
        ERR_clear_error();
        return {0, true};
    }
    record_begun_ = now;
    return {};
}

void TlsStream::finish(ErrorCode why) {
    ERR_clear_error();
    if (!fault_ && established() && record_begun_ == 0) {
        const int sent = SSL_shutdown(ssl_.get());
        if (sent < 0 && SSL_get_error(ssl_.get(), sent) == SSL_ERROR_WANT_WRITE && !close_notify_waits_) {
            close_notify_waits_ =
                true;  // once more when the socket takes it; then the stream ends either way
            inner_->when_writable([this, why] { finish(why); });
            return;
        }
        ERR_clear_error();
    }
    inner_->finish(why);
}

}  // namespace

std::unique_ptr<TlsTransport> make_tls_transport(IoLoop& loop, const TlsIdentity& identity,
                                                 std::unique_ptr<Transport> inner) {
    return std::make_unique<TlsStream>(loop, identity, std::move(inner));
}

}  // namespace trochoid
