#include "server/net/web_frame_count.hpp"

#include <algorithm>

namespace trochoid {

uint32_t WebFrameCount::take(std::span<const uint8_t> bytes) {
    constexpr size_t mask_bytes = 4;
    uint32_t count = 0;
    while (!bytes.empty()) {
        if (left_ > 0) {
            const size_t piece = static_cast<size_t>(std::min<uint64_t>(left_, bytes.size()));
            left_ -= piece;
            bytes = bytes.subspan(piece);
            continue;
        }
        const unsigned byte = bytes.front();
        bytes = bytes.subspan(1);
        if (header_read_ == 0) {
            const bool whole = (byte & 0x80U) != 0 && ((byte & 0xfU) == 1 || (byte & 0xfU) == 2);
            if (!whole) ++count;
        } else if (header_read_ == 1) {
            length_ = byte & 0x7fU;
            const size_t longer = length_ == 126 ? 2 : length_ == 127 ? 8 : 0;
            header_bytes_ = 2 + longer + ((byte & 0x80U) != 0 ? mask_bytes : 0);
            if (longer > 0) length_ = 0;
            longer_left_ = longer;
        } else if (longer_left_ > 0) {
            length_ = length_ << 8 | byte;
            --longer_left_;
        }
        if (++header_read_ < 2 || header_read_ < header_bytes_) continue;
        left_ = length_;
        header_read_ = 0;
    }
    return count;
}

}  // namespace trochoid
