#include "server/net/answer_lane.hpp"

#include <utility>

namespace trochoid {

namespace {

// Well below the frame limit: the estimates of what an element takes on the wire are rounded up.
constexpr size_t piece_bytes = 12 * 1024;

size_t wire_bytes(const BoxSummary& box) { return 160 + box.name.size(); }
size_t wire_bytes(const WaveRay& ray) { return 64 + 32 * ray.points.size(); }

// `part` is the reply without its elements; `elements` names their member.
template <class Reply, class Element>
std::deque<ServerMessage> cut(const Reply& part, std::vector<Element> Reply::*elements,
                              std::vector<Element> all) {
    std::deque<ServerMessage> pieces;
    Reply piece = part;
    size_t bytes = 0;
    for (Element& element : all) {
        const size_t more = wire_bytes(element);
        if (bytes > 0 && bytes + more > piece_bytes) {
            piece.last = false;
            pieces.emplace_back(std::exchange(piece, part));
            bytes = 0;
        }
        bytes += more;
        (piece.*elements).push_back(std::move(element));
    }
    piece.last = true;
    pieces.emplace_back(std::move(piece));
    return pieces;
}

}  // namespace

std::deque<ServerMessage> in_pieces(BoxList list) {
    std::vector<BoxSummary> boxes = std::exchange(list.boxes, {});
    return cut(list, &BoxList::boxes, std::move(boxes));
}

std::deque<ServerMessage> in_pieces(RaysReply reply) {
    std::vector<WaveRay> rays = std::exchange(reply.rays, {});
    return cut(reply, &RaysReply::rays, std::move(rays));
}

}  // namespace trochoid
