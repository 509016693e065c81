// As raster.vert, for a level on the way to the next coarser one.
layout(location = 0) in vec3 p_node;
layout(location = 1) in vec3 p_coarser;
uniform mat4 T_face_node;
uniform vec4 face;        // fx fy cx cy, px
uniform vec2 face_size;   // px
uniform int first_going;  // vertices from this one on move
uniform float moved;      // share of their way

void main() {
  vec3 at = gl_VertexID < first_going ? p_node : mix(p_node, p_coarser, moved);
  vec3 p = (T_face_node * vec4(at, 1.0)).xyz;
  vec2 pixel_z = face.xy * p.xy + (face.zw + 0.5) * p.z;  // pixel coordinates times z
  gl_Position = vec4(2.0 * pixel_z / face_size - p.z, 0.01, p.z);
}
