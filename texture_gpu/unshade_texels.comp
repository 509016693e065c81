// Takes shadows of moving parts out of texels that an image has shown in them: each as bright as it would be without. In
// place, where nobody looks them up yet. A work group a tile.
#include "near.glsl"
#define SHADOW_UNIT 3
#include "shadow.glsl"
#include "atlas.glsl"
layout(local_size_x = 8, local_size_y = 8) in;
layout(binding = 7) uniform samplerBuffer geometry;  // of each page four texels (ChartAtlas::write_job_geometry), for the lamp
layout(binding = 9) uniform usampler2DArray heights;
layout(binding = 10) uniform usamplerBuffer tiles;  // page << 4 | tile << 2
layout(binding = 0, r32ui) uniform uimage2DArray colours;
uniform int first_group;
uniform vec4 seen_from;  // the camera's place in the lamp's frame

// In units of raw heights; `otherwise` where no surface is.
float height_at(ivec3 at, float otherwise) {
  uint raw = texelFetch(heights, at, 0).r;
  return raw == 0u ? otherwise : float(raw & 0x7fffu) - 1.0;
}

void main() {
  uint tile = texelFetch(tiles, first_group + int(gl_WorkGroupID.x)).r;
  int first = 4 * int(tile >> 4);
  ivec2 in_tile = ivec2(gl_LocalInvocationID.xy), in_page = in_tile + 8 * ivec2((tile >> 2) & 1u, (tile >> 3) & 1u);
  vec4 corner = texelFetch(geometry, first), eu = texelFetch(geometry, first + 1), ev = texelFetch(geometry, first + 2),
       eh = texelFetch(geometry, first + 3);
  ivec3 at = slot_origin(uint(corner.w), 0) + ivec3(in_page, 0), texel_at = slot_origin(uint(ev.w), 0) + ivec3(in_page, 0);
  float height = height_at(at, -1.0);
  vec4 texel = unpack_texel(unpackUnorm4x8(imageLoad(colours, texel_at).r));
  if (height < 0.0 || texel.a < kColoured) return;
  vec3 q = corner.xyz + float(in_page.x) * eu.xyz + float(in_page.y) * ev.xyz + height * eh.xyz;
  float nearest = may_shade(q);
  float blocker = nearest > 0.0 ? blocker_value(q, nearest, 0.0) : 0.0;
  if (blocker == 0.0) return;
  // The surface's slope, by the neighbours in the tile.
  ivec2 step_of = 1 - 2 * (in_tile & 1);
  vec2 slope = vec2(height_at(at + ivec3(step_of.x, 0, 0), height), height_at(at + ivec3(0, step_of.y, 0), height)) - height;
  vec3 normal = normalize(cross(eu.xyz + float(step_of.x) * slope.x * eh.xyz, ev.xyz + float(step_of.y) * slope.y * eh.xyz));
  vec3 towards_camera = dot(normal, seen_from.xyz - q) < 0.0 ? -normal : normal;
  imageStore(colours, texel_at, pack_texel(vec4(texel.rgb / shadow_factor(q, towards_camera, blocker), texel.a)));
}
