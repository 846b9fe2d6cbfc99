#include "client/app/session_board.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace trochoid {

double speed_with(std::deque<SessionBoard::Mark>& marks, SessionBoard::Mark now) {
    constexpr int64_t window_us = 3'000'000;
    constexpr int64_t spacing_us = 100'000;
    if (marks.empty() || now.at_us - marks.back().at_us >= spacing_us) marks.push_back(now);
    // The oldest mark kept is the last one outside the window.
    while (marks.size() > 2 && now.at_us - marks[1].at_us >= window_us) marks.pop_front();
    const int64_t elapsed = now.at_us - marks.front().at_us;
    if (elapsed <= 0) return 0.0;
    return static_cast<double>(now.bytes - marks.front().bytes) * 1e6 / static_cast<double>(elapsed);
}

std::string sentence_of(const SessionBoard& board, const Endpoint& server, int64_t now_us) {
    switch (board.state) {
        case LinkState::connecting: return fmt::format("connecting to {}", to_text(server));
        case LinkState::live: return "connected";
        case LinkState::waiting: {
            const int64_t seconds = (std::max<int64_t>(0, board.next_try_us - now_us) + 999'999) / 1'000'000;
            return fmt::format("server gone ({}), trying again in {} s", board.reason, seconds);
        }
        case LinkState::ended: return board.reason;
    }
    return {};
}

}  // namespace trochoid
