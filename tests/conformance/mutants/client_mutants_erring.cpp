#include "protocol/units/error_code.hpp"
#include "protocol/wire/requirements.hpp"
#include "server_generated.h"
#include "tests/conformance/framed_stream.hpp"
#include "tests/conformance/mutants/client_mutants.hpp"

namespace trochoid::conformance::mutants {

void refuse_server(Link& link, ErrorCode code, uint16_t requirement) {
    Goodbye goodbye;
    goodbye.code = code;
    goodbye.requirement = requirement;
    goodbye.message = "a client that errs does not take this";
    link.say_to_server(goodbye);
    link.end_server();
    link.end_client();
}

namespace {

namespace fb = wire_fb;

// ---- acknowledgements ----

MakeSpoiler with_acks(Fate (*change)(Ack& ack, Link& link)) {
    return spoils_client<Ack>(
        [change] { return [change](Ack& ack, const Talk&, Link& link) { return change(ack, link); }; });
}

Fate another_hash(Ack& ack, Link&) {
    ack.state_hash ^= 1;
    return Fate::changed;
}
Fate another_answer(Ack& ack, Link&) {
    if (!ack.known_answer) return Fate::kept;
    *ack.known_answer ^= 1;
    return Fate::changed;
}
Fate back_again(Ack& ack, Link& link) {
    if (ack.result < 2) return Fate::kept;
    link.say_to_server(ack);
    link.say_to_server(Ack{ack.result - 1, ack.state_hash, 0, {}});
    return Fate::dropped;
}
Fate no_more(Ack& ack, Link&) {
    constexpr uint32_t last = 60;
    return ack.result > last ? Fate::dropped : Fate::kept;
}

/// The known answer comes with the second acknowledgement.
MakeSpoiler answers_late() {
    return spoils_client<Ack>([] {
        return [answer = std::optional<uint64_t>()](Ack& ack, const Talk&, Link&) mutable {
            std::swap(answer, ack.known_answer);
            return Fate::changed;
        };
    });
}

/// Acknowledges what is not whole, where the rest keeps it waiting.
class Hasty final : public MessageSpoiler {
    Fate server_says(ServerMessage& message, Link&) override {
        if (const auto* piece = std::get_if<Delta>(&message)) {
            unfinished_ = piece->last ? 0 : piece->result;
            since_us_ = monotonic_us();
        }
        return Fate::kept;
    }
    Fate client_says(ClientMessage& message, Link& link) override {
        constexpr int64_t patience_us = 220'000;
        const bool asks = std::holds_alternative<ClockRequest>(message);
        if (asks && unfinished_ != 0 && monotonic_us() - since_us_ > patience_us) {
            link.say_to_server(Ack{unfinished_, 0, 0, {}});
            unfinished_ = 0;
        }
        return Fate::kept;
    }

    uint32_t unfinished_ = 0;
    int64_t since_us_ = 0;
};

/// Out of step it acknowledges what builds on what it does not hold as if it had it.
class Pretending final : public MessageSpoiler {
    Fate server_says(ServerMessage& message, Link& link) override {
        const auto* piece = std::get_if<Delta>(&message);
        if (piece == nullptr) return Fate::kept;
        if (piece->base == 0) lost_ = false;
        if (!piece->last) return Fate::kept;
        told_[piece->result] = piece->state_hash;
        if (lost_) link.say_to_server(Ack{piece->result, piece->state_hash, 0, {}});
        return Fate::kept;
    }
    Fate client_says(ClientMessage& message, Link&) override {
        const auto* ack = std::get_if<Ack>(&message);
        if (ack == nullptr) return Fate::kept;
        const auto told = told_.find(ack->result);
        lost_ = lost_ || (told != told_.end() && told->second != ack->state_hash);
        return Fate::kept;
    }

    std::map<uint32_t, uint64_t> told_;
    bool lost_ = false;
};

void add_acks(std::vector<Mutant>& all) {
    const auto add = [&](const char* name, uint16_t number, const char* what, MakeSpoiler make) {
        all.push_back({name, number, Side::client, what, std::move(make)});
    };
    add("client-other-hash", requirement::acknowledged_state,
        "A client whose acknowledgements have another hash", with_acks(another_hash));
    add("client-pretends", requirement::acknowledged_state,
        "A client that acknowledges what it cannot have applied",
        [] { return std::make_unique<Pretending>(); });
    add("client-hasty", requirement::whole_results,
        "A client that acknowledges a result of which pieces lack", [] { return std::make_unique<Hasty>(); });
    add("client-acks-back", requirement::ascending_sequence, "A client whose acknowledgements go back",
        with_acks(back_again));
    add("client-stops", requirement::progress, "A client that acknowledges 60 results and no more",
        with_acks(no_more));
    add("client-other-sea", 205, "A client that computes another sea", with_acks(another_answer));
    add("client-answers-late", 205, "A client whose known answer comes with its second acknowledgement",
        answers_late());
}

// ---- the clock ----

/// Its clock runs three times as fast; what comes back is translated.
class FastClock final : public MessageSpoiler {
    Fate client_says(ClientMessage& message, Link&) override {
        auto* request = std::get_if<ClockRequest>(&message);
        if (request == nullptr) return Fate::kept;
        constexpr int64_t times = 3;
        const int64_t true_us = request->client_sent_us;
        if (true_of_.empty()) first_us_ = true_us;
        request->client_sent_us = first_us_ + times * (true_us - first_us_);
        true_of_[request->client_sent_us] = true_us;
        return Fate::changed;
    }
    Fate server_says(ServerMessage& message, Link&) override {
        auto* reply = std::get_if<ClockReply>(&message);
        const auto found = reply == nullptr ? true_of_.end() : true_of_.find(reply->client_sent_us);
        if (found == true_of_.end()) return Fate::kept;
        reply->client_sent_us = found->second;
        return Fate::changed;
    }

