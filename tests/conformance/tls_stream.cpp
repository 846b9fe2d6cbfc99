#include "tests/conformance/tls_stream.hpp"

#include <fmt/format.h>
#include <openssl/err.h>
#include <openssl/pem.h>
#include <openssl/ssl.h>
#include <openssl/x509v3.h>

#include <array>
#include <utility>

#include "protocol/units/operator_error.hpp"
#include "protocol/wire/frame.hpp"
#include "tests/conformance/framed_stream.hpp"

namespace trochoid::conformance {

namespace {

/// The first thing that OpenSSL complains of, and forgets the rest.
std::string complaint() {
    const unsigned long code = ERR_get_error();
    ERR_clear_error();
    const char* reason = code == 0 ? nullptr : ERR_reason_error_string(code);
    return reason == nullptr ? "no reason given" : reason;
}

struct Freed {
    void operator()(SSL_CTX* context) const { SSL_CTX_free(context); }
    void operator()(SSL* ssl) const { SSL_free(ssl); }
    void operator()(BIO* bio) const { BIO_free(bio); }
    void operator()(X509* certificate) const { X509_free(certificate); }
    void operator()(EVP_PKEY* key) const { EVP_PKEY_free(key); }
};

std::unique_ptr<SSL_CTX, Freed> context_for(const TlsOffer& offer) {
    std::unique_ptr<SSL_CTX, Freed> context(SSL_CTX_new(TLS_client_method()));
    if (!context) throw Failed{"TLS: " + complaint()};
    // Old versions are offered only to see them refused: nothing of ours stands in their way.
    if (offer.at_most_1_2) {
        SSL_CTX_set_security_level(context.get(), 0);
        SSL_CTX_set_max_proto_version(context.get(), TLS1_2_VERSION);
    }
    const bool trusts = offer.ca_file.empty() ? SSL_CTX_set_default_verify_paths(context.get()) == 1
                                              : SSL_CTX_load_verify_locations(
                                                    context.get(), offer.ca_file.c_str(), nullptr) == 1;
    if (!trusts)
        throw OperatorError(fmt::format("cannot read certificates from {}: {}: check --ca",
                                        offer.ca_file.empty() ? "the system" : offer.ca_file, complaint()));
    SSL_CTX_set_verify(context.get(), SSL_VERIFY_PEER, nullptr);
    return context;
}

class OverBytes final : public TlsStream {
public:
    OverBytes(std::unique_ptr<Stream> inner, SSL_CTX* context)
        : inner_(std::move(inner)), ssl_(SSL_new(context)) {
        in_ = BIO_new(BIO_s_mem());
        out_ = BIO_new(BIO_s_mem());
        SSL_set_bio(ssl_.get(), in_, out_);  // theirs to free
    }

    void connect(const TlsOffer& offer, Milliseconds within) {
        SSL_set_connect_state(ssl_.get());
        name(offer);
        shake_hands(Deadline(within));
    }

    void accept(Milliseconds within, TlsHello* hello) {
        const Deadline deadline(within);
        SSL_set_accept_state(ssl_.get());
        Bytes first;
        while (first.size() < tls_record_header_bytes ||
               first.size() < tls_record_header_bytes + tls_record_bytes(first)) {
            const size_t count = inner_->read(chunk_, deadline.left());
            if (count == 0)
                throw Failed{fmt::format("R-106: {} of the ClientHello's bytes came", first.size())};
            first.insert(first.end(), chunk_.begin(), chunk_.begin() + static_cast<std::ptrdiff_t>(count));
            // What is no TLS has no length to wait for.
            if (first.front() != tls_handshake_record) break;
        }
        const TlsHello said = judge_tls_hello(first);
        if (hello != nullptr) *hello = said;
        BIO_write(in_, first.data(), static_cast<int>(first.size()));
        shake_hands(deadline);
    }

    bool write(std::span<const uint8_t> bytes) override {
        if (state_ != State::open) return false;
        size_t count = 0;
        if (!bytes.empty() && SSL_write_ex(ssl_.get(), bytes.data(), bytes.size(), &count) != 1) return false;
        return flush();
    }

