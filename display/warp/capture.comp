// Depth and node of a drawn view, in a form that searching reads: see warp_layers.hpp.
#include "near.glsl"
layout(local_size_x = 8, local_size_y = 8) in;
layout(binding = 0) uniform sampler2DArray face_depth;  // near / z, 0 where no model is
layout(binding = 1) uniform usampler2DArray surface;    // triangle + 1
layout(binding = 2) uniform usamplerBuffer node_of_triangle;
layout(binding = 0, r32f) uniform writeonly image2D depth;
layout(binding = 1, r8ui) uniform writeonly uimage2D node;
uniform ivec2 size;

void main() {
  ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
  if (any(greaterThanEqual(pixel, size))) return;
  uint triangle = texelFetch(surface, ivec3(pixel, 0), 0).r;
  imageStore(depth, pixel, vec4(texelFetch(face_depth, ivec3(pixel, 0), 0).r / kNear));
  imageStore(node, pixel, uvec4(triangle == 0u ? 0u : texelFetch(node_of_triangle, int(triangle) - 1).r));
}
