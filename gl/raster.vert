// One pinhole face. Clip space is the face's pixel grid, row 0 at the top; depth is near / z, so
// that it is linear in 1/z and a plane stays a plane.
layout(location = 0) in vec3 p_node;
uniform mat4 T_face_node;
uniform vec4 face;       // fx fy cx cy, px
uniform vec2 face_size;  // px

void main() {
  vec3 p = (T_face_node * vec4(p_node, 1.0)).xyz;
  vec2 pixel_z = face.xy * p.xy + (face.zw + 0.5) * p.z;  // pixel coordinates times z
  gl_Position = vec4(2.0 * pixel_z / face_size - p.z, 0.01, p.z);
}
