// One GL patch is one vertex: a square of still water (SeaQuad).
layout(location = 0) in ivec4 quad;
out VertexQuad { ivec4 quad; } to_control;

void main() { to_control.quad = quad; }
