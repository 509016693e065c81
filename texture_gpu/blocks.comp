// Nearest and farthest model depth of each 4x4 block of a face, as 1/z. Preselects where the exact
// test for uncertain edges must run, and hides pages that lie behind everything.
#include "camera.glsl"
layout(local_size_x = 8, local_size_y = 8) in;
layout(binding = 0) uniform sampler2DArray depth;
layout(binding = 0, rg32f) uniform writeonly image2DArray blocks;  // x: least 1/z over pixels with model, y: largest
layout(std140, binding = 0) uniform Camera { CameraBlock camera; };
uniform ivec2 face_size;

// False where the image surely shows nothing of the block: faces are rectangles around all that
// the lens sees, and reach far beyond it in their corners.
bool in_image(vec2 place, int layer) {
  if (lens_model(camera) == 0) return true;
  vec3 ray = vec3((place - camera.face.zw) / camera.face.xy, 1.0);
  if (has_cube_faces(camera)) ray = from_cube_face(ray, layer);
  vec2 pixel;
  float slack = 8.0 * max(camera.focal.x / camera.face.x, camera.focal.y / camera.face.y);
  return project_lens(camera, ray, pixel) && all(greaterThan(pixel, vec2(-slack))) &&
         all(lessThan(pixel, camera.size.xy + slack));
}

void main() {
  ivec3 block = ivec3(gl_GlobalInvocationID);
  if (any(greaterThanEqual(block.xy * 4, face_size))) return;
  float low = 1e30, high = 0.0;
  bool hole = false;
  for (int i = 0; i < 4; ++i) {
    // Four pixels around a corner at a time; beyond the face its border repeats.
    vec2 corner = vec2(block.xy * 4 + 2 * ivec2(i & 1, i >> 1)) + 1.0;
    vec4 d = textureGather(depth, vec3(corner / vec2(face_size), block.z));
    vec4 known = mix(d, vec4(1e30), equal(d, vec4(0.0)));
    low = min(low, min(min(known.x, known.y), min(known.z, known.w)));
    high = max(high, max(max(d.x, d.y), max(d.z, d.w)));
    hole = hole || any(equal(d, vec4(0.0)));
  }
  // A negative low tells that the block also shows no model: it hides nothing behind it.
  low = (hole ? -low : low) / kNear;
  if (!in_image(vec2(block.xy * 4) + 1.5, block.z)) low = 1e30;  // as if hidden behind something
  imageStore(blocks, block, vec4(low, high / kNear, 0.0, 0.0));
}
