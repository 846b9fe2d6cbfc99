#pragma once
#include <atomic>
#include <boost/asio/io_context.hpp>
#include <boost/asio/signal_set.hpp>
#include <thread>

#include "server/net/io_loop.hpp"

// Only for the sources of this folder that hold sockets: everybody else sees io_loop.hpp.
namespace trochoid {

struct IoLoop::Impl {
    boost::asio::io_context context{1};
    boost::asio::signal_set signals{context};
    boost::asio::signal_set hangups{context};
    std::atomic<std::thread::id> owner{};
};

}  // namespace trochoid
