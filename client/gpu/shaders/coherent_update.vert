// Hands a record of the coherent mesh to the geometry shader.
layout(location = 0) in ivec2 a;
layout(location = 1) in ivec2 b;
layout(location = 2) in ivec2 c;
layout(location = 3) in uvec2 identity;
layout(location = 4) in uvec2 path;
out Record {
    ivec3 x;
    ivec3 z;
    uvec2 identity;
    uvec2 path;
} record;

void main() {
    record.x = ivec3(a.x, b.x, c.x);
    record.z = ivec3(a.y, b.y, c.y);
    record.identity = identity;
    record.path = path;
}
