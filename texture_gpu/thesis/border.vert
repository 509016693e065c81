// The edges of a polygon as lines of `line_width` pixels: two triangles each, since wide lines are
// no longer part of OpenGL's core. Conventions as in raster.vert.
#include "near.glsl"
layout(binding = 1) uniform samplerBuffer corners;
uniform mat4 T_face_node;
uniform vec4 face;       // fx fy cx cy, px
uniform vec2 face_size;  // px
uniform int first_corner, corner_count;
uniform float line_width;  // px

vec3 corner(int i) {
  return (T_face_node * texelFetch(corners, first_corner + i % corner_count)).xyz;
}

void main() {
  int edge = gl_VertexID / 6, k = gl_VertexID % 6;
  vec3 a = corner(edge), b = corner(edge + 1);
  if (a.z < kNear && b.z < kNear) {
    gl_Position = vec4(2.0, 2.0, 0.0, 1.0);  // all of the edge is behind the camera
    return;
  }
  if (a.z < kNear) a = mix(b, a, (b.z - kNear) / (b.z - a.z));
  if (b.z < kNear) b = mix(a, b, (a.z - kNear) / (a.z - b.z));
  vec2 from = face.xy * a.xy / a.z + face.zw + 0.5, to = face.xy * b.xy / b.z + face.zw + 0.5;
  vec2 along = to - from;
  vec2 across = dot(along, along) > 1e-12 ? normalize(vec2(-along.y, along.x)) : vec2(1.0, 0.0);
  bool at_b = k == 1 || k == 2 || k == 4;
  float side = k == 0 || k == 1 || k == 3 ? -0.5 : 0.5;
  vec2 pixel = (at_b ? to : from) + side * line_width * across;
  float z = at_b ? b.z : a.z;
  gl_Position = vec4((2.0 * pixel / face_size - 1.0) * z, kNear, z);
}
