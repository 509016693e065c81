// Who looks on sees what the operator sees as if lit by a lamp at his eye, that eye's view as a wire pyramid, and the
// newest images as panels before the cameras that took them. Over a view of the observer, in place.
#include "camera.glsl"
layout(local_size_x = 8, local_size_y = 8) in;
layout(std140, binding = 0) uniform Observer { CameraBlock observer; };  // a pinhole: its face is its picture
layout(std140, binding = 1) uniform Others { CameraBlock others[3]; };  // the operator, the panels' cameras
layout(binding = 0) uniform sampler2DArray observer_depth;
layout(binding = 1) uniform sampler2DArray operator_depth;
layout(binding = 2) uniform sampler2D panel0;
layout(binding = 3) uniform sampler2D panel1;
layout(binding = 4) uniform samplerBuffer wires;  // two texels each: x, y in px, 1 / z, colour
layout(binding = 0, rgba8) uniform image2D picture;
uniform mat4 T_operator_observer, T_panel0_observer, T_panel1_observer;
uniform int panel_count, wire_count;
uniform float panel_z;  // m from the camera

const vec3 kLamp = vec3(1.12, 1.04, 0.78);
const float kUnlit = 0.42;
const vec3 kWires[2] = vec3[](vec3(1.0, 0.8, 0.25), vec3(0.4, 0.85, 1.0));

bool is_lit(vec3 p) {
  vec2 pixel;
  if (!project_lens(others[0], p, pixel)) return false;
  if (any(lessThan(pixel, vec2(-0.5))) || any(greaterThan(pixel, others[0].size.xy - 0.5))) return false;
  vec3 place;
  float inverse_z;
  if (!project_face(others[0], p, place, inverse_z)) return false;
  float seen = texelFetch(operator_depth, ivec3(ivec2(floor(place.xy + 0.5)), int(place.z)), 0).r;
  return kNear * inverse_z > 0.985 * seen;  // not behind what he sees there
}

// 1 / z of the panel where the ray meets it; 0: it does not.
float panel_at(int i, mat4 T_panel_observer, vec3 ray, out vec2 uv) {
  uv = vec2(0.0);
  vec3 o = T_panel_observer[3].xyz, d = (T_panel_observer * vec4(ray, 0.0)).xyz;
  float t = (panel_z - o.z) / (abs(d.z) > 1e-9 ? d.z : 1e-9);
  vec2 pixel;
  if (t < kNear || !project_lens(others[1 + i], o + t * d, pixel)) return 0.0;
  uv = (pixel + 0.5) / others[1 + i].size.xy;
  return all(greaterThanEqual(uv, vec2(0.0))) && all(lessThanEqual(uv, vec2(1.0))) ? 1.0 / t : 0.0;
}

void main() {
  ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
  if (any(greaterThanEqual(pixel, ivec2(observer.size.xy)))) return;
  vec3 ray = vec3((vec2(pixel) - observer.focal.zw) / observer.focal.xy, 1.0);
  float nearest = texelFetch(observer_depth, ivec3(pixel, 0), 0).r / kNear;  // 1 / z; 0: nothing
  vec3 colour = vec3(0.10, 0.11, 0.13);
  if (nearest > 0.0) {
    bool lit = is_lit((T_operator_observer * vec4(ray / nearest, 1.0)).xyz);
    colour = imageLoad(picture, pixel).rgb * (lit ? kLamp : vec3(kUnlit));
  }
  for (int i = 0; i < panel_count; ++i) {
    vec2 uv;
    float inverse_z = panel_at(i, i == 0 ? T_panel0_observer : T_panel1_observer, ray, uv);
    if (inverse_z <= nearest) continue;
    nearest = inverse_z;
    colour = i == 0 ? texelFetch(panel0, ivec2(uv * vec2(textureSize(panel0, 0) - 1) + 0.5), 0).rgb
                    : texelFetch(panel1, ivec2(uv * vec2(textureSize(panel1, 0) - 1) + 0.5), 0).rgb;
  }
  for (int i = 0; i < wire_count; ++i) {
    vec4 a = texelFetch(wires, 2 * i), b = texelFetch(wires, 2 * i + 1);
    vec2 along = b.xy - a.xy, to = vec2(pixel) - a.xy;
    float s = clamp(dot(to, along) / max(dot(along, along), 1e-9), 0.0, 1.0);
    float cover = clamp(1.8 - length(to - s * along), 0.0, 1.0);
    bool hidden = mix(a.z, b.z, s) < 0.99 * nearest;
    colour = mix(colour, kWires[int(a.w)], cover * (hidden ? 0.25 : 1.0));
  }
  imageStore(picture, pixel, vec4(min(colour, vec3(1.0)), 1.0));
}
