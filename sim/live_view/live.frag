// Light towards the eye, stored as sqrt(light / 2) so that 8 bits serve dark and bright.
layout(binding = 0) uniform sampler2D picture;  // square roots of linear light
layout(binding = 1) uniform samplerBuffer irradiance;
in vec2 at;
in vec2 on_grid;
flat in ivec2 grid;
layout(location = 0) out vec4 colour;
#ifdef GLOSS
in vec3 p_world;
in vec3 n_world;
uniform vec4 eye;          // world; w: gloss
uniform vec4 lamp_centre;  // w: size
uniform vec4 lamp_normal;
uniform vec4 lamp_right;
uniform vec4 lamp_up;

float edge(float x) {
  float s = lamp_centre.w;
  return smoothstep(0.0, 1.0, (0.62 * s - abs(x)) / (0.24 * s));
}

// The lamp's mirror image, as in sim/lamp.cpp.
float mirrored() {
  vec3 n = normalize(n_world), to_eye = normalize(eye.xyz - p_world);
  vec3 d = 2.0 * dot(n, to_eye) * n - to_eye;
  float towards = -dot(lamp_normal.xyz, d);
  if (towards <= 0.05) return 0.0;
  vec3 hit = p_world + d * (dot(lamp_normal.xyz, p_world - lamp_centre.xyz) / towards) - lamp_centre.xyz;
  return edge(dot(hit, lamp_right.xyz)) * edge(dot(hit, lamp_up.xyz));
}
#endif

// Weighs the three samples around, as LightMap::at does.
vec3 irradiance_here() {
  int n = grid.y;
  vec2 place = clamp(on_grid, 0.0, float(n));  // a pixel's middle may lie outside of what covers a part of it
  ivec2 cell = min(ivec2(place), n - 1);
  cell.y = min(cell.y, n - 1 - cell.x);
  vec2 f = place - vec2(cell);
  int here = grid.x + cell.x + cell.y * (n + 1) - cell.y * (cell.y - 1) / 2, right = here + 1,
      up = here + n + 1 - cell.y;
  bool is_far = f.x + f.y > 1.0 && cell.x + cell.y + 2 <= n;
  vec3 w = is_far ? vec3(1.0 - f.yx, f.x + f.y - 1.0) : vec3(f, 1.0 - f.x - f.y);
  return w.x * texelFetch(irradiance, right).rgb + w.y * texelFetch(irradiance, up).rgb +
         w.z * texelFetch(irradiance, is_far ? up + 1 : here).rgb;
}

void main() {
  vec3 c = texture(picture, at).rgb;
  vec3 seen = c * c * max(irradiance_here(), vec3(0.0)) * 0.318309886;  // a matt surface sends 1 / pi to the eye
#ifdef GLOSS
  seen += vec3(10.0 * eye.w * mirrored());
#endif
  colour = vec4(sqrt(0.5 * seen), 1.0);
}
