#include "tests/determinism/fault.hpp"

#include <bit>
#include <cstdlib>
#include <utility>

#include "protocol/codec/codec.hpp"
#include "protocol/units/assert.hpp"
#include "server/app/land_change.hpp"

namespace trochoid {

namespace {

void spoil_record(WaveTrainBox& box) {
    if (box.id.value != 1 || box.trains.size() < 2 || !fault_in("world")) return;
    box.trains[1].amplitude = one_ulp_off(box.trains[1].amplitude);
}

void spoil_land(TracedLand& land) {
    if (land.fields.empty() || land.fields[0]->id().value != 1 || !fault_in("land")) return;
    auto field = std::make_shared<LandField>(*land.fields[0]);
    const auto blocks = field->blocks();
    auto block = std::make_shared<LandBlock>(*blocks[blocks.size() / 2]);
    uint16_t& gain = block->gain[block_nodes * 8 + 8];
    gain = static_cast<uint16_t>(gain ^ 1U);
    field->set(std::move(block));
    land.fields[0] = std::move(field);
}

}  // namespace

bool fault_in([[maybe_unused]] std::string_view stage) {
#ifdef TROCHOID_FAULT_INJECTION
    // NOLINTNEXTLINE(concurrency-mt-unsafe): nothing writes the environment.
    const char* wanted = std::getenv("TROCHOID_FAULT");
    return wanted != nullptr && stage == wanted;
#else
    return false;
#endif
}

float one_ulp_off(float v) { return std::bit_cast<float>(std::bit_cast<uint32_t>(v) + 1U); }

void replay_spoiled(World& world, std::span<const StoredEvent> events, const LandSettings& settings) {
    for (const StoredEvent& stored : events) {
        auto event = decode_event(stored.bytes);
        TROCHOID_ASSERT(event.has_value(), "the log that was just written: {}", event.error().message);
        Derived derived = derive(world.state(), *event, settings);
        if (auto* started = std::get_if<BoxStarted>(&event->what)) {
            spoil_record(started->box);
            for (TracedLand& land : derived.lands) spoil_land(land);
        }
        world.apply(*event, stored.bytes, std::move(derived));
    }
}

Sea spoiled(const Sea& sea) {
    std::vector<std::shared_ptr<const PreparedBox>> boxes(sea.boxes().begin(), sea.boxes().end());
    if (!boxes.empty() && !boxes.back()->constants.empty() && fault_in("constants")) {
        auto box = std::make_shared<PreparedBox>(*boxes.back());
        box->constants.back().a = one_ulp_off(box->constants.back().a);
        boxes.back() = std::move(box);
    }
    return Sea(std::move(boxes));
}

}  // namespace trochoid
