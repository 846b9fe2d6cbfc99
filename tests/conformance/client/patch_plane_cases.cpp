#include <fmt/format.h>

#include <algorithm>
#include <limits>

#include "protocol/codec/patch_coding.hpp"
#include "tests/conformance/client/refusals.hpp"
#include "tests/conformance/kit_sea.hpp"

// Patches as planes, from version 3 on (chapter 8): read like those in lists, and refused where they are not their one form.
namespace trochoid::conformance::client {

namespace {

constexpr size_t small_pieces = 1500;
constexpr float nan = std::numeric_limits<float>::quiet_NaN();

ClientPeer& welcome_in_version_3(ClientTrial& trial) {
    ClientPeer& peer = trial.welcome();
    need_version(peer, first_with_patch_planes);
    return peer;
}

/// The next result, its patches as planes. Those of a piece come in their keys' order already: the change is that of two maps.
void send_as_planes(ClientPeer& peer, const InterestState& state, bool snapshot) {
    for (Delta& piece : peer.pieces_to(state, snapshot, small_pieces)) {
        piece.patch_form = PatchForm::planes;
        peer.send(piece);
    }
    peer.hold(peer.result() + 1, state);
}

void add_right(Catalogue& all) {
    all.push_back(client_case("R-134/planes-snapshot",
                              "A snapshot whose patches are planes is acknowledged with its hash",
                              [](ClientTrial& trial) {
                                  ClientPeer& peer = welcome_in_version_3(trial);
                                  send_as_planes(peer, small_sea(), true);
                                  peer.await_ack(1);
                              }));
    all.push_back(client_case("R-134/planes-and-lists",
                              "Results whose patches are planes and lists by turns: both say the same",
                              [](ClientTrial& trial) {
                                  ClientPeer& peer = welcome_in_version_3(trial);
                                  peer.expect_service();
                                  for (int i = 0; i < 12; ++i) {
                                      const InterestState sea = i % 4 < 2 ? grown_sea() : small_sea();
                                      if (i % 3 == 0)
                                          peer.send_result(sea);
                                      else
                                          send_as_planes(peer, sea, i % 5 == 4);
                                      peer.await_ack(peer.result());
                                  }
                              }));
}

struct Row {
    const char* name;
    const char* title;
    Due due;
    void (*spoil)(Delta& delta);
};

void add_wrong_values(Catalogue& all) {
    using D = Delta;
    const Row rows[] = {
        {"order", "patches not by ascending key", out_of_range,
         [](D& d) { std::swap(d.change.patches[2], d.change.patches[3]); }},
        {"twice", "a patch twice", out_of_range,
         [](D& d) { d.change.patches[3].key = d.change.patches[2].key; }},
        {"removed-order", "removed patches not by ascending key", out_of_range,
         [](D& d) { std::swap(d.change.removed_patches[0], d.change.removed_patches[1]); }},
        {"level", "a patch of level 14", out_of_range, [](D& d) { d.change.patches[0].key.level = 14; }},
        {"removed-level", "a removed patch of level 27", out_of_range,
         [](D& d) { d.change.removed_patches[1].level = 27; }},
        {"z", "a patch beyond the world", out_of_range,
         [](D& d) {
             d.change.patches.back().key = {26, 0, 512};
         }},
        {"bound-nan", "a bound that is not a number", infinite_or_nan,
         [](D& d) { d.change.patches[1].left_out = nan; }},
        {"bound-infinite", "an infinite bound", infinite_or_nan,
         [](D& d) { d.change.patches[1].height_error = std::numeric_limits<float>::infinity(); }},
        {"bound-negative", "a negative bound", out_of_range,
         [](D& d) { d.change.patches[1].left_out = -1.0F; }},
        {"bound-minus-0", "a bound of -0", out_of_range, [](D& d) { d.change.patches[1].left_out = -0.0F; }},
        {"trains", "257 trains of a box", out_of_range,
         [](D& d) { d.change.patches[0].boxes[0].train_count = 257; }},
        {"many", "1,025 patches", out_of_range, [](D& d) {
             d.change.patches.clear();
             for (int32_t x = 0; x <= 1024; ++x) d.change.patches.push_back({{16, x, 0}, {}, 0.0F, 0.0F});
         }}};
    for (const Row& row : rows) {
        Delta delta = legal_delta();
        delta.patch_form = PatchForm::planes;
        delta.change.removed_patches = {{18, 5, -6}, {18, 5, -5}};
        row.spoil(delta);
        all.push_back(refused(fmt::format("R-{}/Delta-planes-{}", row.due.requirement, row.name),
                              fmt::format("A result with planes: {}", row.title),
                              encode(ServerMessage{delta}), row.due, first_with_patch_planes));
    }
}

/// A result of this alone.
Bytes delta_of(const std::vector<uint32_t>& box_ids, const Bytes& planes, bool also_lists) {
    flatbuffers::FlatBufferBuilder b;
    b.ForceDefaults(true);
    const wire_fb::View anchor(0, 0, 0, 0, 0, 0, 1, 1, 1, 0, 0, 0, 1, 1, 1, 1);
    const auto regions = b.CreateVectorOfStructs(std::vector<wire_fb::Region>{});
    const auto key = wire_fb::CreateCullKey(b, &anchor, 0, 0, 1, 1, regions);
    const auto ids = b.CreateVector(box_ids);
    const auto names = b.CreateVectorOfStructs(std::vector<wire_fb::PatchName>{{1, 1, 16}});
    const auto planes_at = b.CreateVector(planes);
    const auto delta = wire_fb::CreateDelta(b, 1, 0, true, 0, 0, 0, key, 0, 0, 0, 0, 0, 0, ids, 0, 0,
                                            also_lists ? names : 0, planes_at);
    wire_fb::FinishServerEnvelopeBuffer(
        b, wire_fb::CreateServerEnvelope(b, 1, wire_fb::ServerBody::Delta, delta.Union()));
    wire_fb::GetMutableServerEnvelope(b.GetBufferPointer())->mutate_size(b.GetSize());
    return {b.GetBufferPointer(), b.GetBufferPointer() + b.GetSize()};
}

void add_wrong_bytes(Catalogue& all) {
    InterestDelta change;
    for (int32_t z = 0; z < 20; ++z)
        change.patches.push_back({{16, 0, z}, {{{3}, 1}, {{5}, 2}}, 0.125F, 0.25F});
    const Bytes good = code_patches(change, boxes_named(change.patches));
    const auto add = [&](const char* name, const char* title, const std::vector<uint32_t>& ids,
                         const Bytes& planes, bool also_lists = false) {
        all.push_back(refused(fmt::format("R-117/Delta-planes-{}", name),
                              fmt::format("A result with planes: {}", title),
                              delta_of(ids, planes, also_lists), out_of_range, first_with_patch_planes));
    };
    Bytes longer = good;
    longer.push_back(0);
    // 20 patches, 0 of them removed: the count 20 in two bytes.
    Bytes padded = good;
    padded.insert(padded.begin() + 1, 0x00);
    padded[0] |= 0x80U;
    add("empty", "none, though the field is there", {}, {});
    add("nothing", "of no patch", {}, {0, 1});
    add("cut", "that end early", {3, 5}, {good.begin(), good.end() - 1});
    add("longer", "with a byte too many", {3, 5}, longer);
    add("padded", "with a varint that is not the shortest", {3, 5}, padded);
    add("varints", "of varints that never end", {3, 5}, Bytes(64, 0xff));
    // Of 2^30 patches, as 5 bytes say.
    add("huge", "that promise a billion patches", {}, {0x80, 0x80, 0x80, 0x80, 0x08, 0x00, 0x00});
    add("ids-order", "whose box_ids do not ascend", {5, 3}, good);
    add("ids-fewer", "of more boxes than there are ids", {3}, good);
    add("ids-more", "of fewer boxes than there are ids", {3, 5, 7}, good);
    add("and-lists", "beside a list of removed patches", {3, 5}, good, true);
}

}  // namespace

void add_patch_plane_cases(Catalogue& all) {
    add_right(all);
    add_wrong_values(all);
    add_wrong_bytes(all);
}

}  // namespace trochoid::conformance::client
