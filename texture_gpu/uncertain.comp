// Marks the pixels beside a depth discontinuity that a small registration error would paint with the
// other surface: of the far one those within the margin (thesis, case 3 in section 5.1.1), of the near
// one the outermost, unless it is thin.
//
//   near surface __p       p = q: of near_edges.comp; its surface is thought to go on
//                    |margin|
//                    |..p.p.p_______ far surface: behind it by more than the tolerance
//
// One invocation a pixel q.
#define ITEMS_PER_GROUP 64
#include "camera.glsl"
#include "depth_slope.glsl"
#include "work_item.glsl"
layout(local_size_x = 64) in;
layout(binding = 0, r8) uniform writeonly image2DArray uncertain;
uniform float margin;  // px

// Slope of 1/z with which the surface of q goes on along `step`: its own, as far as it is seen there, so
// that what lies beyond a crease is no far side. Where it ends, that of the plane before; none of a
// curved surface, which would sink below what lies behind it, or of one that is a few pixels wide.
float slope_ahead(ivec2 q, ivec2 step, int layer, float center) {
  float bent = depth_tolerance * center * center;
  float a1 = inverse_z(q + step, layer), a2 = inverse_z(q + 2 * step, layer);
  if (a1 > 0.0 && a2 > 0.0 && abs(a2 - 2.0 * a1 + center) <= bent) return a1 - center;
  float b1 = inverse_z(q - step, layer), b2 = inverse_z(q - 2 * step, layer);
  float s = center - b1;
  bool is_plane = b1 > 0.0 && b2 > 0.0 && abs(b2 - 2.0 * b1 + center) <= min(bent, 0.25 * abs(s));
  return is_plane ? s : 0.0;
}

// Does the surface of q, which ends there, end within kThin pixels towards the other side too? All of a
// cable or a rim is as uncertain as its outline: it keeps its colours rather than having none.
const int kThin = 4;
bool is_thin(ivec2 q, bvec4 ended, int layer) {
  for (int k = 0; k < kThin; ++k) {
    ivec2 x = ivec2(k, 0), y = ivec2(0, k);
    if ((ended.x && ends(q - x, inverse_z(q - x, layer), ivec2(-1, 0), layer)) ||
        (ended.y && ends(q - y, inverse_z(q - y, layer), ivec2(0, -1), layer)) ||
        (ended.z && ends(q + x, inverse_z(q + x, layer), ivec2(1, 0), layer)) ||
        (ended.w && ends(q + y, inverse_z(q + y, layer), ivec2(0, 1), layer)))
      return true;
  }
  return false;
}

void main() {
  uint item;
  if (!next_work(item)) return;
  ivec2 q = ivec2(item & 0x3fffu, (item >> 14) & 0x3fffu);
  int layer = int(item >> 28);
  float center = inverse_z(q, layer);
  vec2 ahead = vec2(slope_ahead(q, ivec2(1, 0), layer, center), slope_ahead(q, ivec2(0, 1), layer, center));
  vec2 back = vec2(slope_ahead(q, ivec2(-1, 0), layer, center), slope_ahead(q, ivec2(0, -1), layer, center));
  bvec4 ended = ends_around(q, center, layer);
  bool hides = false;
  int reach = int(ceil(margin));
  float limit = (margin + 0.5) * (margin + 0.5);
  for (int y = -reach; y <= reach; ++y)
    for (int x = -reach; x <= reach; ++x) {
      // Only to the sides on which the surface ends: of all its pixels, the one nearest to a pixel
      // beyond has no other one of them before it.
      bool beyond = (abs(x) >= abs(y) && (x > 0 ? ended.x : x < 0 && ended.z)) ||
                    (abs(y) >= abs(x) && (y > 0 ? ended.y : y < 0 && ended.w));
      vec2 offset = vec2(x, y);
      if (!beyond || dot(offset, offset) > limit) continue;
      float far = inverse_z(q + ivec2(x, y), layer);
      // Never closer than at its edge: what comes closer beyond it is not seen there.
      float near = min(center, center + dot(ahead, max(offset, 0.0)) + dot(back, max(-offset, 0.0)));
      if (far <= 0.0 || !steps_back(near, far)) continue;
      imageStore(uncertain, ivec3(q + ivec2(x, y), layer), vec4(1.0));
      hides = true;
    }
  if (hides && !is_thin(q, ended, layer)) imageStore(uncertain, ivec3(q, layer), vec4(1.0));
}
