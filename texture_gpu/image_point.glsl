// Surface points of camera 0's pixels, by its depth. Needs camera.glsl, seen.glsl and a lens's rays.
layout(binding = 7) uniform sampler2D rays;

// kNear / z between the pixels of a face; exact on planes. 0 where one of them shows no model.
float near_over_z_at(vec3 place) {
  ivec2 base = ivec2(floor(place.xy)), last = textureSize(depth0, 0).xy - 1;
  vec2 f = place.xy - vec2(base);
  vec4 near = vec4(0.0);
  for (int i = 0; i < 4; ++i)
    near[i] = unmarked(texelFetch(depth0, ivec3(clamp(base + ivec2(i & 1, i >> 1), ivec2(0), last), int(place.z)), 0).r);
  float between = mix(mix(near.x, near.y, f.x), mix(near.z, near.w, f.x), f.y);
  return all(greaterThan(near, vec4(0.0))) ? between : 0.0;
}

// Where the ray of a pixel meets the model; false where no image can tell.
bool find_point(ivec2 pixel, out vec3 p) {
  vec3 ray = vec3((vec2(pixel) - cameras[0].focal.zw) / cameras[0].focal.xy, 1.0);
  bool has_ray = true;
  if (lens_model(cameras[0]) != 0) {
    vec4 r = texelFetch(rays, pixel, 0);
    ray = r.xyz;
    has_ray = r.w > 0.5;
  }
  vec3 place;
  float inverse_z;
  if (!has_ray || !project_face(cameras[0], ray, place, inverse_z)) return false;
  ivec3 at = ivec3(ivec2(floor(place.xy + 0.5)), int(place.z));
  float near_over_z = near_over_z_at(place);
  p = ray * (kNear / max(near_over_z, 1e-9) * inverse_z);
  return near_over_z > 0.0 && texelFetch(depth0, at, 0).r > 0.0;
}
