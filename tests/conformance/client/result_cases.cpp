#include <fmt/format.h>

#include "tests/conformance/client/refusals.hpp"
#include "tests/conformance/kit_sea.hpp"

// results, their order, their bases, and acknowledgements.
namespace trochoid::conformance::client {

namespace {

constexpr size_t small_pieces = 1500;

constexpr Due out_of_order{ErrorCode::sequence_not_monotone, requirement::result_order};

/// Far more than the small sea: many pieces.
InterestState wide_sea() {
    InterestState state = grown_sea();
    constexpr int32_t row = 400;
    for (int32_t x = 0; x < row; ++x) {
        PatchDescriptor patch;
        patch.key = {15, 100 + x, 40};
        patch.boxes = {{{1}, 3}, {{2}, 1}};
        state.patches[patch.key] = patch;
    }
    return state;
}

/// A session in which result 1 is acknowledged.
ClientPeer& in_step(ClientTrial& trial) {
    ClientPeer& peer = trial.welcome();
    peer.expect_service();
    return peer;
}

void add_right(Catalogue& all) {
    all.push_back(client_case("R-133/snapshot", "A snapshot is acknowledged with its hash",
                              [](ClientTrial& trial) { in_step(trial); }));
    all.push_back(
        client_case("R-134/pieces", "A snapshot and a result in pieces, each acknowledged once it is whole",
                    [](ClientTrial& trial) {
                        ClientPeer& peer = trial.welcome();
                        const size_t pieces = peer.pieces_to(small_sea(), true, small_pieces).size();
                        peer.send_result(small_sea(), true, small_pieces);
                        peer.await_ack(1);
                        trial.note(fmt::format("{} and {} pieces", pieces,
                                               peer.pieces_to(grown_sea(), false, small_pieces).size()));
                        peer.send_result(grown_sea(), false, small_pieces);
                        peer.await_ack(2);
                    }));
    all.push_back(client_case("R-134/there-and-back",
                              "Twenty results that change boxes, blocks and patches there and back",
                              [](ClientTrial& trial) {
                                  ClientPeer& peer = in_step(trial);
                                  for (int i = 0; i < 20; ++i) {
                                      peer.send_result(i % 2 == 0 ? grown_sea() : small_sea());
                                      peer.await_ack(peer.result());
                                  }
                              }));
    all.push_back(
        client_case("R-134/snapshot-again", "A snapshot drops all that was held", [](ClientTrial& trial) {
            ClientPeer& peer = in_step(trial);
            peer.send_result(grown_sea());
            peer.send_result(small_sea(), true);
            peer.await_ack(3);
            peer.send_result({}, true);
            peer.await_ack(4);
        }));
    all.push_back(client_case("R-134/nothing-changes", "A result that changes nothing but its key",
                              [](ClientTrial& trial) {
                                  ClientPeer& peer = in_step(trial);
                                  peer.send_result(peer.state());
                                  peer.await_ack(2);
                              }));
    all.push_back(
        client_case("R-134/all-goes", "A result that takes everything away", [](ClientTrial& trial) {
            ClientPeer& peer = in_step(trial);
            peer.send_result({});
            peer.await_ack(2);
        }));
    all.push_back(
        client_case("R-133/at-once",
                    "Ten results without waiting for acknowledgements: those that come are right and ascend",
                    [](ClientTrial& trial) {
                        ClientPeer& peer = in_step(trial);
                        for (int i = 0; i < 10; ++i) peer.send_result(i % 2 == 0 ? grown_sea() : small_sea());
                        peer.await_ack(11);
                    }));
    all.push_back(client_case("R-135/not-whole", "A result whose last piece is missing is not acknowledged",
                              [](ClientTrial& trial) {
                                  ClientPeer& peer = trial.welcome();
                                  const std::vector<Delta> pieces =
                                      peer.pieces_to(small_sea(), true, small_pieces);
                                  for (size_t i = 0; i + 1 < pieces.size(); ++i) peer.send(pieces[i]);
                                  constexpr Milliseconds span{500};
                                  peer.listen(span);
                                  if (!peer.acks().empty()) throw Failed{"R-135: it was acknowledged"};
                                  peer.send(pieces.back());
                                  peer.hold(1, small_sea());
                                  peer.await_ack(1);
                              }));
}

void add_progress(Catalogue& all) {
    all.push_back(client_case("R-128/progress", "Seventy results one after the other are all acknowledged",
                              [](ClientTrial& trial) {
                                  ClientPeer& peer = in_step(trial);
                                  constexpr int results = 70;
                                  for (int i = 0; i < results; ++i) {
                                      peer.send_result(i % 2 == 0 ? grown_sea() : small_sea());
                                      peer.await_ack(peer.result());
                                  }
                              }));
}

/// One thing wrong with the pieces of result 2.
void add_order(Catalogue& all, const char* id, const char* title, void (*spoil)(std::vector<Delta>& pieces)) {
    all.push_back(client_case(std::string("R-134/") + id, title, [spoil](ClientTrial& trial) {
        ClientPeer& peer = in_step(trial);
        std::vector<Delta> pieces = peer.pieces_to(wide_sea(), false, small_pieces);
        if (pieces.size() < 4) throw Failed{"the kit's own result has too few pieces"};
        spoil(pieces);
        for (const Delta& piece : pieces) peer.send(piece);
        peer.hold(2, wide_sea());
        peer.expect_goodbye(out_of_order);
    }));
}

void add_wrong_order(Catalogue& all) {
    using Pieces = std::vector<Delta>;
    add_order(all, "result-skipped", "Result 3 follows result 1", [](Pieces& pieces) {
        for (Delta& piece : pieces) piece.result = 3;
    });
    add_order(all, "result-again", "Result 1 comes again", [](Pieces& pieces) {
        for (Delta& piece : pieces) piece.result = 1, piece.base = 0;
    });
    add_order(all, "result-far", "Result 2³² - 1 follows result 1", [](Pieces& pieces) {
        for (Delta& piece : pieces) piece.result = UINT32_MAX;
    });
    add_order(all, "piece-skipped", "Piece 2 follows piece 0",
              [](Pieces& pieces) { pieces.erase(pieces.begin() + 1); });
    add_order(all, "piece-again", "A piece comes twice",
              [](Pieces& pieces) { pieces.insert(pieces.begin() + 1, Delta(pieces[0])); });
    add_order(all, "piece-1-first", "A result begins with piece 1",
              [](Pieces& pieces) { pieces.erase(pieces.begin()); });
    add_order(all, "pieces-exchanged", "Two pieces change places",
              [](Pieces& pieces) { std::swap(pieces[1], pieces[2]); });
    add_order(all, "begins-in-between", "Another result begins before the last piece", [](Pieces& pieces) {
        Delta next = pieces[0];
        next.result = 3;
        pieces.insert(pieces.begin() + 1, next);
    });
    add_order(all, "bases-differ", "The pieces of a result name different bases",
              [](Pieces& pieces) { pieces[1].base = 0; });
    add_order(all, "piece-after-last", "A piece follows the last", [](Pieces& pieces) {
        pieces.back().last = true;
        Delta more = pieces.back();
        ++more.piece;
        pieces.push_back(more);
    });
    all.push_back(client_case("R-134/first-is-2", "The first result is number 2", [](ClientTrial& trial) {
        ClientPeer& peer = trial.welcome();
        peer.hold(1, {});
        peer.send_result(small_sea(), true);
        peer.expect_goodbye(out_of_order);
    }));
}

/// Result 2 is out of step in some way: the client says so with its acknowledgement, takes nothing more until a snapshot, and that one.
void add_lost(Catalogue& all, const char* id, const char* title, void (*spoil)(Delta& piece)) {
    all.push_back(client_case(std::string("R-133/") + id, title, [spoil](ClientTrial& trial) {
        ClientPeer& peer = in_step(trial);
        Delta wrong;
        for (Delta piece : peer.pieces_to(grown_sea(), false)) {
            spoil(piece);
            peer.send(piece);
            wrong = piece;
        }
        peer.hold(2, grown_sea());
        const Ack ack = peer.await<Ack>("acknowledgement of a result out of step",
                                        [](const Ack& it) { return it.result == 2; });
        trial.note(fmt::format("acknowledged with {:016x}", ack.state_hash));
        if (ack.state_hash == wrong.state_hash)
            throw Failed{"R-133: the acknowledgement says that all is well"};
        // Whoever does not hold result 2 cannot build on it.
        peer.send_result(laden_sea());
        constexpr Milliseconds span{200};
        peer.listen(span);
        for (const Ack& it : peer.acks())
            if (it.result == 3 && it.state_hash == hash_of(laden_sea()))
                throw Failed{"R-133: a result on a base that is not held was applied"};
        peer.send_result(grown_sea(), true);
        peer.await_ack(4);
        peer.send_result(small_sea());
        peer.await_ack(5);
    }));
}

}  // namespace

void add_result_cases(Catalogue& all) {
    add_right(all);
    add_progress(all);
    add_wrong_order(all);
    all.push_back(client_case(
        "R-133/acknowledged-wrong-hash",
        "A result's hash is not that of its records: the client says so and waits for a snapshot",
        [](ClientTrial& trial) {
            ClientPeer& peer = in_step(trial);
            for (Delta piece : peer.pieces_to(grown_sea(), false)) {
                piece.state_hash ^= 1;
                peer.send(piece);
            }
            peer.hold(2, grown_sea());
            const Ack ack = peer.await<Ack>("acknowledgement", [](const Ack& it) { return it.result == 2; });
            if (ack.state_hash == (hash_of(grown_sea()) ^ 1))
                throw Failed{"R-133: the client acknowledges a hash that is not its state's"};
            peer.send_result(small_sea(), true);
            peer.await_ack(3);
        }));
    add_lost(all, "wrong-base-hash", "A result builds on another state than the client holds",
             [](Delta& piece) { piece.base_hash ^= 1; });
    add_lost(all, "wrong-state-hash", "After a hash that differs nothing is taken until a snapshot",
             [](Delta& piece) {
                 if (piece.last) piece.state_hash = ~piece.state_hash;
             });
    all.push_back(client_case(
        "R-133/first-wrong-hash", "The first snapshot's hash differs: another snapshot is taken",
        [](ClientTrial& trial) {
            ClientPeer& peer = trial.welcome();
            for (Delta piece : peer.pieces_to(small_sea(), true)) {
                piece.state_hash ^= 1;
                peer.send(piece);
            }
            peer.hold(1, small_sea());
            const Ack ack = peer.await<Ack>("acknowledgement", [](const Ack& it) { return it.result == 1; });
            if (ack.state_hash == (hash_of(small_sea()) ^ 1))
                throw Failed{"R-133: the client acknowledges a hash that is not its state's"};
            peer.expect_service();
        }));
    all.push_back(client_case(
        "R-133/never-in-step",
        "Forty results with wrong hashes: the client may leave (base_mismatch) or ask on",
        [](ClientTrial& trial) {
            ClientPeer& peer = trial.welcome();
            for (uint32_t i = 1; i <= 40 && peer.stream().state() == Stream::State::open && !peer.goodbye();
                 ++i) {
                for (Delta piece : peer.pieces_to(small_sea(), true)) {
                    piece.state_hash ^= 1;
                    peer.send(piece);
                }
                peer.hold(i, small_sea());
                constexpr Milliseconds span{5};
                peer.listen(span);
            }
            if (peer.goodbye())
                peer.expect_goodbye({ErrorCode::base_mismatch, any_due_requirement});
            else
                peer.expect_goodbye_or_service({{ErrorCode::base_mismatch, any_due_requirement}});
        }));
}

}  // namespace trochoid::conformance::client
