// Light towards the eye, stored as sqrt(light / 2) so that 8 bits serve dark and bright.
layout(binding = 0) uniform sampler2D picture;  // square roots of linear light
in vec2 at;
in vec3 light;
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

void main() {
  vec3 c = texture(picture, at).rgb;
  vec3 seen = c * c * light;
#ifdef GLOSS
  seen += vec3(10.0 * eye.w * mirrored());
#endif
  colour = vec4(sqrt(0.5 * seen), 1.0);
}