    size_t read(std::span<uint8_t> into, Milliseconds within) override {
        const Deadline deadline(within);
        while (state_ == State::open) {
            size_t count = 0;
            ERR_clear_error();
            const int done = SSL_read_ex(ssl_.get(), into.data(), into.size(), &count);
            flush();
            if (done == 1) return count;
            const int why = SSL_get_error(ssl_.get(), done);
            if (why == SSL_ERROR_ZERO_RETURN)
                state_ = State::ended;
            else if (why != SSL_ERROR_WANT_READ)
                state_ = State::reset;
            else if (!pump(deadline.left()))
                return 0;
        }
        return 0;
    }

    State state() const override { return state_; }
    void finish() override {
        SSL_shutdown(ssl_.get());
        flush();
        inner_->finish();
    }
    void abort() override {
        inner_->abort();
        state_ = State::reset;
    }
    std::string wrong_end() const override {
        return state_ == State::reset && inner_->state() == State::ended &&
                       SSL_is_init_finished(ssl_.get()) == 1
                   ? "R-106: the stream just stops, without close_notify"
                   : "";
    }
    TlsAgreement agreement() const override {
        TlsAgreement agreed;
        agreed.version = SSL_get_version(ssl_.get());
        const unsigned char* protocol = nullptr;
        unsigned length = 0;
        SSL_get0_alpn_selected(ssl_.get(), &protocol, &length);
        agreed.protocol.assign(reinterpret_cast<const char*>(protocol), length);
        if (const SSL_SESSION* session = SSL_get0_session(ssl_.get()))
            agreed.early_bytes = SSL_SESSION_get_max_early_data(session);
        return agreed;
    }

private:
    void name(const TlsOffer& offer) {
        X509_VERIFY_PARAM* expected = SSL_get0_param(ssl_.get());
        // An address is no name: it is not told the server, and looked for elsewhere in the certificate.
        if (X509_VERIFY_PARAM_set1_ip_asc(expected, offer.host.c_str()) != 1) {
            X509_VERIFY_PARAM_set1_host(expected, offer.host.c_str(), 0);
            SSL_ctrl(ssl_.get(), SSL_CTRL_SET_TLSEXT_HOSTNAME, TLSEXT_NAMETYPE_host_name,
                     const_cast<char*>(offer.host.c_str()));
        }
        ERR_clear_error();
        std::vector<uint8_t> list;
        for (const std::string& protocol : offer.protocols) {
            list.push_back(static_cast<uint8_t>(protocol.size()));
            list.insert(list.end(), protocol.begin(), protocol.end());
        }
        if (!list.empty()) SSL_set_alpn_protos(ssl_.get(), list.data(), static_cast<unsigned>(list.size()));
    }

    void shake_hands(const Deadline& deadline) {
        while (true) {
            ERR_clear_error();
            const int done = SSL_do_handshake(ssl_.get());
            flush();
            if (done == 1) return;
            if (SSL_get_error(ssl_.get(), done) != SSL_ERROR_WANT_READ) {
                const long trust = SSL_get_verify_result(ssl_.get());
                throw Failed{
                    fmt::format("{}: {}", TlsGate::no_handshake,
                                trust == X509_V_OK ? complaint() : X509_verify_cert_error_string(trust))};
            }
            if (!pump(deadline.left()))
                throw Failed{fmt::format(
                    "{}: {}", TlsGate::no_handshake,
                    inner_->state() == State::open ? "no answer in time" : "the connection ended")};
        }
    }

    /// Brings in what has come. False where nothing came in time or the stream below has ended.
    bool pump(Milliseconds within) {
        const size_t count = inner_->read(chunk_, within);
        if (count > 0) return BIO_write(in_, chunk_.data(), static_cast<int>(count)) > 0;
        if (inner_->state() != State::open) state_ = State::reset;
        return false;
    }