    std::map<int64_t, int64_t> true_of_;  // by what was said
    int64_t first_us_ = 0;
};

/// After these many requests something becomes of them.
MakeSpoiler later_requests(int after, Fate (*change)(ClockRequest& request)) {
    return spoils_client<ClockRequest>([after, change] {
        return [after, change, count = 0](ClockRequest& request, const Talk&, Link&) mutable {
            return ++count > after ? change(request) : Fate::kept;
        };
    });
}

void add_clocks(std::vector<Mutant>& all) {
    all.push_back({"client-same-sequence", requirement::ascending_sequence, Side::client,
                   "A client whose requests have one number", later_requests(2, [](ClockRequest& request) {
                       request.sequence = 1;
                       return Fate::changed;
                   })});
    all.push_back({"client-fast-clock", 142, Side::client, "A client whose clock runs three times as fast",
                   [] { return std::make_unique<FastClock>(); }});
    all.push_back({"client-no-rhythm", 142, Side::client,
                   "A client that asks for the clock 8 times and no more (SHOULD)",
                   later_requests(8, [](ClockRequest&) { return Fate::dropped; })});
}

// ---- what it does not understand ----

/// The body's vtable has places that this version does not know.
bool has_new_field(const Bytes& payload) {
    const auto* envelope = fb::GetServerEnvelope(payload.data());
    const auto* table = static_cast<const uint8_t*>(envelope->body());
    const uint8_t* vtable = table - flatbuffers::ReadScalar<flatbuffers::soffset_t>(table);
    constexpr flatbuffers::voffset_t more_than_any = 90;  // bytes
    return flatbuffers::ReadScalar<flatbuffers::voffset_t>(vtable) > more_than_any;
}

class RefusesNewFields final : public Spoiler {
    void from_server(Bytes payload, Link& link) override {
        if (decode_server(payload) && has_new_field(payload))
            return refuse_server(link, ErrorCode::verification_failed, requirement::verified_buffer);
        link.to_client(payload);
    }
};

bool is_new(ErrorCode code) {
    constexpr unsigned known_in_each_class = 50;
    return static_cast<unsigned>(code) % 100 > known_in_each_class;
}

template <class Message>
MakeSpoiler refuses(bool (*wrong)(const Message& message)) {
    return spoils_server<Message>([wrong] {
        return [wrong](Message& message, const Talk& talk, Link& link) {
            const bool hello = std::is_same_v<Message, ServerHello>;
            if ((!hello && !talk.server_hello) || !wrong(message)) return Fate::kept;
            refuse_server(link, ErrorCode::value_out_of_range, requirement::ranges);
            return Fate::dropped;
        };
    });
}

void add_readings(std::vector<Mutant>& all) {
    const auto add = [&](const char* name, uint16_t number, const char* what, MakeSpoiler make) {
        all.push_back({name, number, Side::client, what, std::move(make)});
    };
    add("client-cannot-list", 119, "A client that cannot read lists of boxes",
        refuses<BoxList>([](const BoxList& list) { return !list.boxes.empty(); }));
    add("client-refuses-fields", 171, "A client that refuses messages with new fields",
        [] { return std::make_unique<RefusesNewFields>(); });
    add("client-refuses-codes", 175, "A client that refuses a goodbye with an unknown code of a known class",
        refuses<Goodbye>([](const Goodbye& goodbye) { return is_new(goodbye.code); }));
    add("client-refuses-last-code", 175, "A client that refuses a hello with an unknown code",
        refuses<ServerHello>([](const ServerHello& hello) { return is_new(hello.last_code); }));
    add("client-tells-no-difference", 165, "A client that keeps a difference to itself (SHOULD)",
        spoils_client<Desync>([] { return [](Desync&, const Talk&, Link&) { return Fate::dropped; }; }));
    add("client-tells-another-part", 165,
        "A client that names another part than the first that differs (SHOULD)", spoils_client<Desync>([] {
            return [](Desync& desync, const Talk&, Link&) {
                ++desync.part;
                return Fate::changed;
            };
        }));
}

}  // namespace

void add_erring_clients(std::vector<Mutant>& all) {
    add_acks(all);
    add_clocks(all);
    add_readings(all);
}

}  // namespace trochoid::conformance::mutants
