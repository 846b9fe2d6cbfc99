"""The interest state of chapter 8: what a client holds, how deltas change it, and its hash."""
import struct

import sea_records as records
from hashing import fnv
from patch_planes import Patch, decode_patches
from planes import PlaneError, decode_block
from refusal import Refusal
from sea import Sea

MOST_BLOCKS = 1 << 17  # what this client holds at most: 300 MiB


def box_record(wire):
    """A box of a delta as a record of the sea."""
    head = wire.head
    fields = [0] * len(wire.trains)
    if wire.fields is not None:
        fields = [wire.fields[index] for index in wire.field_of_train]
    trains = tuple(
        records.Train(t.kx, t.kz, t.omega_high << 32 | t.omega_low, t.phase, t.amplitude, t.choppiness, field)
        for t, field in zip(wire.trains, fields))
    raised, fade = wire.succession or (0, 0)
    i = wire.irregular
    irregular = records.Irregular() if i is None else records.Irregular(
        i.share, i.ukx, i.ukz, i.vkx, i.vkz, i.omega_high << 32 | i.omega_low, i.phase_u, i.phase_v)
    n = wire.noise
    noise = records.Noise() if n is None else records.Noise(
        n.amplitude, n.persistence, n.octaves, n.step_log2, n.period_log2, int(n.displayed_only != 0), n.seed)
    return records.Box(
        head.id, head.first_train, head.x, head.z, head.ux, head.uz, head.length, head.width, head.ramp_rear, head.ramp_front,
        head.ramp_side, head.begin_us, head.build_up_us, head.end_us, head.decay_us, head.front_speed, head.gain_max, raised, fade,
        head.roundness, trains, tuple(map(tuple, wire.overlays or ())), tuple(records.Leg(*leg) for leg in wire.course or ()),
        irregular, noise, records.Wake(*wire.wake) if wire.wake else records.Wake())


def box_hash(box):
    """Chapter 8, "Hash of a box"."""
    parts = [struct.pack(
        "<IIqqiiqqiiiqqqqIHqqHI", box.id, box.first_train, box.x, box.z, box.ux, box.uz, box.length, box.width, box.ramp_rear,
        box.ramp_front, box.ramp_side, box.begin, box.build_up, box.end, box.decay, box.front_speed, box.gain_max, box.raised,
        box.fade, box.roundness, len(box.trains))]
    parts += [struct.pack("<iiQIffI", *train) for train in box.trains]
    parts.append(struct.pack("<I", len(box.overlays)))
    parts += [struct.pack("<II", *overlay) for overlay in box.overlays]
    parts.append(struct.pack("<I", len(box.course)))
    parts += [struct.pack("<qqqqii", *leg) for leg in box.course]
    parts.append(struct.pack("<HiiiiQII", *box.irregular))
    parts.append(struct.pack("<fHBBBBI", *box.noise))
    parts.append(struct.pack("<fffII", *box.wake))
    return fnv(b"".join(parts))


def block_hash(x, z, block):
    """Chapter 8, "Hash of a block"."""
    return fnv(struct.pack("<ii289i289H289H", x, z, *block.shifts, *block.gains, *block.orbits))


def _land_block(head, data):
    try:
        shifts, gains, orbits = decode_block(data)
    except PlaneError as error:
        raise Refusal("value_out_of_range", 117, f"land block of field {head.field}: {error}") from None
    smooth = all(abs(a - b) < 1 << 23 for a, b in zip(shifts, shifts[17:])) and all(
        abs(shifts[n] - shifts[n + 1]) < 1 << 23 for n in range(288) if n % 17 != 16)
    if not smooth or not all(-(1 << 30) < s < 1 << 30 for s in shifts) or not all(0 <= v < 1 << 16 for v in gains + orbits):
        raise Refusal("value_out_of_range", 117, f"land block of field {head.field}: counts out of range")
    return records.Block(head.step_log2, tuple(shifts), tuple(gains), tuple(orbits))


