// A camera's image between its pixels. Where a shadow was taken out of it (unshade.comp), colours are scaled by alpha.

// Five bilinear taps: Catmull-Rom for a share of `sharp`, linear for the rest. `pixel`: centres at integers.
vec4 sample_sharply(sampler2D image, vec2 pixel, vec2 size, float sharp) {
  vec2 center = floor(pixel);
  vec2 f = pixel - center;
  vec2 w0 = sharp * f * (-0.5 + f * (1.0 - 0.5 * f)), w1 = mix(1.0 - f, 1.0 + f * f * (-2.5 + 1.5 * f), sharp),
       w2 = mix(f, f * (0.5 + f * (2.0 - 1.5 * f)), sharp), w3 = sharp * f * f * (-0.5 + 0.5 * f);
  vec2 w12 = w1 + w2, at12 = center + w2 / w12;
  vec4 wc = vec4(w12.x * w0.y, w0.x * w12.y, w3.x * w12.y, w12.x * w3.y);
  float wm = w12.x * w12.y;
  vec4 sum = wm * textureLod(image, (at12 + 0.5) / size, 0.0) +
             wc.x * textureLod(image, (vec2(at12.x, center.y - 1.0) + 0.5) / size, 0.0) +
             wc.y * textureLod(image, (vec2(center.x - 1.0, at12.y) + 0.5) / size, 0.0) +
             wc.z * textureLod(image, (vec2(center.x + 2.0, at12.y) + 0.5) / size, 0.0) +
             wc.w * textureLod(image, (vec2(at12.x, center.y + 2.0) + 0.5) / size, 0.0);
  return clamp(sum / (wm + wc.x + wc.y + wc.z + wc.w), 0.0, 1.0);
}

vec3 unscaled(vec4 colour) {
  return colour.rgb / max(colour.a, 0.05);
}
