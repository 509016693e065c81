// From the faces through the lens onto the sensor: two pixels of YUYV (BT.601, 16 .. 235) per fragment.
layout(binding = 0) uniform sampler2DArray faces;  // sqrt(light / 2)
layout(binding = 1) uniform sampler2D places;      // per pixel: place on the face (0 .. 1), its layer (-1: none), falloff
uniform vec2 texel;       // of a face
uniform float spread;     // px
uniform float gain;
uniform vec2 noise;       // variances: of reading; of shot noise per light
uniform uint number;      // of the image, mixed with the seed
layout(location = 0) out vec4 yuyv;

uint hashed(uint x) {  // Jarzynski and Olano, "Hash Functions for GPU Rendering", JCGT 9(3), 2020: pcg
  x = x * 747796405u + 2891336453u;
  x = ((x >> ((x >> 28u) + 4u)) ^ x) * 277803737u;
  return (x >> 22u) ^ x;
}

// Nearly normal: the sum of four even numbers.
float normal_number(uint key) {
  vec4 u = unpackUnorm4x8(hashed(key));
  return (dot(u, vec4(1.0)) - 2.0) * 1.7253;
}

vec3 tap(vec3 at, vec2 offset) {
  vec3 s = texture(faces, vec3(at.xy + offset * texel, at.z)).rgb;
  return s * s;
}

vec3 pixel(ivec2 p) {
  vec4 place = texelFetch(places, p, 0);
  if (place.z < -0.5) return vec3(0.0);
  vec2 d = vec2(spread, -spread);
  vec3 light = tap(place.xyz, d.xx) + tap(place.xyz, d.xy) + tap(place.xyz, d.yx) + tap(place.xyz, d.yy);
  light *= 0.5 * gain * place.w;
#ifdef NOISE
  uint key = hashed(uint(p.x) + 8192u * uint(p.y)) ^ number;
  vec3 n = vec3(normal_number(key), normal_number(key + 0x9e3779b9u), normal_number(key + 0x3c6ef372u));
  light = max(vec3(0.0), light + sqrt(noise.x + noise.y * light) * n);
#endif
  // The response of sim/sensor.cpp: a soft shoulder, then sRGB.
  light = mix(light, 0.55 + 0.45 * (1.0 - exp((0.55 - light) / 0.45)), greaterThan(light, vec3(0.55)));
  return mix(12.92 * light, 1.055 * pow(light, vec3(1.0 / 2.4)) - 0.055, greaterThan(light, vec3(0.0031308)));
}

void main() {
  ivec2 p = ivec2(gl_FragCoord.xy) * ivec2(2, 1);
  vec3 a = pixel(p), b = pixel(p + ivec2(1, 0)), m = 0.5 * (a + b);
  const vec3 y = vec3(65.481, 128.553, 24.966), u = vec3(-37.797, -74.203, 112.0), v = vec3(112.0, -93.786, -18.214);
  yuyv = (vec4(dot(y, a), dot(u, m), dot(y, b), dot(v, m)) + vec4(16.0, 128.0, 16.0, 128.0)) / 255.0;
}
