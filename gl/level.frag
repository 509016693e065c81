// Which triangle of the scene stands for what is seen, and in which plane it lies.
//
// The depth value D = near / z is linear on the face: over a plane, near = a x + b y + c z for its points, a and b from
// how D changes from pixel to pixel. So the plane is exact however vertices have moved.
//
// Defines: FADED 1: only some of the pixels are drawn, the others belong to another level. PART 1: only a part of the view is
// drawn (gl::ViewPart). PLANES 1: the plane is wanted.
#if PART
#include "view_part.glsl"
#else
#include "near.glsl"
#endif
#if PLANES
layout(location = 1) out vec4 plane;
#endif
layout(location = 0) out uint surface;
layout(binding = 0) uniform usamplerBuffer sources;
uniform uint first_triangle;
uniform int first_source;  // negative: triangles are the scene's own
uniform mat4 T_face_node;
uniform vec4 face;
uniform float share;   // of pixels that the coarser level has
uniform bool coarser;  // this is that level

#if FADED
// An ordered pattern of 4 x 4 pixels, each of its 16 values once.
float threshold(ivec2 pixel) {
  int x = pixel.x & 3, y = pixel.y & 3, q = x ^ y;
  int rank = (q & 1) << 3 | (y & 1) << 2 | (q & 2) | (y & 2) >> 1;
  return (float(rank) + 0.5) / 16.0;
}
#endif

void main() {
#if PLANES
  // Before anything is discarded: neighbours beyond that have no slope.
  float d = gl_FragCoord.z;
  vec2 slope = vec2(dFdx(d), dFdy(d));
  vec3 n = vec3(slope * face.xy, d + dot(slope, face.zw + 0.5 - gl_FragCoord.xy));
  float size = length(n);
  n /= size;
  plane = vec4(n * mat3(T_face_node), kNear / size - dot(n, T_face_node[3].xyz));
#endif
#if PART
  if (is_left_out()) discard;
#endif
#if FADED
  if ((threshold(ivec2(gl_FragCoord.xy)) < share) != coarser) discard;
#endif
  surface = 1u + (first_source < 0 ? first_triangle + uint(gl_PrimitiveID)
                                   : texelFetch(sources, first_source + gl_PrimitiveID).r);
}
