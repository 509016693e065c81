// What a lens takes away towards the image's rim (exposure.hpp): log of what it leaves at a pixel. `tone`: CameraBlock::tone.
float log_vignetting(vec4 tone, vec2 pixel, vec2 size) {
  vec2 half_size = 0.5 * (size - 1.0);
  vec2 offset = pixel - half_size;
  float r2 = dot(offset, offset) / dot(half_size, half_size);
  return r2 * (tone.y + r2 * tone.z);
}

// Factor on `pixel`'s value that gives it back.
float without_vignetting(vec4 tone, vec2 pixel, vec2 size) {
  return exp(-log_vignetting(tone, pixel, size));
}