class InterestState:
    """Boxes, land blocks and patches."""

    def __init__(self):
        self.clear()

    def clear(self):
        self.boxes, self.blocks, self.patches = {}, {}, {}
        self._box_hashes, self._block_hashes = {}, {}
        self._sea = None

    def apply(self, delta):
        """Applies a piece: first what goes, then what comes."""
        self._sea = None
        as_planes, gone = decode_patches(delta.patch_planes, delta.box_ids or ()) if delta.patch_planes is not None else ({}, ())
        for key in gone:
            self.patches.pop(key, None)
        for box in delta.removed_boxes or ():
            self.boxes.pop(box, None)
        for name in delta.removed_blocks or ():
            self.blocks.pop(tuple(name), None)
        for name in delta.removed_patches or ():
            self.patches.pop((name.level, name.x, name.z), None)
        for wire in delta.boxes or ():
            box = box_record(wire)
            self.boxes[box.id] = box
            self._box_hashes[box.id] = box_hash(box)
        at = 0
        for head in delta.blocks or ():
            key = head.field, head.x, head.z
            self.blocks[key] = _land_block(head, delta.nodes[at:at + head.node_bytes])
            self._block_hashes[key] = block_hash(head.x, head.z, self.blocks[key])
            at += head.node_bytes
        if len(self.blocks) > MOST_BLOCKS:
            raise Refusal("too_much_land", 0, f"{len(self.blocks)} land blocks are more than this client holds")
        at = 0
        for patch in delta.patches or ():
            entries = delta.patch_boxes[at:at + patch.box_count] if patch.box_count else []
            boxes = tuple((delta.box_ids[entry.box_index], entry.train_count) for entry in entries)
            self.patches[patch.level, patch.x, patch.z] = Patch(boxes, patch.left_out, patch.height_error)
            at += patch.box_count
        self.patches.update(as_planes)

    def check_whole(self):
        """What holds between the parts of a whole result."""
        steps = {}
        for (field, _, _), block in self.blocks.items():
            if steps.setdefault(field, block.step_log2) != block.step_log2:
                raise Refusal("value_out_of_range", 117, f"field {field} has blocks of two steps")
        for box in self.boxes.values():
            for field, base in box.overlays:
                if steps.get(field, steps.get(base)) != steps.get(base, steps.get(field)):
                    raise Refusal("value_out_of_range", 117, f"fields {field} and {base} have different steps")
        for key, patch in self.patches.items():
            for box, count in patch.boxes:
                if box not in self.boxes or count > len(self.boxes[box].trains):
                    raise Refusal("value_out_of_range", 117, f"patch {key} names {count} trains of box {box}")

    def hash(self):
        parts = [struct.pack("<I", len(self.boxes))]
        parts += [struct.pack("<Q", self._box_hashes[box]) for box in sorted(self.boxes)]
        parts.append(struct.pack("<I", len(self.blocks)))
        for key in sorted(self.blocks):
            parts.append(struct.pack("<IiiBQ", *key, self.blocks[key].step_log2, self._block_hashes[key]))
        parts.append(struct.pack("<I", len(self.patches)))
        for (level, x, z), patch in sorted(self.patches.items()):
            parts.append(struct.pack("<BiiI", level, x, z, len(patch.boxes)))
            parts += [struct.pack("<IH", *entry) for entry in patch.boxes]
            parts.append(struct.pack("<ff", patch.left_out, patch.height_error))
        return fnv(b"".join(parts))

    def sea(self):
        """The authoritative sea of what is held now."""
        if self._sea is None:
            self._sea = Sea(self.boxes.values(), dict(self.blocks))
        return self._sea

    def patch_at(self, x, z):
        """The patch over a point, or None."""
        for level in range(15, 27):
            patch = self.patches.get((level, x >> level, z >> level))
            if patch is not None:
                return patch
        return None

    def nearest_waves(self, x, z):
        """The middle of the patch with waves that lies nearest, or None."""
        middles = [((2 * px + 1) << level - 1, (2 * pz + 1) << level - 1)
                   for (level, px, pz), patch in self.patches.items() if patch.boxes]
        return min(middles, key=lambda m: (m[0] - x) ** 2 + (m[1] - z) ** 2, default=None)
