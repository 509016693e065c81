// An image between its pixels, as views take it at each of theirs. What lies outside of the image is that of its rim.
layout(binding = 3, rgba8) readonly uniform image2D image_pixels;

// Catmull-Rom for a share of `sharp`, linear for the rest, by the inner four pixels, and outside of them those of the nearest row
// and column for all on that side, as gather_sharp_taps() (lookup.glsl) does. Where the view shows `side` pixels of the image
// for one of its own, more than kMagnified, what is added to linear weights is a share of a tent of four pixels: as wide as the
// mean of a square of `side`, whatever the place. `pixel`: centres at integers, at least 0.5 px inside.
const float kMagnified = 1.5;
vec4 sample_for_view(vec2 pixel, ivec2 size, float sharp, float side) {
  vec2 center = floor(pixel);
  vec2 f = pixel - center;
  // Not branches: software renderers would sample twice.
  bool is_mean = side > kMagnified;
  float share = is_mean ? min(0.144 * side * side, 1.0) : sharp;  // a tent's variance is a half more than that of linear weights
  vec2 w0 = is_mean ? 0.25 - 0.25 * f : f * (-0.5 + f * (1.0 - 0.5 * f));
  vec2 w1 = is_mean ? 0.75 * f - 0.5 : f * (1.0 + f * (-2.5 + 1.5 * f));
  vec2 w3 = is_mean ? 0.25 * f : f * f * (-0.5 + 0.5 * f);
  vec2 w2 = f - share * (w0 + w1 + w3);
  w0 *= share, w1 = 1.0 - f + share * w1, w3 *= share;
  vec2 w12 = w1 + w2;
  ivec2 first = ivec2(center), last = size - 1;
  ivec2 nearest = min(first + ivec2(step(0.5, f)), last), before = max(first - 1, 0), after = min(first + 2, last);
  vec4 wc = vec4(w12.x * w0.y, w0.x * w12.y, w3.x * w12.y, w12.x * w3.y);
  vec4 sum = w1.x * w1.y * imageLoad(image_pixels, first) + w2.x * w1.y * imageLoad(image_pixels, first + ivec2(1, 0)) +
             w1.x * w2.y * imageLoad(image_pixels, first + ivec2(0, 1)) + w2.x * w2.y * imageLoad(image_pixels, first + 1) +
             wc.x * imageLoad(image_pixels, ivec2(nearest.x, before.y)) + wc.y * imageLoad(image_pixels, ivec2(before.x, nearest.y)) +
             wc.z * imageLoad(image_pixels, ivec2(after.x, nearest.y)) + wc.w * imageLoad(image_pixels, ivec2(nearest.x, after.y));
  return clamp(sum / (w12.x * w12.y + wc.x + wc.y + wc.z + wc.w), 0.0, 1.0);
}
