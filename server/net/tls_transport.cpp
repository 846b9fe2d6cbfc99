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

// One read of ours takes no more than this many of the stream below (a record takes two): whatever a peer sends, in whatever
// pieces, a read comes back soon, and others get their turn.
constexpr int reads_at_once = 8;

// OpenSSL's view of a Transport, so that it needs no buffers of its own for what goes in and out.
struct Below {
    std::unique_ptr<Transport> transport;
    int reads_left = 0;
};

int read_bio(BIO* bio, char* into, int bytes) {
    BIO_clear_retry_flags(bio);
    auto* const below = static_cast<Below*>(BIO_get_data(bio));
    if (below->reads_left <= 0) {
        BIO_set_retry_read(bio);
        return -1;
    }
    --below->reads_left;
    const auto moved = below->transport->read({reinterpret_cast<uint8_t*>(into), static_cast<size_t>(bytes)});
    if (moved.closed) return 0;
    if (moved.bytes == 0) {
        BIO_set_retry_read(bio);
        return -1;
    }
    return static_cast<int>(moved.bytes);
}

int write_bio(BIO* bio, const char* from, int bytes) {
    BIO_clear_retry_flags(bio);
    auto* const below = static_cast<Below*>(BIO_get_data(bio));
    const auto moved =
        below->transport->write({reinterpret_cast<const uint8_t*>(from), static_cast<size_t>(bytes)});
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
        : below_{std::move(inner)}, ssl_(SSL_new(identity.context()), SSL_free), soon_(loop) {
        BIO* const bio = BIO_new(transport_method());
        TROCHOID_ASSERT(ssl_ && bio != nullptr, "OpenSSL is out of memory");
        BIO_set_data(bio, &below_);
        BIO_set_init(bio, 1);
        SSL_set_bio(ssl_.get(), bio, bio);
        SSL_set_accept_state(ssl_.get());
    }
    ~TlsStream() override = default;

    const std::string& peer() const override { return below_.transport->peer(); }
    bool established() const override { return established_; }
    std::optional<StreamFault> fault() const override { return fault_; }

    void when_readable(std::function<void()> ready) override {
        if ((fault_ && !fault_told_) || SSL_pending(ssl_.get()) > 0) {
            soon_.call(std::move(ready));
        } else if (read_wants_write_) {
            below_.transport->when_writable(std::move(ready));
        } else {
            reader_ = std::move(ready);
            wait_below();
        }
    }
    void when_writable(std::function<void()> ready) override {
        if (write_wants_read_) {
            writer_ = std::move(ready);
            wait_below();
        } else {
            below_.transport->when_writable(std::move(ready));
        }
    }

    Moved read(std::span<uint8_t> into) override;
    Moved write(std::span<const uint8_t> bytes) override;
    void finish(ErrorCode why) override;
    void close() override {
        soon_.forget();
        reader_ = writer_ = nullptr;
        alive_.reset();
        below_.transport->close();
    }

private:
    Moved drain_broken(std::span<uint8_t> into);
    void wait_below();

    Below below_;
    std::unique_ptr<SSL, decltype(&SSL_free)> ssl_;
    Soon soon_;
    std::shared_ptr<const bool> alive_ = std::make_shared<const bool>(true);
    std::function<void()> reader_;  // both wait for bytes from below
    std::function<void()> writer_;
    bool waiting_below_ = false;
    bool established_ = false;  // once and for all: OpenSSL says no again while the peer changes its key
    std::optional<StreamFault> fault_;
    bool fault_told_ = false;
    bool read_wants_write_ = false;
    bool write_wants_read_ = false;
    bool close_notify_waits_ = false;
    size_t record_begun_ =
        0;  // bytes of a record that is encrypted but not all taken; the next write goes on with it
};

void TlsStream::wait_below() {
    if (std::exchange(waiting_below_, true)) return;
    below_.transport->when_readable([this, alive = std::weak_ptr<const bool>(alive_)] {
        if (alive.expired()) return;  // a call that was under way already cannot be taken back
        waiting_below_ = false;
        const auto reader = std::exchange(reader_, nullptr);
        if (const auto writer = std::exchange(writer_, nullptr)) soon_.call(writer);
        if (reader) reader();
    });
}

// After a fault nothing is readable; what arrives is dropped, so that closing does not reset our last words away.
Transport::Moved TlsStream::drain_broken(std::span<uint8_t> into) {
    fault_told_ = true;
    return {0, below_.transport->read(into).closed};
}

Transport::Moved TlsStream::read(std::span<uint8_t> into) {
    if (fault_) return drain_broken(into);
    ERR_clear_error();
    size_t bytes = 0;
    below_.reads_left = reads_at_once;
    const int done = SSL_read_ex(ssl_.get(), into.data(), into.size(), &bytes);
    established_ = established_ || SSL_is_init_finished(ssl_.get()) == 1;
    read_wants_write_ = write_wants_read_ = false;
    if (done == 1) return {bytes, false};
    switch (SSL_get_error(ssl_.get(), done)) {
        case SSL_ERROR_WANT_READ: return {};
        case SSL_ERROR_WANT_WRITE: read_wants_write_ = true; return {};
        case SSL_ERROR_SSL: {
            const unsigned long code = ERR_peek_error();
            ERR_clear_error();
            if (ERR_GET_REASON(code) == SSL_R_UNEXPECTED_EOF_WHILE_READING) return {0, true};
            fault_ = StreamFault{fault_of(code, established_), requirement::encryption};
            return {};
        }
        default: return {0, true};
    }
}

Transport::Moved TlsStream::write(std::span<const uint8_t> bytes) {
    if (bytes.empty()) return {};
    if (fault_ || !established_) return {0, true};
    TROCHOID_ASSERT(bytes.size() >= record_begun_, "{} bytes are written again, but {} were begun",
                    bytes.size(), record_begun_);
    ERR_clear_error();
    size_t taken = 0;
    const size_t now = record_begun_ > 0 ? record_begun_ : bytes.size();
    below_.reads_left = reads_at_once;
    write_wants_read_ = false;
    const int done = SSL_write_ex(ssl_.get(), bytes.data(), now, &taken);
    if (done == 1) {
        record_begun_ = 0;
        return {taken, false};
    }
    switch (SSL_get_error(ssl_.get(), done)) {
        case SSL_ERROR_WANT_WRITE: record_begun_ = now; return {};
        // The peer is in the middle of changing its key: what is to be written waits for the rest of that.
        case SSL_ERROR_WANT_READ: write_wants_read_ = true; return {};
        default: ERR_clear_error(); return {0, true};
    }
}

void TlsStream::finish(ErrorCode why) {
    ERR_clear_error();
    if (!fault_ && established_ && record_begun_ == 0) {
        const int sent = SSL_shutdown(ssl_.get());
        if (sent < 0 && SSL_get_error(ssl_.get(), sent) == SSL_ERROR_WANT_WRITE && !close_notify_waits_) {
            close_notify_waits_ =
                true;  // once more when the socket takes it; then the stream ends either way
            below_.transport->when_writable([this, why, alive = std::weak_ptr<const bool>(alive_)] {
                if (!alive.expired()) finish(why);
            });
            return;
        }
        ERR_clear_error();
    }
    below_.transport->finish(why);
}

}  // namespace

std::unique_ptr<TlsTransport> make_tls_transport(IoLoop& loop, const TlsIdentity& identity,
                                                 std::unique_ptr<Transport> inner) {
    return std::make_unique<TlsStream>(loop, identity, std::move(inner));
}

}  // namespace trochoid
