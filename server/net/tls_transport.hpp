#pragma once
#include <memory>

#include "server/net/io_loop.hpp"
#include "server/net/tls_identity.hpp"
#include "server/net/transport.hpp"

namespace trochoid {

/// TLS 1.3, server side, over another stream. Reading does the handshake on the way. An idle one owns no record buffers;
/// one whose peer has sent half a record, or takes nothing, owns one of 16 KiB each way.
class TlsTransport : public Transport {
public:
    /// The handshake is done: what is read and written is encrypted.
    virtual bool established() const = 0;
};

std::unique_ptr<TlsTransport> make_tls_transport(IoLoop& loop, const TlsIdentity& identity,
                                                 std::unique_ptr<Transport> inner);

}  // namespace trochoid
