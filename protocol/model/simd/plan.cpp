#include "protocol/model/simd/plan.hpp"

#include <algorithm>

#include "protocol/model/arithmetic_rules.hpp"
#include "protocol/model/gain.hpp"

namespace trochoid::simd {

namespace {

/// Blocks that a tile may look at to find out that a field has none there.
constexpr int64_t most_looks = 16;
/// Blocks of a PlannedLattice.
constexpr int64_t most_blocks = 1024;

uint32_t low(int64_t v) { return static_cast<uint32_t>(static_cast<uint64_t>(v)); }

float radians_per_metre(int32_t k) { return 0x1.921fb6p+2F * (static_cast<float>(k) * 0x1p-22F); }

SideRamp ramp_of(int32_t length, float sign) {
    return {length, static_cast<uint32_t>((uint64_t{1} << 40) / static_cast<uint64_t>(length)),
            sign * (1024.0F / static_cast<float>(length))};
}

TrainRow row_of(const WaveTrain& train, const TrainConstants& c, uint32_t phase, LatticePoint origin,
                int64_t step_x, int64_t step_z) {
    TrainRow r;
    r.kx = static_cast<uint32_t>(train.kx) * low(step_x);
    r.kz = static_cast<uint32_t>(train.kz) * low(step_z);
    r.phase = phase_from_place(train, origin.x, origin.z) + phase;
    r.hx = c.hx;
    r.a = c.a;
    r.hz = c.hz;
    r.akx = c.a * c.kx;
    r.akz = c.a * c.kz;
    r.hxkx = c.hx * c.kx;
    r.hxkz = c.hx * c.kz;
    r.hzkx = c.hz * c.kx;
    r.hzkz = c.hz * c.kz;
    r.vx = c.omega * c.hx;
    r.vy = c.omega * c.a;
    r.vz = c.omega * c.hz;
    r.wave_kx = c.kx;
    r.wave_kz = c.kz;
    return r;
}

void plan_irregular(PlannedBox& box) {
    const IrregularHeight& i = box.live->box->record.irregular;
    box.share = static_cast<float>(i.share) * 0x1p-15F;
    box.ukx = radians_per_metre(i.ukx);
    box.ukz = radians_per_metre(i.ukz);
    box.vkx = radians_per_metre(i.vkx);
    box.vkz = radians_per_metre(i.vkz);
}

bool has_blocks(const LandField& field) {
    for (const LandField* f = &field; f != nullptr; f = f->base().get())
        if (f->block_count() != 0) return true;
    return false;
}

PlannedField planned(const LandField& field, const PlannedLattice& lattice) {
    PlannedField out;
    out.field = &field;
    if (lattice.columns == 0) return out;
    out.everywhere = true;
    out.blocks.reserve(size_t{lattice.columns} * lattice.rows);
    for (uint32_t row = 0; row < lattice.rows; ++row)
        for (uint32_t column = 0; column < lattice.columns; ++column) {
            const LandBlock* block = field.find({lattice.first.x + static_cast<int32_t>(column),
                                                 lattice.first.z + static_cast<int32_t>(row)});
            out.everywhere &= block != nullptr;
            out.blocks.push_back(block != nullptr ? block : &open_block());
        }
    return out;
}

/// Whether some block of the field may touch the rectangle.
bool may_touch(const PlannedField& field, const PlannedLattice& lattice, const LatticeRect& rect) {
    if (field.everywhere) return true;
    const BlockRange range = blocks_touching(rect, field.field->step_log2());
    const int64_t columns = int64_t{range.last.x} - range.first.x + 1;
    const int64_t rows = int64_t{range.last.z} - range.first.z + 1;
    if (columns > most_looks || rows > most_looks || columns * rows > most_looks) return true;
    for (int32_t z = range.first.z; z <= range.last.z; ++z)
        for (int32_t x = range.first.x; x <= range.last.x; ++x)
            if (field.blocks.empty() ? field.field->find({x, z}) != nullptr
                                     : field.blocks[lattice.place({x, z})] != &open_block())
                return true;
    return false;
}

}  // namespace

const LandBlock& open_block() {
    static const LandBlock open = [] {
        LandBlock block;
        block.gain.fill(unit_node_gain);
        return block;
    }();
    return open;
}

PlannedLattice lattice_around(const LatticeRect& rect, int step) {
    const BlockRange range = blocks_touching(rect, static_cast<uint8_t>(step));
    const int64_t columns = int64_t{range.last.x} - range.first.x + 1;
    const int64_t rows = int64_t{range.last.z} - range.first.z + 1;
    if (columns > most_blocks || rows > most_blocks || columns * rows > most_blocks) return {};
    return {range.first, static_cast<uint32_t>(columns), static_cast<uint32_t>(rows)};
}

Plan plan_of(const SeaInstant& sea, LatticePoint origin, int64_t step_x, int64_t step_z,
             const LatticeRect& rect) {
    Plan plan;
    plan.sea = &sea;
    const Layers layers = sea.layers();
    plan.shelter = layers.has(Layer::shelter);
    plan.refraction = layers.has(Layer::refraction);
    plan.orbits = layers.has(Layer::orbits);
    const bool land = plan.shelter || plan.refraction || plan.orbits;
    for (const LiveBox& live : sea.live()) {
        const PreparedBox& prepared = *live.box;
        const WaveTrainBox& record = prepared.record;
        PlannedBox box;
        box.live = &live;
        box.limited = record.length != 0 || record.width != 0;
        if (cover_of(box, rect) == Cover::none) continue;
        box.first_row = static_cast<int32_t>(plan.rows.size());
        box.rows = layers.has(Layer::trains) ? static_cast<int32_t>(record.trains.size()) : 0;
        const float full = gain_to_float(live.instant.time_gain);
        box.unit_gain = full == 1.0F;
        box.uneven = record.irregular.share != 0 && layers.has(Layer::irregular);
        box.round = record.roundness != 0 && layers.has(Layer::round);
        box.wake = has_wake(record.wake) && layers.has(Layer::wakes);
        box.noise = !live.noise.empty();
        box.ux = static_cast<float>(record.ux) * 0x1p-30F;
        box.uz = static_cast<float>(record.uz) * 0x1p-30F;
        box.rear = ramp_of(record.ramp_rear, 1.0F);
        box.front = ramp_of(record.ramp_front, -1.0F);
        box.side = ramp_of(record.ramp_side, 1.0F);
        if (record.width != 0)
            box.width_reciprocal = (uint64_t{1} << 40) / static_cast<uint64_t>(record.width);
        if (box.uneven) plan_irregular(box);
        if (land)
            for (const auto& field : prepared.fields) {
                const int step = field->step_log2();
                PlannedLattice& lattice = plan.lattices[static_cast<size_t>(step - 12)];
                if ((plan.steps >> step & 1U) == 0) lattice = lattice_around(rect, step);
                plan.steps |= 1U << step;
                box.fields.push_back(planned(*field, lattice));
            }
        box.first_field = plan.all_fields;
        plan.all_fields += box.fields.size();
        plan.most_fields = std::max(plan.most_fields, box.fields.size());
        for (size_t i = 0; i < static_cast<size_t>(box.rows); ++i) {
            TrainRow row =
                row_of(record.trains[i], prepared.constants[i], live.phase[i], origin, step_x, step_z);
            row.g = full;
            row.round_wave_number =
                static_cast<uint32_t>((uint64_t{prepared.constants[i].whole} * record.roundness) >> 15);
            const int16_t field = prepared.field_of_train[i];
            if (land && field >= 0 && has_blocks(*prepared.fields[static_cast<size_t>(field)]))
                row.local = 1 + field;
            box.open_rows |= row.local == 0;
            if (box.runs.empty() || box.runs.back().local != row.local)
                box.runs.push_back({static_cast<int32_t>(plan.rows.size()), 0, row.local});
            ++box.runs.back().rows;
            plan.rows.push_back(row);
        }
        plan.boxes.push_back(std::move(box));
    }
    return plan;
}

Cover cover_of(const PlannedBox& box, const LatticeRect& rect) {
    if (!box.limited) return Cover::full;
    const WaveTrainBox& record = box.live->box->record;
    const BoxInstant& instant = box.live->instant;
    constexpr int64_t reach = int64_t{1} << 31;
    const int64_t west = rect.min.x - instant.origin.x;
    const int64_t east = rect.max.x - instant.origin.x;
    const int64_t north = rect.min.z - instant.origin.z;
    const int64_t south = rect.max.z - instant.origin.z;
    if (west > reach || east < -reach || north > reach || south < -reach) return Cover::none;
    if (west < -reach || east > reach || north < -reach || south > reach) return Cover::varied;
    // u and v are monotonic in x and in z, truncation included, so the corners bound them.
    const int64_t ux = record.ux;
    const int64_t uz = record.uz;
    const int64_t u_x_low = (ux >= 0 ? west : east) * ux;
    const int64_t u_x_high = (ux >= 0 ? east : west) * ux;
    const int64_t u_z_low = (uz >= 0 ? north : south) * uz;
    const int64_t u_z_high = (uz >= 0 ? south : north) * uz;
    const int64_t v_z_low = (ux >= 0 ? north : south) * ux;
    const int64_t v_z_high = (ux >= 0 ? south : north) * ux;
    const int64_t v_x_low = (uz >= 0 ? east : west) * uz;
    const int64_t v_x_high = (uz >= 0 ? west : east) * uz;
    const int64_t u_low = (u_x_low + u_z_low) >> 30;
    const int64_t u_high = (u_x_high + u_z_high) >> 30;
    const int64_t v_low = (v_z_low - v_x_low) >> 30;
    const int64_t v_high = (v_z_high - v_x_high) >> 30;
    const int64_t front = instant.front;
    if (record.length != 0 && (u_high <= 0 || u_low >= front)) return Cover::none;
    if (record.width != 0 && (v_high <= 0 || v_low >= record.width)) return Cover::none;
    if (record.length != 0 && (u_low < record.ramp_rear || front - u_high < record.ramp_front))
        return Cover::varied;
    if (record.width != 0 && (v_low < record.ramp_side || record.width - v_high < record.ramp_side))
        return Cover::varied;
    return Cover::full;
}

bool varies(const std::vector<Stretch>& stretches) {
    return std::any_of(stretches.begin(), stretches.end(),
                       [](const Stretch& s) { return s.box != nullptr && !s.full; });
}

void stretches_of(const Plan& plan, const LatticeRect& rect, std::vector<Stretch>& out) {
    out.clear();
    for (const PlannedBox& box : plan.boxes) {
        const Cover cover = cover_of(box, rect);
        if (cover == Cover::none) continue;
        const bool full = cover == Cover::full;
        const bool even = full && !box.uneven && !box.round;
        uint64_t touched = 0;  // of the first 63 fields; later ones count as touched
        bool any_field = false;
        if (even)
            for (size_t f = 0; f < box.fields.size(); ++f)
                if (f >= 63 || may_touch(box.fields[f], plan.lattice_of(*box.fields[f].field), rect)) {
                    touched |= uint64_t{1} << std::min<size_t>(f, 63);
                    any_field = true;
                }
        const auto fast = box.unit_gain ? Stretch::Kind::fast_unit : Stretch::Kind::fast;
        const auto is_fast = [&](const TrainRun& run) {
            return even &&
                   (run.local == 0 || !any_field || (touched >> std::min(run.local - 1, 63) & 1U) == 0);
        };
        for (size_t r = 0; r < box.runs.size();) {
            const bool here = is_fast(box.runs[r]);
            const int32_t first = box.runs[r].first_row;
            const size_t first_run = r;
            int32_t rows = 0;
            for (; r < box.runs.size() && is_fast(box.runs[r]) == here; ++r) rows += box.runs[r].rows;
            if (!out.empty() && here && out.back().kind == fast &&
                out.back().first_row + out.back().rows == first)
                out.back().rows += rows;
            else
                out.push_back({here ? fast : Stretch::Kind::general, first, rows, first_run,
                               here ? nullptr : &box, full});
        }
        if (box.wake || box.noise) out.push_back({Stretch::Kind::tail, 0, 0, 0, &box, full});
    }
}

}  // namespace trochoid::simd
