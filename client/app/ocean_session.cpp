#include "client/app/ocean_session.hpp"

#include <fmt/format.h>

#include <utility>

#include "client/app/session_board.hpp"
#include "client/app/session_link.hpp"

namespace trochoid {

struct OceanSession::Impl {
    explicit Impl(SessionOptions o) : options(std::move(o)) {
        board.view = options.view;
        board.regions = options.regions;
        loop.post([this] { link.connect(); });
    }
    Impl(const Impl&) = delete;
    Impl& operator=(const Impl&) = delete;
    // The link's tasks refer to it: the thread ends first.
    ~Impl() { loop.stop(); }

    const SessionOptions options;
    SessionBoard board;
    NetLoop loop;
    SessionLink link{loop, board, options};
};

namespace {

/// A question whose whole answer is one message of type Reply; a CommandReply in its place is a refusal.
template <class Reply>
SessionLink::Question question_for(AnswerTo<Reply> answer) {
    SessionLink::Question question;
    question.take = [answer](ServerMessage& message) {
        auto* reply = std::get_if<Reply>(&message);
        const auto* refusal = std::get_if<CommandReply>(&message);
        if (reply != nullptr)
            answer(std::move(*reply));
        else if (refusal != nullptr)
            answer(Error{refusal->code, refusal->message});
        else
            answer(Error{ErrorCode::unexpected_message,
                         "the server gave another kind of answer than was asked for"});
        return true;
    };
    question.fail = [answer](const Error& error) { answer(error); };
    return question;
}

/// A question whose answer comes in pieces until one says that it is the last.
template <class Reply, class Entries>
SessionLink::Question question_in_pieces(AnswerTo<Reply> answer, Entries Reply::*entries) {
    SessionLink::Question question = question_for<Reply>(answer);
    auto whole = std::make_shared<Reply>();
    question.take = [whole, entries, answer, otherwise = question.take](ServerMessage& message) {
        auto* piece = std::get_if<Reply>(&message);
        if (piece == nullptr) return otherwise(message);
        Entries gathered = std::move((*whole).*entries);
        gathered.insert(gathered.end(), ((*piece).*entries).begin(), ((*piece).*entries).end());
        *whole = std::move(*piece);
        (*whole).*entries = std::move(gathered);
        if (whole->last) answer(std::move(*whole));
        return whole->last;
    };
    return question;
}

}  // namespace

OceanSession::OceanSession(SessionOptions options) {
    if (options.fresh_token) require_secrecy(options.server);
    impl_ = std::make_unique<Impl>(std::move(options));
}

OceanSession::~OceanSession() {
    Impl& my = *impl_;
    my.loop.post([&my] { my.link.end(); });
    std::unique_lock lock(my.board.mutex);
    my.board.news.wait_for(lock, std::chrono::milliseconds(1500),
                           [&my] { return my.board.state == LinkState::ended; });
}

std::shared_ptr<const StoreSnapshot> OceanSession::snapshot() const {
    const std::lock_guard lock(impl_->board.mutex);
    return impl_->board.snapshot;
}

std::shared_ptr<const ServerHello> OceanSession::hello() const {
    const std::lock_guard lock(impl_->board.mutex);
    return impl_->board.hello;
}

SeaTime OceanSession::sea_time_now() {
    const std::lock_guard lock(impl_->board.mutex);
    return impl_->board.clock.known() ? impl_->board.clock.sea_time(client_monotonic_us()) : SeaTime{};
}

SessionStatistics OceanSession::statistics() {
    SessionBoard& board = impl_->board;
    const std::lock_guard lock(board.mutex);
    const int64_t now_us = client_monotonic_us();
    const Traffic traffic = impl_->link.traffic();
    SessionStatistics s;
    s.state = board.state;
    s.sentence = sentence_of(board, impl_->options.server, now_us);
    if (board.hello) s.server_version = board.hello->software;
    s.bytes_received = traffic.bytes_received;
    s.bytes_sent = traffic.bytes_sent;
    s.bytes_per_second = speed_with(board.marks, {now_us, traffic.bytes_received});
    if (board.clock.known()) {
        s.clock_error_us = board.clock.error_bound_us(now_us);
        s.round_trip_us = board.clock.round_trip_us();
    }
    s.fidelity = board.fidelity;
    s.store = board.counters;
    s.log_position = board.snapshot->log_position.value;
    s.error_in_force_px = board.snapshot->key.error_in_force_px;
    s.connections = board.connections;
    s.views_sent = board.views_sent;
    return s;
}

void OceanSession::set_view(const ViewState& view) {
    Impl& my = *impl_;
    {
        const std::lock_guard lock(my.board.mutex);
        if (my.board.view == view) return;
        my.board.view = view;
        if (std::exchange(my.board.view_posted, true)) return;
    }
    my.loop.post([&my] { my.link.view_changed(); });
}

void OceanSession::set_regions(std::vector<SyncRegion> regions) {
    Impl& my = *impl_;
    {
        const std::lock_guard lock(my.board.mutex);
        if (my.board.regions == regions) return;
        my.board.regions = std::move(regions);
    }
    my.loop.post([&my] { my.link.regions_changed(); });
}

void OceanSession::rays(BoxId box, AnswerTo<RaysReply> answer) {
    impl_->loop.post([this, box, answer = std::move(answer)] {
        impl_->link.ask(
            [box](uint32_t sequence) {
                return RaysRequest{sequence, box};
            },
            question_in_pieces<RaysReply>(answer, &RaysReply::rays));
    });
}

void OceanSession::sample(SeaTime time, std::vector<LatticePoint> points, AnswerTo<SampleReply> answer) {
    impl_->loop.post([this, time, points = std::move(points), answer = std::move(answer)] {
        impl_->link.ask(
            [&](uint32_t sequence) {
                return SampleRequest{sequence, time, points};
            },
            question_for<SampleReply>(answer));
    });
}

void OceanSession::command(Command command, AnswerTo<CommandReply> answer) {
    impl_->loop.post([this, command = std::move(command), answer = std::move(answer)] {
        impl_->link.ask(
            [&](uint32_t sequence) {
                Command numbered = command;
                numbered.sequence = sequence;
                return numbered;
            },
            question_for<CommandReply>(answer));
    });
}

void OceanSession::list(AnswerTo<BoxList> answer) {
    impl_->loop.post([this, answer = std::move(answer)] {
        impl_->link.ask(
            [](uint32_t sequence) {
                Command command;
                command.sequence = sequence;
                command.action = ListBoxes{};
                return command;
            },
            question_in_pieces<BoxList>(answer, &BoxList::boxes));
    });
}

bool OceanSession::wait_until(const std::function<bool()>& holds, std::chrono::milliseconds patience) {
    SessionBoard& board = impl_->board;
    const auto deadline = std::chrono::steady_clock::now() + patience;
    while (true) {
        uint64_t seen = 0;
        {
            const std::lock_guard lock(board.mutex);
            seen = board.changes;
        }
        if (holds()) return true;
        std::unique_lock lock(board.mutex);
        if (!board.news.wait_until(lock, deadline, [&] { return board.changes != seen; })) return false;
    }
}

}  // namespace trochoid
