// A line as two triangles of its width: each corner knows both ends and on which side it lies.
layout(location = 0) in vec3 p_world;
layout(location = 1) in vec3 other_world;
layout(location = 2) in vec4 colour;
layout(location = 3) in vec2 side_width;  // -1 or 1; px
uniform mat4 clip_from_world;
uniform vec2 size;      // of the picture, px
uniform float opacity;
uniform float nearest;  // clip w in front of which nothing is
uniform float nearer;   // factor on the depth: before the surface on which a line lies
out vec4 tint;

vec4 in_front(vec4 p, vec4 other) {
  return p.w >= nearest || other.w <= nearest ? p : mix(p, other, (nearest - p.w) / (other.w - p.w));
}

void main() {
  vec4 a = clip_from_world * vec4(p_world, 1.0), b = clip_from_world * vec4(other_world, 1.0);
  vec4 p = in_front(a, b), q = in_front(b, a);
  vec2 along = (q.xy / q.w - p.xy / p.w) * size;
  float len = length(along);
  along = len > 1e-6 ? along / len : vec2(1.0, 0.0);
  p.xy += side_width.x * side_width.y * vec2(-along.y, along.x) / size * p.w;
  p.z *= nearer;
  gl_Position = p;
  tint = vec4(colour.rgb, colour.a * opacity);
}
