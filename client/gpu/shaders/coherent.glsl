// Triangles of the coherent mesh and their numbers: twin of client/scene/coherent_tree.hpp. Needs frame.glsl and spacing.glsl.

/// Hypotenuse from corner 0 to 1, legs from 1 to 2 and from 2 to 0; lattice units relative to the mesh's origin.
struct Triangle {
    ivec3 x;         // of the three corners
    ivec3 z;
    uvec2 identity;  // I of the paper's eq. 1, low word first
    uvec2 path;      // P of eq. 2
};

const uint roots = 256u;  // gamma; delta is 4, alpha 7

uniform ivec2 mesh_origin;      // relative to the anchor, lattice units
uniform float coarser;          // multiplies the wanted spacing: 1 unless the mesh would not fit
uniform float surely;           // squares of lengths over those wanted from which all above is surely split, too
uniform uvec2 ones[23];         // P after so many times pattern 1

// A child's corners as sums of the parent's A, B, C, halved; h, f, s are the middles of the hypotenuse and the first and the
// second leg. Three rows a kind of child.
const ivec3 child_rows[36] = ivec3[36](
    ivec3(0, 0, 2), ivec3(2, 0, 0), ivec3(1, 1, 0),   //  0: C A h
    ivec3(0, 2, 0), ivec3(0, 0, 2), ivec3(1, 1, 0),   //  1: B C h
    ivec3(1, 1, 0), ivec3(0, 0, 2), ivec3(1, 0, 1),   //  2: h C s
    ivec3(2, 0, 0), ivec3(1, 1, 0), ivec3(1, 0, 1),   //  3: A h s
    ivec3(1, 1, 0), ivec3(0, 2, 0), ivec3(0, 1, 1),   //  4: h B f
    ivec3(0, 0, 2), ivec3(1, 1, 0), ivec3(0, 1, 1),   //  5: C h f
    ivec3(1, 0, 1), ivec3(0, 1, 1), ivec3(0, 0, 2),   //  6: s f C
    ivec3(2, 0, 0), ivec3(0, 2, 0), ivec3(0, 1, 1),   //  7: A B f
    ivec3(2, 0, 0), ivec3(0, 1, 1), ivec3(1, 0, 1),   //  8: A f s
    ivec3(2, 0, 0), ivec3(0, 1, 1), ivec3(0, 0, 2),   //  9: A f C
    ivec3(2, 0, 0), ivec3(0, 2, 0), ivec3(1, 0, 1),   // 10: A B s
    ivec3(1, 0, 1), ivec3(0, 2, 0), ivec3(0, 0, 2));  // 11: s B C

// The way back: the parent's A, B, C as sums of the child's corners.
const ivec3 parent_rows[36] = ivec3[36](
    ivec3(0, 1, 0), ivec3(0, -1, 2), ivec3(1, 0, 0),
    ivec3(-1, 0, 2), ivec3(1, 0, 0), ivec3(0, 1, 0),
    ivec3(0, -1, 2), ivec3(2, 1, -2), ivec3(0, 1, 0),
    ivec3(1, 0, 0), ivec3(-1, 2, 0), ivec3(-1, 0, 2),
    ivec3(2, -1, 0), ivec3(0, 1, 0), ivec3(0, -1, 2),
    ivec3(1, 2, -2), ivec3(-1, 0, 2), ivec3(1, 0, 0),
    ivec3(2, 0, -1), ivec3(0, 2, -1), ivec3(0, 0, 1),
    ivec3(1, 0, 0), ivec3(0, 1, 0), ivec3(0, -1, 2),
    ivec3(1, 0, 0), ivec3(1, 2, -2), ivec3(-1, 0, 2),
    ivec3(1, 0, 0), ivec3(0, 2, -1), ivec3(0, 0, 1),
    ivec3(1, 0, 0), ivec3(0, 1, 0), ivec3(-1, 0, 2),
    ivec3(2, 0, -1), ivec3(0, 1, 0), ivec3(0, 0, 1));

// Kind of the child (pattern - 1) * 4 + number; -1: there is none.
const int kinds[28] = int[28](2, 3, 4, 5,  6, 7, 8, -1,  0, 4, 5, -1,  7, 9, -1, -1,  1, 2, 3, -1,  10, 11, -1, -1,  0, 1, -1, -1);

