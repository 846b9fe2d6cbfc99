#include "tests/simulation/virtual_net.hpp"

#include <algorithm>
#include <utility>

#include "protocol/units/hash.hpp"
#include "tests/simulation/virtual_time.hpp"

namespace trochoid {

namespace {

constexpr size_t send_buffer = 16384;
constexpr size_t receive_buffer = 32768;

}  // namespace

VirtualEnd::~VirtualEnd() { close(); }

VirtualEnd::Moved VirtualEnd::read(std::span<uint8_t> into) {
    VirtualWire::Way& way = wire_->towards(side_);
    const size_t count = std::min(into.size(), way.arrived.size());
    std::copy_n(way.arrived.begin(), count, into.begin());
    way.arrived.erase(way.arrived.begin(), way.arrived.begin() + static_cast<std::ptrdiff_t>(count));
    if (count > 0) {
        wire_->pump(1 - side_);
        return {count, false};
    }
    return {0, way.finished || wire_->reset_ || wire_->at(side_).closed};
}

VirtualEnd::Moved VirtualEnd::write(std::span<const uint8_t> bytes) {
    VirtualWire::End& end = wire_->at(side_);
    if (wire_->reset_ || wire_->cut_ == CutKind::finish || end.closed || end.finished) return {0, true};
    const size_t count = std::min(bytes.size(), wire_->room(side_));
    VirtualWire::Way& way = wire_->from(side_);
    way.put += count;
    if (wire_->silent_) return {count, false};
    way.link.put(bytes.first(count), VirtualTime::current().now_us());
    wire_->pump(side_);
    return {count, false};
}

void VirtualEnd::when_readable(std::function<void()> ready) {
    wire_->at(side_).readable = std::move(ready);
    wire_->wake(side_);
}

void VirtualEnd::when_writable(std::function<void()> ready) {
    wire_->at(side_).writable = std::move(ready);
    wire_->wake(side_);
}

void VirtualEnd::finish() {
    VirtualWire::End& end = wire_->at(side_);
    if (end.closed || std::exchange(end.finished, true) || wire_->reset_ || wire_->silent_) return;
    wire_->from(side_).link.end(VirtualTime::current().now_us());
    wire_->pump(side_);
}

void VirtualEnd::close() {
    VirtualWire::End& end = wire_->at(side_);
    if (end.closed) return;
    finish();
    end.closed = true;
    end.readable = end.writable = nullptr;
    // As a socket does that is closed over what it has not read.
    if (!wire_->towards(side_).arrived.empty() && !wire_->silent_) wire_->reset();
}

VirtualWire::VirtualWire(const ConnectionFaults& faults, uint64_t seed)
    : ways_{Way{ChaosLink(faults.up, splitmix64(seed), faults.down.delay_us), {}, false, 0, INT64_MAX},
            Way{ChaosLink(faults.down, splitmix64(seed + 1), faults.up.delay_us), {}, false, 0, INT64_MAX}} {}

size_t VirtualWire::room(int side) {
    const Way& way = from(side);
    const auto unread = static_cast<size_t>(way.put - way.link.delivered());
    return send_buffer - std::min(send_buffer, unread);
}

// Lets arrive at the other side what is due.
void VirtualWire::pump(int side) {
    if (reset_ || silent_) return;
    Way& way = from(side);
    const int64_t now = VirtualTime::current().now_us();
    const size_t space = receive_buffer - std::min(receive_buffer, way.arrived.size());
    if (space == 0) return;
    const ChaosLink::Out out = way.link.take(now, space);
    if (!at(1 - side).closed) way.arrived.insert(way.arrived.end(), out.bytes.begin(), out.bytes.end());
    if (out.ended) way.finished = true;
    // Whoever has closed resets a peer that goes on sending.
    if (at(1 - side).closed && !out.bytes.empty()) reset();
    wake(1 - side);
    wake(side);
    if (out.cut) return cut(*out.cut);
    const int64_t next = way.link.next_us(now);
    if (next == INT64_MAX || next >= way.pump_at_us) return;
    way.pump_at_us = next;
    VirtualTime::current().at(next, [self = shared_from_this(), side] {
        self->from(side).pump_at_us = INT64_MAX;
        self->pump(side);
    });
}

void VirtualWire::wake(int side) {
    End& end = at(side);
    if (end.closed) return;
    const Way& in = towards(side);
    const auto call = [&](std::function<void()>& ready) {
        // Later, and only if nobody has closed by then.
        VirtualTime::current().soon([self = shared_from_this(), side, task = std::exchange(ready, nullptr)] {
            if (!self->at(side).closed) task();
        });
    };
    if (end.readable && (!in.arrived.empty() || in.finished || reset_)) call(end.readable);
    if (end.writable && (reset_ || room(side) > 0)) call(end.writable);
}

void VirtualWire::reset() {
    reset_ = true;
    wake(0);
    wake(1);
}

void VirtualWire::cut(CutKind kind) {
    if (reset_ || silent_ || cut_) return;
    cut_ = kind;
    switch (kind) {
        case CutKind::silence: silent_ = true; return;
        case CutKind::reset: return reset();
        case CutKind::finish: break;
    }
    // What was under way is lost; both sides see an end, and whoever writes on is told that nobody listens.
    silent_ = true;
    for (int side = 0; side < 2; ++side) from(side).finished = true;
    wake(0);
    wake(1);
}

void VirtualWire::heal() {
    for (int side = 0; side < 2; ++side) {
        from(side).link.heal();
        pump(side);
    }
}

void VirtualWire::forget() {
    // Moved out first: what a callback owns may close its end here.
    const auto dropped = std::exchange(ends_, {});
}

VirtualNet::~VirtualNet() {
    for (const auto& wire : wires_) wire->forget();
}

void VirtualNet::heal_all() {
    for (const auto& wire : wires_) wire->heal();
}

void VirtualNet::listen(uint16_t port, Accept accept) {
    deaf(port);
    listening_.emplace_back(port, std::move(accept));
}

void VirtualNet::deaf(uint16_t port) {
    std::erase_if(listening_, [port](const auto& one) { return one.first == port; });
}

void VirtualNet::connect(uint16_t port, std::function<void(std::unique_ptr<VirtualEnd>)> done) {
    const uint64_t number = wires_.size();
    const Plan made = plan ? plan(number, port) : Plan{{}, port};
    const auto wire = std::make_shared<VirtualWire>(made.faults, splitmix64(seed_) + 2 * number);
    wires_.push_back(wire);
    VirtualTime& time = VirtualTime::current();
    const int64_t there = time.now_us() + made.faults.up.delay_us;
    const int64_t back = there + made.faults.down.delay_us;
    time.at(there, [this, wire, to = made.port, back, done = std::move(done)] {
        const auto found = std::find_if(listening_.begin(), listening_.end(),
                                        [to](const auto& one) { return one.first == to; });
        const bool taken = found != listening_.end();
        if (taken) found->second(VirtualWire::end(wire, 1));
        VirtualTime::current().at(back,
                                  [wire, taken, done] { done(taken ? VirtualWire::end(wire, 0) : nullptr); });
    });
}

void VirtualNet::cut_all(CutKind kind) {
    for (const auto& wire : wires_) wire->cut(kind);
}

}  // namespace trochoid
