#pragma once
#include <filesystem>
#include <memory>
#include <string>

struct ssl_ctx_st;

namespace trochoid {

/// What the server shows to whoever wants TLS: its certificate chain and key, TLS 1.3 only, no tickets, no early data.
class TlsIdentity {
public:
    /// PEM files: the chain (the server's own certificate first) and the key, without a passphrase. Throws OperatorError for
    /// files that are missing, hold something else or do not belong together.
    TlsIdentity(std::filesystem::path certificate, std::filesystem::path key);
    TlsIdentity(const TlsIdentity&) = delete;
    TlsIdentity& operator=(const TlsIdentity&) = delete;

    /// Reads both files again; connections from then on see what is new. Throws like the constructor, and the old pair stays.
    void reload();
    /// For the log: whom the certificate names and until when it holds.
    std::string text() const;
    /// What an operator should know: it has expired, does not hold yet or ends within a fortnight. Empty: nothing.
    std::string warning() const;

    ssl_ctx_st* context() const { return context_.get(); }

private:
    std::shared_ptr<ssl_ctx_st> load() const;

    std::filesystem::path certificate_;
    std::filesystem::path key_;
    std::shared_ptr<ssl_ctx_st> context_;
};

}  // namespace trochoid
