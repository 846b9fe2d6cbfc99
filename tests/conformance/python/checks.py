"""What a receiver of the server's messages checks once they are read (R-115 to R-118)."""
import math

from binary32 import from_bits, r1
from fbs import STRING, Scalar, Struct, Table, Union, Vector
from patch_planes import decode_patches
from planes import PlaneError, decode_tile
from refusal import Refusal

TIME = (-(1 << 61), 1 << 61)
STAMP = (-(1 << 56), 1 << 56)
PLACE = (-(1 << 35), 1 << 35)
SPAN = (0, 1 << 39)
ANY_ID = (1, (1 << 32) - 1)
WORST = from_bits(0x7F7FFFFF)
HALF_ANGLE = (r1(0.01), 1e6)
TENTH = r1(0.1)
SPEED = (-10_000, 10_000)
FRAME = (1024, 1 << 24)

# Fields that may be absent (R-115, chapter 10).
OPTIONAL = {
    "Box.fields", "Box.field_of_train", "Box.succession", "Box.overlays", "Box.course", "Box.irregular", "Box.noise", "Box.wake",
    "Box.hull", "Delta.boxes", "Delta.removed_boxes", "Delta.blocks", "Delta.nodes", "Delta.removed_blocks", "Delta.box_ids",
    "Delta.patches", "Delta.patch_boxes", "Delta.removed_patches", "Delta.patch_planes", "BoxSummary.hull",
    "ServerHello.ticket", "ClientHello.ticket", "ClientHello.resume", "LandChanged.also"}

RANGES = {
    "Point.x": PLACE, "Point.z": PLACE, "Region.x": PLACE, "Region.z": PLACE,
    "View.x": PLACE, "View.z": PLACE, "View.tan_half_width": HALF_ANGLE, "View.tan_half_height": HALF_ANGLE,
    "View.vx": SPEED, "View.vy": SPEED, "View.vz": SPEED, "View.accepted_error_px": (TENTH, 100),
    "View.patch_budget": (1, 1024), "View.viewport_width": (1, 16384), "View.viewport_height": (1, 16384),
    "Clock.start_us": TIME, "Clock.monotonic_start_us": STAMP, "Clock.epoch": ANY_ID, "Clock.rate_q16": (0, 16 << 16),
    "Limits.frame_before_login": FRAME, "Limits.frame_after_login": FRAME, "Limits.frame_to_client": FRAME,
    "ServerHello.client_stamp_us": STAMP, "ServerHello.server_now_us": STAMP, "ServerHello.challenge_count": (0, 65536),
    "ClockReply.client_sent_us": STAMP, "ClockReply.server_received_us": STAMP, "ClockReply.server_sent_us": STAMP,
    "ClockReply.watermark_us": TIME,
    "CullKey.slack_tangent": (0, 1e6), "CullKey.error_in_force_px": (0, 1e6), "CullKey.patch_limit": (0, 1024),
    "CullKey.from_us": TIME, "CullKey.until_us": TIME,
    "Delta.result": ANY_ID, "Delta.watermark_us": TIME,
    "BoxHead.x": PLACE, "BoxHead.z": PLACE, "BoxHead.length": (0, 1 << 30), "BoxHead.width": (0, 1 << 30),
    "BoxHead.begin_us": TIME, "BoxHead.build_up_us": SPAN, "BoxHead.end_us": TIME, "BoxHead.decay_us": SPAN,
    "BoxHead.id": ANY_ID, "BoxHead.ramp_rear": (1024, 1 << 31), "BoxHead.ramp_front": (1024, 1 << 31),
    "BoxHead.ramp_side": (1024, 1 << 31), "BoxHead.roundness": (0, 1 << 15),
    "Train.kx": (1 - (1 << 31), 1 << 31), "Train.kz": (1 - (1 << 31), 1 << 31), "Train.choppiness": (0, 4),
    "Succession.raised_us": (0, 1 << 61), "Succession.fade_us": SPAN, "Overlay.field": ANY_ID, "Overlay.base": ANY_ID,
    "Leg.from_us": TIME, "Leg.duration_us": (0, 1 << 41), "Leg.x": PLACE, "Leg.z": PLACE,
    "Leg.vx": (1 - (1 << 21), (1 << 21) - 1), "Leg.vz": (1 - (1 << 21), (1 << 21) - 1),
    "Irregular.share": (0, 1 << 15), "Noise.octaves": (1, 12), "Noise.step_log2": (6, 20), "Noise.period_log2": (14, 40),
    "Wake.choppiness": (0, 4), "Wake.inverse_length": (1 << 20, 1 << 31), "Wake.group_speed": (1, 1 << 21),
    "Hull.length": (1, 500), "BlockHead.field": ANY_ID, "BlockHead.step_log2": (12, 20), "BlockName.field": ANY_ID,
    "Patch.left_out": (0, WORST), "Patch.height_error": (0, WORST), "Patch.level": (15, 26), "PatchName.level": (15, 26),
    "PatchBox.train_count": (0, 256),
    "TerrainTile.level": (0, 8), "TerrainTile.height_step_log2": (0, 10),
    "CommandReply.effective_us": TIME, "BoxSummary.begin_us": TIME, "BoxSummary.end_us": TIME, "BoxSummary.decay_us": SPAN,
    "BoxSummary.x": PLACE, "BoxSummary.z": PLACE, "BoxList.now_us": TIME, "SampleReply.time_us": TIME,
    "ActionPoint.x": PLACE, "ActionPoint.z": PLACE, "ActionPoint.kind": (1, 4), "ProbeReply.time_us": TIME}

