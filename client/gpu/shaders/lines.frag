in vec4 line_tint;
out vec4 colour;

void main() { colour = line_tint; }
