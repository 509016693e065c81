layout(location = 0) in vec3 p_node;
uniform mat4 T_world_node;
uniform mat4 clip_from_world;
out vec3 p_world;

void main() {
  vec4 p = T_world_node * vec4(p_node, 1.0);
  p_world = p.xyz;
  gl_Position = clip_from_world * p;
}
