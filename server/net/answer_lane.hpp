#pragma once
#include <cstddef>
#include <deque>
#include <optional>
#include <variant>
#include <vector>

#include "protocol/codec/messages.hpp"

namespace trochoid {

/// A client's `ListBoxes` command.
struct ListRequest {
    uint32_t sequence = 0;
    bool operator==(const ListRequest&) const = default;
};
using Question = std::variant<SampleRequest, RaysRequest, ListRequest, Probe>;

/// Questions whose answers may be large: answered one by one, each when the socket can take it. While it is full the
/// session reads nothing more, so a client that asks faster than it listens waits and costs no memory.
class AnswerLane {
public:
    static constexpr size_t most_questions = 4;

    bool full() const { return questions_.size() >= most_questions; }
    bool idle() const { return questions_.empty() && pieces_.empty(); }
    void ask(Question question) { questions_.push_back(std::move(question)); }

    /// The next piece of the answer in progress, if there is one.
    std::optional<ServerMessage> take_piece() {
        if (pieces_.empty()) return std::nullopt;
        ServerMessage piece = std::move(pieces_.front());
        pieces_.pop_front();
        return piece;
    }
    std::optional<Question> take_question() {
        if (questions_.empty()) return std::nullopt;
        Question question = std::move(questions_.front());
        questions_.pop_front();
        return question;
    }
    void answer(std::deque<ServerMessage> pieces) { pieces_ = std::move(pieces); }
    void clear() {
        questions_.clear();
        pieces_.clear();
    }

private:
    std::deque<Question> questions_;
    std::deque<ServerMessage> pieces_;
};

/// Answers in pieces whose frames stay within 16 KiB, in order, all but the last with last = false.
std::deque<ServerMessage> in_pieces(BoxList list);
std::deque<ServerMessage> in_pieces(RaysReply reply);

}  // namespace trochoid
