#include "client/net/tls_trust.hpp"

#include <fmt/format.h>
#include <openssl/err.h>
#include <openssl/ssl.h>
#include <openssl/x509v3.h>

#include <boost/asio/ip/address.hpp>
#include <memory>
#include <string_view>
#include <vector>

#include "client/net/stranger.hpp"
#include "client/net/tcp_dial.hpp"
#include "protocol/units/operator_error.hpp"

namespace trochoid {

namespace ssl = boost::asio::ssl;
using ErrorOfSystem = boost::system::error_code;

namespace {

bool is_address(const std::string& host) {
    ErrorOfSystem not_one;
    boost::asio::ip::make_address(host, not_one);
    return !not_one;
}

std::string text_of(const ASN1_STRING* text) {
    return {reinterpret_cast<const char*>(ASN1_STRING_get0_data(text)),
            static_cast<size_t>(ASN1_STRING_length(text))};
}

std::string address_of(const ASN1_OCTET_STRING* bytes) {
    const auto* data = ASN1_STRING_get0_data(bytes);
    if (ASN1_STRING_length(bytes) == 4) {
        boost::asio::ip::address_v4::bytes_type v4{};
        std::copy_n(data, v4.size(), v4.begin());
        return boost::asio::ip::make_address_v4(v4).to_string();
    }
    if (ASN1_STRING_length(bytes) != 16) return {};
    boost::asio::ip::address_v6::bytes_type v6{};
    std::copy_n(data, v6.size(), v6.begin());
    return boost::asio::ip::make_address_v6(v6).to_string();
}

/// "a, b, 10.0.0.1": the hosts that a certificate is made out to; the peer's own words.
std::string names_in(const X509* certificate) {
    const std::unique_ptr<GENERAL_NAMES, decltype(&GENERAL_NAMES_free)> names(
        static_cast<GENERAL_NAMES*>(X509_get_ext_d2i(certificate, NID_subject_alt_name, nullptr, nullptr)),
        &GENERAL_NAMES_free);
    std::string all;
    for (int i = 0; names && i < sk_GENERAL_NAME_num(names.get()); ++i) {
        const GENERAL_NAME* name = sk_GENERAL_NAME_value(names.get(), i);
        std::string one;
        if (name->type == GEN_DNS) one = text_of(name->d.dNSName);
        if (name->type == GEN_IPADD) one = address_of(name->d.iPAddress);
        if (one.empty()) continue;
        if (!all.empty()) all += ", ";
        all += one;
    }
    return printable(all, 120);
}

/// The reason alone, as OpenSSL names it; the library's and function's names in front help nobody.
std::string reason_of(const ErrorOfSystem& error) {
    const char* reason = ERR_reason_error_string(static_cast<unsigned long>(error.value()));
    return reason != nullptr ? reason : error.message();
}

}  // namespace

TlsTrust::TlsTrust(const Endpoint& endpoint) : endpoint_(endpoint), context_(ssl::context::tls_client) {
    ErrorOfSystem failed;
    SSL_CTX_set_min_proto_version(context_.native_handle(), TLS1_3_VERSION);
    if (endpoint_.ca_file.empty())
        context_.set_default_verify_paths(failed);
    else
        context_.load_verify_file(endpoint_.ca_file, failed);
    ERR_clear_error();
    if (failed && endpoint_.ca_file.empty())
        no_trust_ =
            fmt::format("the system's certificates cannot be read ({}): give --ca FILE", reason_of(failed));
    else if (failed)
        no_trust_ = fmt::format("--ca {} holds no certificate that can be read ({}): give a PEM file",
                                endpoint_.ca_file, reason_of(failed));
}

Result<Done> TlsTrust::prepare(Stream& stream, const char* protocol) {
    if (!no_trust_.empty()) return Error{ErrorCode::none, no_trust_};
    SSL* tls = stream.native_handle();
    X509_VERIFY_PARAM* wanted = SSL_get0_param(tls);
    // A trusted certificate need not be a root: a server's own will do.
    if (!endpoint_.ca_file.empty()) X509_VERIFY_PARAM_set_flags(wanted, X509_V_FLAG_PARTIAL_CHAIN);
    X509_VERIFY_PARAM_set_hostflags(wanted, X509_CHECK_FLAG_NO_PARTIAL_WILDCARDS);
    if (is_address(endpoint_.host)) {
        X509_VERIFY_PARAM_set1_ip_asc(wanted, endpoint_.host.c_str());
    } else {
        X509_VERIFY_PARAM_set1_host(wanted, endpoint_.host.c_str(), 0);
        SSL_set_tlsext_host_name(tls, endpoint_.host.c_str());
    }
    const std::string_view name(protocol);
    std::vector<unsigned char> offered{static_cast<unsigned char>(name.size())};
    offered.insert(offered.end(), name.begin(), name.end());
    SSL_set_alpn_protos(tls, offered.data(), static_cast<unsigned>(offered.size()));
    stream.set_verify_mode(ssl::verify_peer);
    stream.set_verify_callback([this](bool fine, ssl::verify_context& chain) { return judge(fine, chain); });
    return Done{};
}

bool TlsTrust::judge(bool fine, ssl::verify_context& chain) {
    if (fine) return true;
    if (verdict_ == X509_V_OK) {
        verdict_ = X509_STORE_CTX_get_error(chain.native_handle());
        if (const X509* own = X509_STORE_CTX_get0_cert(chain.native_handle())) made_out_to_ = names_in(own);
    }
    return false;
}

std::string TlsTrust::untrusted() const {
    const std::string server = to_text(endpoint_);
    switch (verdict_) {
        case X509_V_ERR_HOSTNAME_MISMATCH:
        case X509_V_ERR_IP_ADDRESS_MISMATCH:
            return made_out_to_.empty()
                       ? fmt::format(
                             "the certificate of {} names no host: it has to be made out to {} "
                             "(subjectAltName)",
                             server, endpoint_.host)
                       : fmt::format(
                             "the certificate of {} is made out to {}, not to {}: connect by one of "
                             "those names",
                             server, made_out_to_, endpoint_.host);
        case X509_V_ERR_CERT_HAS_EXPIRED:
            return fmt::format(
                "the certificate of {} has expired: its server needs a new one (or this machine's "
                "clock is wrong)",
                server);
        case X509_V_ERR_CERT_NOT_YET_VALID:
            return fmt::format(
                "the certificate of {} is not valid yet: check this machine's clock, and the server's",
                server);
        case X509_V_ERR_DEPTH_ZERO_SELF_SIGNED_CERT:
        case X509_V_ERR_SELF_SIGNED_CERT_IN_CHAIN:
        case X509_V_ERR_UNABLE_TO_GET_ISSUER_CERT:
        case X509_V_ERR_UNABLE_TO_GET_ISSUER_CERT_LOCALLY:
        case X509_V_ERR_UNABLE_TO_VERIFY_LEAF_SIGNATURE:
            return endpoint_.ca_file.empty()
                       ? fmt::format(
                             "the certificate of {} is not trusted here: give --ca FILE with that "
                             "certificate or its issuer's",
                             server)
                       : fmt::format(
                             "the certificate of {} does not come from {}: give --ca the certificate of "
                             "its issuer",
                             server, endpoint_.ca_file);
        default:
            return fmt::format("the certificate of {} is refused ({}): its server needs another one", server,
                               X509_verify_cert_error_string(verdict_));
    }
}

Error TlsTrust::failure(const ErrorOfSystem& error) const {
    const std::string server = to_text(endpoint_);
    const std::string plain = to_text(with_encryption(endpoint_, false));
    if (verdict_ != X509_V_OK) return {ErrorCode::none, untrusted()};
    if (error.category() != boost::asio::error::get_ssl_category())
        return {ErrorCode::none,
                fmt::format("{} ended the connection in the TLS handshake ({}): if its server has no TLS, "
                            "use --connect {}",
                            server, is_end_of_stream(error) ? "without a word" : error.message(), plain)};
    switch (ERR_GET_REASON(static_cast<unsigned long>(error.value()))) {
        case SSL_R_WRONG_VERSION_NUMBER:
        case SSL_R_UNEXPECTED_MESSAGE:
        case SSL_R_PACKET_LENGTH_TOO_LONG:
        case SSL_R_BAD_RECORD_TYPE:
            return {
                ErrorCode::none,
                fmt::format("what listens at {} speaks no TLS: use --connect {}, or start its server with "
                            "a certificate",
                            server, plain)};
        case SSL_R_SSLV3_ALERT_HANDSHAKE_FAILURE:
            return {ErrorCode::none,
                    fmt::format("{} refuses TLS: if its server has no certificate, use --connect {}", server,
                                plain)};
        case SSL_R_UNSUPPORTED_PROTOCOL:
        case SSL_R_TLSV1_ALERT_PROTOCOL_VERSION:
            return {
                ErrorCode::none,
                fmt::format("the server at {} has no TLS 1.3: it needs a newer TLS library or other settings",
                            server)};
        case SSL_R_TLSV1_ALERT_NO_APPLICATION_PROTOCOL:
            return {ErrorCode::none,
                    fmt::format("the server at {} speaks TLS, but not Trochoid's protocol: check --connect",
                                server)};
        default:
            return {
                ErrorCode::none,
                fmt::format(
                    "the TLS handshake with {} failed ({}): check --connect, and the server's certificate",
                    server, reason_of(error))};
    }
}

Endpoint endpoint_from_options(std::string_view connect, const std::string& ca_file) {
    Endpoint endpoint = parse_endpoint(connect);
    if (ca_file.empty()) return endpoint;
    if (!is_encrypted(endpoint.transport))
        throw OperatorError(
            fmt::format("--ca is of use with TLS only: give --connect {} too, or leave it out",
                        to_text(with_encryption(endpoint, true))));
    endpoint.ca_file = ca_file;
    ssl::context context(ssl::context::tls_client);
    ErrorOfSystem failed;
    context.load_verify_file(ca_file, failed);
    if (failed)
        throw OperatorError(fmt::format("--ca {} holds no certificate that can be read ({}): give a PEM file",
                                        ca_file, reason_of(failed)));
    return endpoint;
}

}  // namespace trochoid
