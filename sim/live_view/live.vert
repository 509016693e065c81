// One pinhole face, as in gl/raster.vert, with what the light needs.
layout(location = 0) in vec3 p_node;
layout(location = 1) in vec3 n_node;
layout(location = 2) in vec2 uv;  // metres on the picture
layout(location = 3) in ivec2 facet_grid;  // see LabBuffers
uniform mat4 T_face_node;
uniform mat4 T_world_node;
uniform vec4 face;       // fx fy cx cy, px
uniform vec2 face_size;  // px
uniform vec2 uv_scale;   // pictures per metre
out vec2 at;
out vec2 on_grid;  // steps towards corners 1 and 2
flat out ivec2 grid;
#ifdef GLOSS
out vec3 p_world;
out vec3 n_world;
#endif

void main() {
  vec3 p = (T_face_node * vec4(p_node, 1.0)).xyz;
  vec2 pixel_z = face.xy * p.xy + (face.zw + 0.5) * p.z;
  gl_Position = vec4(2.0 * pixel_z / face_size - p.z, 0.01, p.z);
  at = uv * uv_scale;
  int corner = gl_VertexID % 3;
  on_grid = float(facet_grid.y) * vec2(corner == 1, corner == 2);
  grid = facet_grid;
#ifdef GLOSS
  p_world = (T_world_node * vec4(p_node, 1.0)).xyz;
  n_world = mat3(T_world_node) * n_node;
#endif
}
