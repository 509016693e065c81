// A texel of the normalised texture looks up its pixel (sections 4.3.2, 4.5.3).
// Define POLYGON_ONLY: 0 the whole bounding box; 1 only the polygon's inside.
layout(binding = 0) uniform sampler2D perspective;
uniform mat4 to_pixel;  // (i, j, 1) to (pixel * z, z); pixel centres at integers
uniform vec4 box;       // x, y, width, height of the bounding box, px
layout(location = 0) out vec4 colour;
#if POLYGON_ONLY
uniform vec2 corners[64];  // counter-clockwise from outside, texels
uniform int corner_count;

bool inside(vec2 p) {
  bool all_left = true, all_right = true;
  for (int i = 0; i < corner_count; ++i) {
    vec2 a = corners[i], along = corners[(i + 1) % corner_count] - a, to = p - a;
    float turn = along.x * to.y - along.y * to.x;
    all_left = all_left && turn >= 0.0;
    all_right = all_right && turn <= 0.0;
  }
  return all_left || all_right;
}
#endif

void main() {
  vec3 h = (to_pixel * vec4(gl_FragCoord.xy, 1.0, 0.0)).xyz;
  vec2 in_box = h.xy / h.z - box.xy + 0.5;  // texels of the perspective texture
  bool covered = h.z > 0.0 && all(greaterThanEqual(in_box, vec2(0.0))) && all(lessThanEqual(in_box, box.zw));
  vec2 at = clamp(in_box, vec2(0.5), box.zw - 0.5);
  vec4 sampled = textureLod(perspective, at / vec2(textureSize(perspective, 0)), 0.0);
#if POLYGON_ONLY
  // Filters over the border mix what lies outside into the texels along it.
  covered = covered && inside(gl_FragCoord.xy);
  bool visible = covered && sampled.a > 0.5;
#else
  bool visible = covered && sampled.a > 31.0 / 32.0 + 0.0015;  // 247/255 is outside
#endif
  colour = vec4(sampled.rgb, visible ? 1.0 : 0.0);
}
