// A flat picture on a stereogram, again and again along its rows.
layout(local_size_x = 8, local_size_y = 8) in;
layout(binding = 0) uniform sampler2D floater;  // RGBA8, straight alpha
layout(binding = 0, rgba8) uniform image2D picture;
uniform ivec2 size;
uniform vec2 middle;       // where one of its copies is
uniform float separation;  // of two copies, px

void main() {
  ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
  if (any(greaterThanEqual(pixel, size))) return;
  ivec2 sides = textureSize(floater, 0);
  vec2 from = vec2(pixel) - middle;
  from.x -= separation * round(from.x / separation);
  ivec2 at = ivec2(floor(from + 0.5 * vec2(sides)));
  if (any(lessThan(at, ivec2(0))) || any(greaterThanEqual(at, sides))) return;
  vec4 over = texelFetch(floater, at, 0);
  imageStore(picture, pixel, vec4(mix(imageLoad(picture, pixel).rgb, over.rgb, over.a), 1.0));
}
