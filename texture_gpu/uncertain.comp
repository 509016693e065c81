// Marks the pixels beside a depth discontinuity that a small registration error would paint with the
// other surface: of the far one those within the margin (thesis, case 3 in section 5.1.1), of the near
// one the outermost, unless it is thin. Marks differ: most of what an outermost pixel shows is its own surface.
//
//   near surface __p       p = q: of near_edges.comp; its surface is thought to go on
//                    |margin|
//                    |..p.p.p_______ far surface: behind it by more than the tolerance
//
// One invocation a pixel q.
#define INVOCATIONS_PER_ITEM 1
#include "camera.glsl"
#include "depth_slope.glsl"
layout(local_size_x = 64) in;
#include "work_item.glsl"
layout(binding = 0, r32ui) uniform uimage2DArray marked_depth;  // bits of near / z, the two highest of which are free
const uint kUncertain = 1u << 31, kFarSide = 1u << 30;  // seen.glsl; a pixel may get both, by several invocations
uniform float margin;  // px

// 1/z along a line through q, which is in its middle: all that is asked of it.
const int kThin = 4, kMiddle = kThin + 1, kLine = 2 * kMiddle + 1;

// Slope of 1/z with which the surface of q goes on along the line, `way` 1 or -1: its own, as far as it is seen there, so
// that what lies beyond a crease is no far side. Where it ends, that of the plane before; none of a
// curved surface, which would sink below what lies behind it, or of one that is a few pixels wide.
float slope_ahead(float line[kLine], int way) {
  float center = line[kMiddle], bent = depth_tolerance * center * center;
  float a1 = line[kMiddle + way], a2 = line[kMiddle + 2 * way], b1 = line[kMiddle - way], b2 = line[kMiddle - 2 * way];
  float s = center - b1;
  bool is_plane = b1 > 0.0 && b2 > 0.0 && abs(b2 - 2.0 * b1 + center) <= min(bent, 0.25 * abs(s));
  bool goes_on = a1 > 0.0 && a2 > 0.0 && abs(a2 - 2.0 * a1 + center) <= bent;
  return goes_on ? a1 - center : is_plane ? s : 0.0;
}

bool ends_at(float line[kLine], int at, int way) {
  return ends_between(line[at - way], line[at], line[at + way], line[at + 2 * way]);
}

// Does the surface of q end within kThin pixels against `way` too? All of a cable or a rim is as uncertain as its
// outline: it keeps its colours rather than having none.
bool is_thin(float line[kLine], int way) {
  bool thin = false;
  for (int k = 0; k < kThin; ++k) thin = ends_at(line, kMiddle - k * way, -way) || thin;
  return thin;
}

void main() {
  uint item;
  if (!next_work(item)) return;
  ivec2 q = ivec2(item & 0x3fffu, (item >> 14) & 0x3fffu);
  int layer = int(item >> 28);
  float across[kLine], down[kLine];
  for (int i = 0; i < kLine; ++i) across[i] = inverse_z(q + ivec2(i - kMiddle, 0), layer);
  for (int i = 0; i < kLine; ++i) down[i] = i == kMiddle ? across[i] : inverse_z(q + ivec2(0, i - kMiddle), layer);
  float center = across[kMiddle];
  vec2 ahead = vec2(slope_ahead(across, 1), slope_ahead(down, 1));
  vec2 back = vec2(slope_ahead(across, -1), slope_ahead(down, -1));
  bvec4 ended = bvec4(ends_at(across, kMiddle, 1), ends_at(down, kMiddle, 1), ends_at(across, kMiddle, -1),
                      ends_at(down, kMiddle, -1));
  bool hides = false;
  float radius = margin + 0.5;
  int reach = int(radius);
  for (int y = -reach; y <= reach; ++y) {
    int in_row = int(sqrt(radius * radius - float(y * y)));
    for (int x = -in_row; x <= in_row; ++x) {
      // Only to the sides on which the surface ends: of all its pixels, the one nearest to a pixel
      // beyond has no other one of them before it.
      bool beyond = (abs(x) >= abs(y) && (x > 0 ? ended.x : x < 0 && ended.z)) ||
                    (abs(y) >= abs(x) && (y > 0 ? ended.y : y < 0 && ended.w));
      if (!beyond) continue;
      vec2 offset = vec2(x, y);
      float far = inverse_z(q + ivec2(x, y), layer);
      // Never closer than at its edge: what comes closer beyond it is not seen there.
      float near = min(center, center + dot(ahead, max(offset, 0.0)) + dot(back, max(-offset, 0.0)));
      if (far <= 0.0 || !steps_back(near, far)) continue;
      imageAtomicOr(marked_depth, ivec3(q + ivec2(x, y), layer), kUncertain | kFarSide);
      hides = true;
    }
  }
  bool thin = (ended.x && is_thin(across, 1)) || (ended.y && is_thin(down, 1)) || (ended.z && is_thin(across, -1)) ||
              (ended.w && is_thin(down, -1));
  if (hides && !thin) imageAtomicOr(marked_depth, ivec3(q, layer), kUncertain);
}
