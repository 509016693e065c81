// A polygon of the thesis' pipeline; conventions as in raster.vert.
layout(location = 0) in vec3 p_node;
uniform mat4 T_face_node;
uniform vec4 face;       // fx fy cx cy, px
uniform vec2 face_size;  // px
uniform vec4 to_s, to_t;
out vec2 st;

void main() {
  vec3 p = (T_face_node * vec4(p_node, 1.0)).xyz;
  vec2 pixel_z = face.xy * p.xy + (face.zw + 0.5) * p.z;
  gl_Position = vec4(2.0 * pixel_z / face_size - p.z, 0.01, p.z);
  st = vec2(dot(to_s, vec4(p_node, 1.0)), dot(to_t, vec4(p_node, 1.0)));
}
