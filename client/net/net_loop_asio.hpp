#pragma once
#include <boost/asio/executor_work_guard.hpp>
#include <boost/asio/io_context.hpp>
#include <thread>

#include "client/net/net_loop.hpp"

namespace trochoid {

/// The Asio side of the loop, for this folder's sources only.
struct NetLoop::Impl {
    boost::asio::io_context io{1};
    boost::asio::executor_work_guard<boost::asio::io_context::executor_type> work{io.get_executor()};
    std::thread thread;
};

}  // namespace trochoid
