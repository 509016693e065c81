// Cameras in shaders: lens projection, face projection, node poses. C++ side: gl/camera_block.hpp.
struct CameraBlock {
  vec4 focal;
  vec4 radial;
  vec4 radial_denominator;
  vec4 tangential;
  vec4 size;
  vec4 face;
  vec4 tone;
};

// For gl/early_uniforms.hpp.
CameraBlock at_start(CameraBlock c) {
  return CameraBlock(min(c.focal, c.focal), min(c.radial, c.radial), min(c.radial_denominator, c.radial_denominator),
                     min(c.tangential, c.tangential), min(c.size, c.size), min(c.face, c.face), min(c.tone, c.tone));
}

// Software renderers run both sides of every branch: where a program knows its lens model and
// faces when it is built, it defines LENS_MODEL, CUBE_FACES and FACE_IS_IMAGE (gl::camera_defines).
int lens_model(const CameraBlock c) {
#ifdef LENS_MODEL
  return LENS_MODEL;
#else
  return int(c.tangential.z + 0.5);
#endif
}

bool has_cube_faces(const CameraBlock c) {
#ifdef CUBE_FACES
  return CUBE_FACES == 1;
#else
  return c.tone.w > 1.5;
#endif
}

#include "near.glsl"

// Pixel that sees p (camera frame); false where the lens model does not hold (common/lens.hpp).
bool project_lens(const CameraBlock c, vec3 p, out vec2 pixel) {
  pixel = vec2(-1e6);
  if (lens_model(c) == 2) {  // equidistant
    float rho = length(p.xy);
    float theta = atan(rho, p.z);
    if (!(theta <= c.tangential.w)) return false;
    float t2 = theta * theta;
    float r = theta * (1.0 + t2 * (c.radial.x + t2 * (c.radial.y + t2 * (c.radial.z + t2 * c.radial.w))));
    pixel = c.focal.xy * p.xy * (rho > 1e-9 ? r / rho : 1.0 / p.z) + c.focal.zw;
    return true;
  }
  if (!(p.z > 0.0)) return false;
  vec2 n = p.xy / p.z;
  if (lens_model(c) == 1) {
    float r2 = dot(n, n);
    if (!(r2 <= c.tangential.w * c.tangential.w)) return false;
    float s = (1.0 + r2 * (c.radial.x + r2 * (c.radial.y + r2 * c.radial.z))) /
              (1.0 + r2 * (c.radial_denominator.x + r2 * (c.radial_denominator.y + r2 * c.radial_denominator.z)));
    float p1 = c.tangential.x, p2 = c.tangential.y;
    n = n * s + vec2(2.0 * p1 * n.x * n.y + p2 * (r2 + 2.0 * n.x * n.x),
                     p1 * (r2 + 2.0 * n.y * n.y) + 2.0 * p2 * n.x * n.y);
  }
  pixel = c.focal.xy * n + c.focal.zw;
  return true;
}

// Place of p (camera frame) on the faces: xy in px, z the layer. inverse_z is 1 / depth along that
// face's axis. False behind the near plane or off every face.
bool project_face(const CameraBlock c, vec3 p, out vec3 place, out float inverse_z) {
  place = vec3(0.0);
  if (has_cube_faces(c)) {  // order and axes as in gl/faces.cpp
    vec3 a = abs(p);
    if (a.z >= a.x && a.z >= a.y) {
      place.z = p.z > 0.0 ? 0.0 : 2.0;
      p = p.z > 0.0 ? p : vec3(-p.x, p.y, -p.z);
    } else if (a.x >= a.y) {
      place.z = p.x > 0.0 ? 1.0 : 3.0;
      p = p.x > 0.0 ? vec3(-p.z, p.y, p.x) : vec3(p.z, p.y, -p.x);
    } else {
      place.z = p.y > 0.0 ? 4.0 : 5.0;
      p = p.y > 0.0 ? vec3(p.x, -p.z, p.y) : vec3(p.x, p.z, -p.y);
    }
  }
  inverse_z = 1.0 / p.z;
  place.xy = c.face.xy * p.xy * inverse_z + c.face.zw;
  return p.z >= kNear && all(greaterThanEqual(place.xy, vec2(-0.5))) &&
         all(lessThanEqual(place.xy, c.size.zw - vec2(0.5)));
}

// Direction in the camera frame of a direction in the frame of a cube face; inverse of the choice above.
vec3 from_cube_face(vec3 d, int face) {
  if (face == 1) return vec3(d.z, d.y, -d.x);
  if (face == 2) return vec3(-d.x, d.y, -d.z);
  if (face == 3) return vec3(-d.z, d.y, d.x);
  if (face == 4) return vec3(d.x, d.z, -d.y);
  if (face == 5) return vec3(d.x, -d.z, d.y);
  return d;
}

// Rows of T_camera_node, three texels a node; `base` is the first node of the camera.
vec3 node_to_camera(samplerBuffer poses, int node, vec3 p_node) {
  vec4 h = vec4(p_node, 1.0);
  return vec3(dot(texelFetch(poses, 3 * node), h), dot(texelFetch(poses, 3 * node + 1), h),
              dot(texelFetch(poses, 3 * node + 2), h));
}

vec3 rotate_to_camera(samplerBuffer poses, int node, vec3 v_node) {
  return vec3(dot(texelFetch(poses, 3 * node).xyz, v_node), dot(texelFetch(poses, 3 * node + 1).xyz, v_node),
              dot(texelFetch(poses, 3 * node + 2).xyz, v_node));
}
