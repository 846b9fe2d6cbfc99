#pragma once
#include <memory>
#include <span>

#include "server/net/io_loop.hpp"
#include "server/net/transport.hpp"

namespace trochoid {

/// A stream of which a few bytes have been read to tell its form: gives them back first. `place` lives as long as the
/// stream (what is counted while a connection lasts); may be empty.
std::unique_ptr<Transport> give_back(IoLoop& loop, std::unique_ptr<Transport> inner,
                                     std::span<const uint8_t> first, std::shared_ptr<void> place);

}  // namespace trochoid
