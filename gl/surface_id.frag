// Which triangle is seen: its index in the scene plus one; 0 is left where there is no model.
uniform uint first_triangle;
layout(location = 0) out uint surface;

void main() { surface = first_triangle + uint(gl_PrimitiveID) + 1u; }