int children_of(int pattern) { return pattern == 1 ? 4 : (pattern == 2 || pattern == 3 || pattern == 5 ? 3 : 2); }

int sum(ivec3 row, ivec3 v) { return (row.x * v.x + row.y * v.y) + row.z * v.z; }
ivec3 sums(const bool back, int row, ivec3 v) {
    if (back) return ivec3(sum(parent_rows[row], v), sum(parent_rows[row + 1], v), sum(parent_rows[row + 2], v));
    return ivec3(sum(child_rows[row], v), sum(child_rows[row + 1], v), sum(child_rows[row + 2], v)) >> 1;
}

uvec2 plus(uvec2 a, uint b) {
    uint carry;
    uint low = uaddCarry(a.x, b, carry);
    return uvec2(low, a.y + carry);
}
uvec2 minus(uvec2 a, uint b) {
    uint borrow;
    uint low = usubBorrow(a.x, b, borrow);
    return uvec2(low, a.y - borrow);
}
/// a / 7 in two words, by digits of 16 bits; the rest in `rest`.
uvec2 seventh(uvec2 a, out uint rest) {
    uint high = a.y / 7u;
    uint t = ((a.y - high * 7u) << 16) | (a.x >> 16);
    uint middle = t / 7u;
    t = ((t - middle * 7u) << 16) | (a.x & 0xffffu);
    uint low = t / 7u;
    rest = t - low * 7u;
    return uvec2((middle << 16) | low, high);
}

bool is_root(Triangle t) { return t.identity.y == 0u && t.identity.x < roots; }

/// Refinements above a triangle: 4^level <= 3 I / 256 + 1.
int level_of(uvec2 identity) {
    uint carry;
    uint low = uaddCarry(identity.x, identity.x << 1, carry);
    uint high = identity.y + ((identity.y << 1) | (identity.x >> 31)) + carry;
    uvec2 y = plus(uvec2(low, high), roots);
    y = uvec2((y.x >> 8) | (y.y << 24), y.y >> 8);
    int bit = y.y != 0u ? 32 + findMSB(y.y) : findMSB(y.x);
    return bit >> 1;
}

Triangle child(Triangle t, int pattern, int number) {
    int row = kinds[(pattern - 1) * 4 + number] * 3;
    uint high, low;
    umulExtended(t.path.x, 7u, high, low);
    return Triangle(sums(false, row, t.x), sums(false, row, t.z),
                    plus(uvec2(t.identity.x << 2, (t.identity.y << 2) | (t.identity.x >> 30)), roots + uint(number)),
                    plus(uvec2(low, high + t.path.y * 7u), uint(pattern)));
}

/// Parent of a triangle that is no root; which child of what pattern it is (p = ((P - 1) mod 7) + 1).
Triangle parent(Triangle t, out int pattern, out int number) {
    uvec2 i = minus(t.identity, roots);
    number = int(i.x & 3u);
    uint digit;
    uvec2 path = seventh(minus(t.path, 1u), digit);
    pattern = int(digit) + 1;
    int row = kinds[int(digit) * 4 + number] * 3;
    return Triangle(sums(true, row, t.x), sums(true, row, t.z), uvec2((i.x >> 2) | (i.y << 30), i.y >> 2), path);
}

/// Whether the edge between two places is to be split, the same from either end; `clear` stays where it is so by far.
bool edge_wants_split(ivec2 a, ivec2 b, inout bool clear) {
    ivec2 middle = mesh_origin + ((a + b) >> 1);
    precise float length2 = mesh_length2(middle, b - a);
    precise float wanted = mesh_spacing(middle) * coarser;
    precise float limit = 4.0 * (wanted * wanted);
    clear = clear && length2 >= limit * surely;
    return length2 >= limit;
}

/// Pattern by the edges that want to be split, 0 = none; `clear` where all three want it by far.
int pattern_of(Triangle t, out bool clear) {
    ivec2 a = ivec2(t.x.x, t.z.x);
    ivec2 b = ivec2(t.x.y, t.z.y);
    ivec2 c = ivec2(t.x.z, t.z.z);
    clear = true;
    int edges = 0;
    if (edge_wants_split(a, b, clear)) edges += 1;
    if (edge_wants_split(b, c, clear)) edges += 4;
    if (edge_wants_split(c, a, clear)) edges += 2;
    return edges == 0 ? 0 : 8 - edges;
}
