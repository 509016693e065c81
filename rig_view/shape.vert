layout(location = 0) in vec3 p_world;
layout(location = 1) in vec4 colour;
uniform mat4 clip_from_world;
out vec4 tint;

void main() {
  gl_Position = clip_from_world * vec4(p_world, 1.0);
  tint = colour;
}