LENGTHS = {  # the longest string or list, and the code where it is longer
    "Goodbye.message": (512, "value_out_of_range"), "CommandReply.message": (512, "value_out_of_range"),
    "ServerHello.projection": (4096, "value_out_of_range"), "ServerHello.ticket": (512, "value_out_of_range"),
    "ClientHello.ticket": (512, "value_out_of_range"), "ClientHello.token": (1024, "value_out_of_range"),
    "CullKey.regions": (32, "too_many_regions"), "ClientHello.regions": (32, "too_many_regions"),
    "Box.trains": (256, "too_many_trains"), "Box.overlays": (256, "value_out_of_range"), "Box.course": (64, "too_many_legs"),
    "Delta.boxes": (1024, "too_many_boxes"), "Delta.patches": (1024, "value_out_of_range"),
    "SampleReply.samples": (240, "value_out_of_range"), "ProbeReply.samples": (16, "value_out_of_range"),
    "ProbeReply.parts": (896, "value_out_of_range")}
NAME_LENGTH = (256, "value_out_of_range")


def _need(condition, what, code="value_out_of_range", requirement=117):
    if not condition:
        raise Refusal(code, requirement, what)


def _amplitude(value, what):
    _need(value == 0 or 2.0 ** -20 <= value <= 32, what)


def check_view(view, what):
    length = math.sqrt(view.qx ** 2 + view.qy ** 2 + view.qz ** 2 + view.qw ** 2)
    _need(abs(length - 1) <= 0.001, f"{what}: the quaternion has length {length}", "not_a_unit_quaternion", 118)


def _check_train(train, what):
    _need(train.kx or train.kz, f"{what} has no wave vector")
    _amplitude(train.amplitude, f"{what}: amplitude {train.amplitude}")


def _check_noise(noise, what):
    _amplitude(noise.amplitude, f"{what}: amplitude {noise.amplitude}")
    _need(noise.step_log2 - noise.octaves + 1 >= 4 and noise.period_log2 - noise.octaves + 1 >= 12, f"{what}: octaves too fine")


def _check_wake(wake, what):
    _amplitude(wake.transverse, what)
    _amplitude(wake.diverging, what)
    _need(wake.transverse or wake.diverging, f"{what} has no waves")


def _check_irregular(irregular, what):
    i = irregular
    _need(not i.share or ((i.ukx or i.ukz) and (i.vkx or i.vkz)), f"{what}: a wave vector is 0")


def _check_hull(hull, what):
    _need(0 < hull.beam <= hull.length, f"{what}: beam {hull.beam}")


def _check_cells(patch, what):
    reach = 1 << 35 - patch.level
    _need(-reach <= patch.x < reach and -reach <= patch.z < reach, f"{what} lies outside of the world")


def _check_block_head(head, what):
    reach = 1 << 31 - head.step_log2
    _need(abs(head.x) <= reach and abs(head.z) <= reach, f"{what} lies outside of the world")


def _check_box(box):
    head, trains = box.head, box.trains
    what = f"box {head.id}"
    _need(abs(head.ux ** 2 + head.uz ** 2 - (1 << 60)) <= 1 << 40, f"{what}: u has not length 1")
    _need(trains or box.noise or box.wake, f"{what} has nothing")
    if head.roundness:
        _need(head.width >= 1 << 10 and all(math.isqrt(t.kx ** 2 + t.kz ** 2) < 1 << 25 for t in trains), f"{what}: roundness")
    _need((box.fields is None) == (box.field_of_train is None), f"{what}: fields", "missing_field", 115)
    if box.fields is not None:
        _need(len(box.field_of_train) == len(trains) and max(box.field_of_train, default=0) < len(box.fields), f"{what}: fields")
    overlays = box.overlays or []
    _need(all(o.base < o.field for o in overlays) and _ascending([o.field for o in overlays]), f"{what}: overlays")
    course = box.course or []
    _need(_ascending([leg.from_us for leg in course]), f"{what}: course")
    _need(not course or (course[0].x, course[0].z) == (head.x, head.z), f"{what}: its course begins elsewhere")
    _need(not box.wake or (head.length and head.width and len(course) == 1), f"{what}: wake")
    _need(not box.hull or (head.length and head.width), f"{what}: hull")


def _ascending(values):
    return all(a < b for a, b in zip(values, values[1:]))


def _check_key(key):
    _need(key.from_us <= key.until_us, "a key's span ends before it begins")


