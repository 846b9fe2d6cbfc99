#include "client/net/blocking_link.hpp"

#include <fmt/format.h>

#include <condition_variable>
#include <deque>
#include <mutex>
#include <optional>
#include <utility>

#include "protocol/codec/codec.hpp"
#include "protocol/units/version.hpp"

namespace trochoid {

ViewState view_of_nothing() {
    constexpr float half_turn = 0.70710678F;  // sine and cosine of an eighth of a turn: looks straight up
    ViewState view;
    view.altitude = 1000 * static_cast<int32_t>(lattice_per_metre);
    view.qx = half_turn;
    view.qw = half_turn;
    view.tan_half_width = view.tan_half_height = 0.1F;
    view.viewport_width = view.viewport_height = 16;
    view.accepted_error_px = 100.0F;
    view.patch_budget = 1;
    return view;
}

struct BlockingLink::Impl {
    struct End {
        Goodbye goodbye;
        CloseCause cause = CloseCause::lost;
    };

    LinkOptions options;
    uint32_t sequence = 0;
    ServerHello hello;
    mutable std::mutex mutex;
    std::condition_variable news;
    std::deque<ServerMessage> inbox;  // answers only: what the server tells of the sea passes by
    std::optional<End> end;
    NetLoop loop;
    std::shared_ptr<Connection> connection;

    Impl() = default;
    Impl(const Impl&) = delete;
    Impl& operator=(const Impl&) = delete;
    ~Impl() { loop.stop(); }

    void take(ServerMessage message) {
        if (std::holds_alternative<Delta>(message) || std::holds_alternative<TerrainTiles>(message)) return;
        const std::lock_guard lock(mutex);
        inbox.push_back(std::move(message));
        news.notify_all();
    }
    void close(const Goodbye& goodbye, CloseCause cause) {
        const std::lock_guard lock(mutex);
        end = End{goodbye, cause};
        news.notify_all();
    }
    void post(ClientMessage message) {
        loop.post([this, message = std::move(message)] { connection->send(message); });
    }
    [[noreturn]] void fail() const {
        const bool unreachable = hello.session == 0 && end->cause == CloseCause::lost;
        if (end->cause == CloseCause::server_goodbye)
            throw LinkError(
                fmt::format("the server at {} says: {}", to_text(options.server), end->goodbye.message),
                end->goodbye.code, false);
        throw LinkError(end->goodbye.message, end->goodbye.code, unreachable);
    }

    /// Waits for a message that `wanted` takes (returns true); others are dropped.
    template <class Wanted>
    void await(const char* what, Wanted wanted) {
        std::unique_lock lock(mutex);
        const auto until = std::chrono::steady_clock::now() + options.patience;
        while (true) {
            while (!inbox.empty()) {
                ServerMessage message = std::move(inbox.front());
                inbox.pop_front();
                if (wanted(message)) return;
            }
            if (end) fail();
            if (news.wait_until(lock, until) == std::cv_status::timeout && inbox.empty() && !end)
                throw LinkError(
                    fmt::format("the server at {} gave no {} within {} s: try again, or look at its log",
                                to_text(options.server), what, options.patience.count() / 1000),
                    ErrorCode::none, false);
        }
    }
};

BlockingLink::BlockingLink(LinkOptions options) : impl_(std::make_unique<Impl>()) {
    if (!options.token.empty()) require_secrecy(options.server);
    Impl& my = *impl_;
    my.options = std::move(options);
    my.connection =
        Connection::open(my.loop, my.options.server,
                         {[] {}, [&my](ServerMessage message, int64_t) { my.take(std::move(message)); },
                          [&my](const Goodbye& goodbye, CloseCause cause) { my.close(goodbye, cause); }});
    ClientHello hello;
    hello.protocol_min = protocol_version_min;
    hello.protocol_max = protocol_version_max;
    hello.model = model_version;
    hello.schema_hash = schema_hash();
    hello.software = my.options.software;
    hello.token = my.options.token;
    hello.view = view_of_nothing();
    hello.clock_stamp_us = client_monotonic_us();
    my.post(hello);
    my.await("hello", [&my](ServerMessage& message) {
        auto* answer = std::get_if<ServerHello>(&message);
        if (answer) my.hello = std::move(*answer);
        return answer != nullptr;
    });
}

BlockingLink::~BlockingLink() {
    Impl& my = *impl_;
    my.loop.post([&my] {
        Goodbye goodbye;
        goodbye.message = "done";
        my.connection->close(goodbye);
    });
    std::unique_lock lock(my.mutex);
    my.news.wait_for(lock, std::chrono::seconds(2), [&my] { return my.end.has_value(); });
}

const ServerHello& BlockingLink::hello() const { return impl_->hello; }

CommandReply BlockingLink::command(Command command) {
    Impl& my = *impl_;
    command.sequence = ++my.sequence;
    my.post(command);
    CommandReply reply;
    my.await("answer to the command", [&](ServerMessage& message) {
        const auto* answer = std::get_if<CommandReply>(&message);
        if (answer == nullptr || answer->sequence != my.sequence) return false;
        reply = *answer;
        return true;
    });
    return reply;
}

BoxList BlockingLink::list() {
    Impl& my = *impl_;
    Command command;
    command.sequence = ++my.sequence;
    command.action = ListBoxes{};
    my.post(command);
    BoxList list;
    my.await("list of boxes", [&](ServerMessage& message) {
        if (const auto* refused = std::get_if<CommandReply>(&message);
            refused && refused->sequence == my.sequence)
            throw LinkError(refused->message, refused->code, false);
        auto* piece = std::get_if<BoxList>(&message);
        if (piece == nullptr || piece->sequence != my.sequence) return false;
        list.now = piece->now;
        list.sequence = piece->sequence;
        list.boxes.insert(list.boxes.end(), piece->boxes.begin(), piece->boxes.end());
        return piece->last;
    });
    return list;
}

ClockReply BlockingLink::clock() {
    Impl& my = *impl_;
    ClockRequest request;
    request.sequence = ++my.sequence;
    request.client_sent_us = client_monotonic_us();
    my.post(request);
    ClockReply reply;
    my.await("clock", [&](ServerMessage& message) {
        const auto* answer = std::get_if<ClockReply>(&message);
        if (answer == nullptr || answer->sequence != my.sequence) return false;
        reply = *answer;
        return true;
    });
    return reply;
}

}  // namespace trochoid
