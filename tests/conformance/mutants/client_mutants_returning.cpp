#include <memory>
#include <mutex>

#include "protocol/wire/requirements.hpp"
#include "tests/conformance/mutants/client_mutants.hpp"

namespace trochoid::conformance::mutants {

namespace {

/// What one program remembers from one of its connections to the next.
struct Memory {
    std::mutex mutex;
    int hellos = 0;
    std::optional<ResumeState> resume;
    std::vector<uint8_t> ticket;
};

/// Changes hellos by what has been so far; sees the server's too.
class Remembering final : public MessageSpoiler {
public:
    using Change = bool (*)(ClientHello& hello, Memory& memory);
    Remembering(std::shared_ptr<Memory> memory, Change change)
        : memory_(std::move(memory)), change_(change) {}

private:
    Fate client_says(ClientMessage& message, Link&) override {
        auto* hello = std::get_if<ClientHello>(&message);
        if (hello == nullptr) return Fate::kept;
        const std::lock_guard lock(memory_->mutex);
        const bool changed = change_(*hello, *memory_);
        ++memory_->hellos;
        return changed ? Fate::changed : Fate::kept;
    }
    Fate server_says(ServerMessage& message, Link&) override {
        const auto* hello = std::get_if<ServerHello>(&message);
        const std::lock_guard lock(memory_->mutex);
        if (hello != nullptr && memory_->ticket.empty()) memory_->ticket = hello->ticket;
        return Fate::kept;
    }

    const std::shared_ptr<Memory> memory_;
    const Change change_;
};

MakeSpoiler remembers(Remembering::Change change) {
    return [memory = std::make_shared<Memory>(), change] {
        return std::make_unique<Remembering>(memory, change);
    };
}

bool keeps_other_instance(ClientHello& hello, Memory& memory) {
    if (hello.resume) memory.resume = hello.resume;
    const bool forgotten = !hello.resume && memory.resume;
    if (forgotten) hello.resume = memory.resume;
    return forgotten;
}
bool shows_first_ticket(ClientHello& hello, Memory& memory) {
    if (hello.ticket.empty() || memory.ticket.empty()) return false;
    hello.ticket = memory.ticket;
    return true;
}
bool alters_ticket(ClientHello& hello, Memory&) {
    if (hello.ticket.empty()) return false;
    hello.ticket.front() ^= 1U;
    return true;
}
bool claims_other_state(ClientHello& hello, Memory&) {
    if (hello.resume) hello.resume->state_hash ^= 1U;
    return hello.resume.has_value();
}
bool claims_at_first(ClientHello& hello, Memory& memory) {
    if (memory.hellos > 0) return false;
    hello.resume = ResumeState{};
    hello.resume->key.anchor = hello.view;
    hello.resume->state_hash = 1;
    return true;
}
bool has_no_past(ClientHello& hello, Memory&) {
    if (hello.last_code == ErrorCode::none) return false;
    hello.last_code = ErrorCode::none;
    return true;
}

/// Offers what it holds, and has lost it when the server goes on with it.
bool forgets(ServerHello& hello, const Talk& talk) {
    if (!hello.resumed || !talk.client_hello->resume) return false;
    hello.resumed = false;
    return true;
}

}  // namespace

void add_returning_clients(std::vector<Mutant>& all) {
    const auto add = [&](const char* name, uint16_t number, const char* what, MakeSpoiler make) {
        all.push_back({name, number, Side::client, what, std::move(make)});
    };
    add("client-impatient", requirement::hello_first,
        "A client that does not heed when, or whether, to come again", spoils_server<Goodbye>([] {
            return [](Goodbye& goodbye, const Talk&, Link&) {
                goodbye.retry = true;
                goodbye.retry_after_ms = 0;
                return Fate::changed;
            };
        }));
    add("client-other-instance", 129, "A client that offers what it held of another world instance",
        remembers(keeps_other_instance));
    add("client-old-ticket", 155, "A client that shows a ticket twice", remembers(shows_first_ticket));
    add("client-altered-ticket", 155, "A client that alters its ticket", remembers(alters_ticket));
    add("client-other-claim", 157, "A client that claims another state than it holds",
        remembers(claims_other_state));
    add("client-first-claim", 157, "A client that goes on with what never was", remembers(claims_at_first));
    add("client-forgets", 158, "A client that does not go on with what it has offered",
        spoils_server<ServerHello>([] {
            return [](ServerHello& hello, const Talk& talk, Link&) {
                return forgets(hello, talk) ? Fate::changed : Fate::kept;
            };
        }));
    add("client-no-past", 159, "A client that does not tell how its last session ended",
        remembers(has_no_past));
}

}  // namespace trochoid::conformance::mutants