def _check_delta(delta):
    _need(delta.base < delta.result, f"result {delta.result} has base {delta.base}")
    _need(_ascending([box.head.id for box in delta.boxes or []]), "boxes not by ascending id")
    _need(sum(head.node_bytes for head in delta.blocks or []) == len(delta.nodes or b""), "nodes do not fit their blocks")
    entries = delta.patch_boxes or []
    _need(sum(patch.box_count for patch in delta.patches or []) == len(entries), "patch_boxes do not fit their patches")
    ids = delta.box_ids or []
    _need(all(entry.box_index < len(ids) for entry in entries), "a box_index beyond box_ids")
    if delta.patch_planes is not None:
        listed = delta.patches, delta.patch_boxes, delta.removed_patches
        _need(all(field is None for field in listed), "patches as lists and as planes")
        decode_patches(delta.patch_planes, ids)


def _check_tile(tile):
    reach = 1 << 8 - tile.level
    _need(0 <= tile.x < reach and 0 <= tile.z < reach, "a tile outside of its level")
    _need(0 <= tile.spacing_log2 - tile.level <= 20, "a tile's spacing")
    try:
        heights = decode_tile(tile.heights)
    except PlaneError as error:
        raise Refusal("value_out_of_range", 117, f"a tile's heights: {error}") from error
    _need(all(-32768 <= height <= 32767 for height in heights), "a tile's heights")


def _check_hello(hello):
    _need(len(hello.instance) == 16, "instance is not 16 bytes")


def _check_rays(rays):
    _need(sum(ray.point_count for ray in rays.rays) == len(rays.points), "points do not fit their rays")


def _check_probe_reply(reply):
    if not reply.stale:
        _need(len(reply.samples) == len(reply.part_counts), "part_counts do not fit the samples")
        _need(sum(reply.part_counts) == len(reply.parts) == len(reply.sums), "parts do not fit their points")


STRUCT_RULES = {
    "View": check_view, "Train": _check_train, "Noise": _check_noise, "Wake": _check_wake, "Irregular": _check_irregular,
    "Hull": _check_hull, "Patch": _check_cells, "PatchName": _check_cells, "BlockHead": _check_block_head}
TABLE_RULES = {
    "Box": _check_box, "CullKey": _check_key, "Delta": _check_delta, "TerrainTile": _check_tile, "ServerHello": _check_hello,
    "RaysReply": _check_rays, "ProbeReply": _check_probe_reply}


class _StructCheck:
    """The checks of a struct's members, worked out once."""

    def __init__(self, kind):
        self.kind = kind
        self.members = []
        for index, (name, scalar) in enumerate(kind.members):
            # Members of a struct within are named outer_inner; places are Points.
            limits = RANGES.get(f"{kind.name}.{name}") or (PLACE if name.endswith(("_x", "_z")) and scalar.size == 8 else None)
            if limits or scalar.is_float or scalar.values:
                self.members.append((index, name, scalar, limits))
        self.rule = STRUCT_RULES.get(kind.name)

    def __call__(self, value, what):
        for index, name, scalar, limits in self.members:
            check_number(scalar, limits, value[index], what, name)
        if self.rule:
            self.rule(value, what)


def check_number(scalar, limits, value, what, name):
    if scalar.is_float:
        _need(math.isfinite(value), f"{what}.{name} is {value}", "not_finite", 116)
    if limits:
        _need(limits[0] <= value <= limits[1], f"{what}.{name} is {value}")
    if scalar.values:
        known = value in scalar.values.values() or scalar.name == "Code" and 1 <= value // 100 <= 7
        _need(known, f"{what}.{name} is {value}")


_struct_checks = {}


def check(value):
    """Refusal where a message that has been read, or a table in it, breaks R-115 to R-118."""
    table = value.of
    for field in table.fields:
        path = f"{table.name}.{field.name}"
        own = getattr(value, field.name)
        if own is None:
            _need(path in OPTIONAL, f"{path} is absent", "missing_field", 115)
        elif isinstance(field.kind, Scalar):
            check_number(field.kind, RANGES.get(path), own, table.name, field.name)
        else:
            _check_kind(field.kind, own, path)
    rule = TABLE_RULES.get(table.name)
    if rule:
        rule(value)


def _check_kind(kind, value, path):
    if isinstance(kind, Struct):
        if kind not in _struct_checks:
            _struct_checks[kind] = _StructCheck(kind)
        _struct_checks[kind](value, path)
    elif isinstance(kind, (Table, Union)):
        check(value)
    elif isinstance(kind, Vector):
        longest, code = LENGTHS.get(path, NAME_LENGTH if kind is STRING else (1 << 32, ""))
        _need(len(value) <= longest, f"{path} has {len(value)}", code)
        if kind is STRING:
            _check_text(value, path)
        elif isinstance(kind.element, (Struct, Table)):
            for element in value:
                _check_kind(kind.element, element, path)


def _check_text(value, path):
    try:
        text = value.decode("utf-8")
    except UnicodeDecodeError:
        raise Refusal("value_out_of_range", 117, f"{path} is not UTF-8") from None
    _need(all(ord(c) >= 32 and ord(c) != 127 for c in text), f"{path} holds control characters")
