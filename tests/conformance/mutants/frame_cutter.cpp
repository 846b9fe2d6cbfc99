#include "tests/conformance/mutants/frame_cutter.hpp"

#include <algorithm>
#include <utility>

namespace trochoid::conformance::mutants {

namespace {

uint32_t word_at(const Bytes& bytes, size_t at) {
    uint32_t word = 0;
    for (size_t i = 0; i < 4; ++i) word |= uint32_t{bytes[at + i]} << (8 * i);
    return word;
}

}  // namespace

void FrameCutter::take(std::span<const uint8_t> bytes) {
    held_.insert(held_.end(), bytes.begin(), bytes.end());
    while (step()) {
    }
}

void FrameCutter::end() {
    if (!held_.empty()) hand_on(std::exchange(held_, {}));
}

Bytes FrameCutter::cut(size_t count) {
    const auto end = held_.begin() + static_cast<std::ptrdiff_t>(count);
    Bytes front(held_.begin(), end);
    held_.erase(held_.begin(), end);
    return front;
}

/// By R-104: three bytes tell.
void FrameCutter::choose() {
    const uint8_t first = held_[0];
    if (first == 0x16) {
        kind_ = Kind::other;
    } else if (first < 'A' || first > 'Z') {
        kind_ = Kind::magic;
    } else if (held_.size() >= 3) {
        kind_ =
            std::equal(held_.begin(), held_.begin() + 3, stream_magic.begin()) ? Kind::magic : Kind::other;
    }
}

bool FrameCutter::step() {
    if (held_.empty()) return false;
    if (swallow_ > 0) {
        const auto count = static_cast<size_t>(std::min<uint64_t>(swallow_, held_.size()));
        cut(count);
        swallow_ -= count;
        return true;
    }
    switch (kind_) {
        case Kind::unknown: choose(); return kind_ != Kind::unknown;
        case Kind::magic:
            if (held_.size() < stream_magic.size()) return false;
            kind_ = std::equal(stream_magic.begin(), stream_magic.end(), held_.begin()) ? Kind::frames
                                                                                        : Kind::as_it_is;
            spoiler_.opening(cut(stream_magic.size()), link_);
            return true;
        case Kind::frames: return step_frame();
        case Kind::as_it_is:
        case Kind::other: end(); return false;
    }
    return false;
}

bool FrameCutter::step_frame() {
    if (held_.size() < frame_header_bytes) return false;
    const uint32_t length = word_at(held_, 0);
    const uint32_t word = word_at(held_, 4);
    if (length == 0 || word != 0 || length > (first_ ? first_longest_ : longest_)) {
        const HeaderFate fate =
            from_ == From::client ? spoiler_.bad_header(length, word) : HeaderFate::pass_on;
        if (fate == HeaderFate::pass_on) {
            kind_ = Kind::as_it_is;
            return true;
        }
        if (fate == HeaderFate::swallow || length == 0) {
            cut(frame_header_bytes);
            swallow_ = length;
            return true;
        }
        std::fill_n(held_.begin() + 4, 4, uint8_t{0});
    }
    if (held_.size() - frame_header_bytes < length) return false;
    cut(frame_header_bytes);
    first_ = false;
    Bytes payload = cut(length);
    if (from_ == From::client)
        spoiler_.from_client(std::move(payload), link_);
    else
        spoiler_.from_server(std::move(payload), link_);
    return true;
}

void FrameCutter::hand_on(Bytes bytes) {
    const bool other = kind_ == Kind::other;
    if (from_ == From::client)
        other ? spoiler_.other_from_client(std::move(bytes), link_) : link_.bytes_to_server(bytes);
    else
        other ? spoiler_.other_from_server(std::move(bytes), link_) : link_.bytes_to_client(bytes);
}

}  // namespace trochoid::conformance::mutants
