// One strip of a stereogram: see stereogram.hpp. With TWO_PICTURES it reads one picture and writes the other.
layout(local_size_x = 8, local_size_y = 8) in;
layout(binding = 0) uniform sampler2D links;
layout(binding = 1) uniform sampler2D pattern;
#ifdef TWO_PICTURES
layout(binding = 0, rgba8) uniform readonly image2D before;
layout(binding = 1, rgba8) uniform writeonly image2D picture;
#define BEFORE before
#else
layout(binding = 0, rgba8) uniform image2D picture;
#define BEFORE picture
#endif
uniform ivec2 size;
uniform ivec2 strip;  // first column, and the one after the last
uniform int period;   // px, of the pattern
uniform int dots;     // side of a random one, px; 0: the texture
uniform uint seed, frame;

// Good enough for dots: the finaliser of MurmurHash3 (A. Appleby, 2011).
uint mixed(uint h) {
  h ^= h >> 16;
  h *= 0x85ebca6bu;
  h ^= h >> 13;
  h *= 0xc2b2ae35u;
  return h ^ (h >> 16);
}

vec3 own(ivec2 pixel) {
  if (dots > 0) {
    uvec2 dot_at = uvec2(pixel / dots);
    uint h = mixed(dot_at.x + mixed(dot_at.y + mixed(seed + mixed(frame))));
    return vec3(h & 255u, (h >> 8) & 255u, (h >> 16) & 255u) / 255.0;
  }
  ivec2 sides = textureSize(pattern, 0);
  // Moved by parts of the golden section, so that no two frames in a row are alike.
  float phase = fract(float(frame) * 0.61803399);
  vec2 at = vec2(fract(float(pixel.x) / float(period) + phase), fract(float(pixel.y) / (float(sides.y) * float(period) / float(sides.x)) + phase));
  return textureLod(pattern, at, 0.0).rgb;
}

vec3 linked(float x, int y) {
  int first = int(floor(x));
  float t = x - float(first);
  vec3 a = imageLoad(BEFORE, ivec2(first, y)).rgb;
  if (t == 0.0) return a;
  // Catmull and Rom's cubic: what is copied again and again must not get blurred.
  vec3 b = imageLoad(BEFORE, ivec2(first + 1, y)).rgb;
  vec3 o = imageLoad(BEFORE, ivec2(max(first - 1, 0), y)).rgb, c = imageLoad(BEFORE, ivec2(first + 2, y)).rgb;
  vec4 w = 0.5 * vec4(t * (-1.0 + t * (2.0 - t)), 2.0 + t * t * (3.0 * t - 5.0), t * (1.0 + t * (4.0 - 3.0 * t)), t * t * (t - 1.0));
  return clamp(o * w.x + a * w.y + b * w.z + c * w.w, 0.0, 1.0);
}

void main() {
  ivec2 pixel = ivec2(gl_GlobalInvocationID.xy) + ivec2(strip.x, 0);
  if (pixel.x >= strip.y || pixel.y >= size.y) return;
  float s = texelFetch(links, pixel, 0).r;
  imageStore(picture, pixel, vec4(s > 0.0 ? linked(float(pixel.x) - s, pixel.y) : own(pixel), 1.0));
}