    /// Sends what waits.
    bool flush() {
        bool taken = true;
        while (true) {
            std::array<uint8_t, 16'384> records;
            const int count = BIO_read(out_, records.data(), static_cast<int>(records.size()));
            if (count <= 0) return taken;
            taken = inner_->write(std::span(records).first(static_cast<size_t>(count))) && taken;
        }
    }

    std::unique_ptr<Stream> inner_;
    std::unique_ptr<SSL, Freed> ssl_;
    BIO* in_ = nullptr;
    BIO* out_ = nullptr;
    std::vector<uint8_t> chunk_ = std::vector<uint8_t>(32'768);
    State state_ = State::open;
};

/// "trochoid" or "http/1.1", whichever the client names first.
int choose_protocol(SSL*, const unsigned char** chosen, unsigned char* length, const unsigned char* offered,
                    unsigned offered_bytes, void*) {
    for (unsigned at = 0; at < offered_bytes; at += offered[at] + 1U) {
        const std::string_view name(reinterpret_cast<const char*>(offered) + at + 1, offered[at]);
        if (name != "trochoid" && name != "http/1.1") continue;
        *chosen = offered + at + 1;
        *length = offered[at];
        return SSL_TLSEXT_ERR_OK;
    }
    return SSL_TLSEXT_ERR_NOACK;
}

using Memory = std::unique_ptr<BIO, Freed>;
Memory memory_of(const std::string& text) {
    return Memory(BIO_new_mem_buf(text.data(), static_cast<int>(text.size())));
}

/// As those who serve do.
bool take_identity(SSL_CTX* context, const CertifiedKey& identity) {
    const std::unique_ptr<X509, Freed> certificate(
        PEM_read_bio_X509(memory_of(identity.certificate).get(), nullptr, nullptr, nullptr));
    const std::unique_ptr<EVP_PKEY, Freed> key(
        PEM_read_bio_PrivateKey(memory_of(identity.key).get(), nullptr, nullptr, nullptr));
    return certificate && key && SSL_CTX_use_certificate(context, certificate.get()) == 1 &&
           SSL_CTX_use_PrivateKey(context, key.get()) == 1;
}

}  // namespace

std::unique_ptr<TlsStream> begin_tls(std::unique_ptr<Stream> inner, const TlsOffer& offer,
                                     Milliseconds within) {
    auto stream = std::make_unique<OverBytes>(std::move(inner), context_for(offer).get());
    stream->connect(offer, within);
    return stream;
}

struct TlsGate::Impl {
    std::unique_ptr<SSL_CTX, Freed> context{SSL_CTX_new(TLS_server_method())};
};

TlsGate::TlsGate(const TlsAnswer& answer) : impl_(std::make_unique<Impl>()) {
    SSL_CTX* const context = impl_->context.get();
    if (answer.at_most_1_2) {
        SSL_CTX_set_security_level(context, 0);
        SSL_CTX_set_max_proto_version(context, TLS1_2_VERSION);
    }
    if (!answer.names_no_protocol) SSL_CTX_set_alpn_select_cb(context, choose_protocol, nullptr);
    // Whoever would use it shows that at its return.
    constexpr uint32_t early_bytes = 16'384;
    SSL_CTX_set_max_early_data(context, early_bytes);
    constexpr std::array<unsigned char, 8> name{'t', 'r', 'o', 'c', 'h', 'o', 'i', 'd'};
    SSL_CTX_set_session_id_context(context, name.data(), name.size());
    const bool fits = answer.groups.empty() || SSL_CTX_set1_groups_list(context, answer.groups.c_str()) == 1;
    if (!fits || !take_identity(context, answer.identity))
        throw OperatorError("OpenSSL cannot serve TLS as the kit needs it: " + complaint());
}

TlsGate::~TlsGate() = default;

std::unique_ptr<TlsStream> TlsGate::accept(std::unique_ptr<Stream> inner, Milliseconds within,
                                           TlsHello* hello) const {
    auto stream = std::make_unique<OverBytes>(std::move(inner), impl_->context.get());
    stream->accept(within, hello);
    return stream;
}

}  // namespace trochoid::conformance
