// The four corners of a flat print in a pinhole face, as live.vert has it.
uniform mat4 T_face_print;
uniform vec4 face;       // fx fy cx cy, px
uniform vec2 face_size;  // px
uniform vec2 half_size;  // metres
uniform float nearer;    // factor on the depth, which grows towards the eye
out vec2 at;

void main() {
  at = vec2(gl_VertexID >> 1, gl_VertexID & 1);  // down before right: counter-clockwise seen from the front
  vec3 p = (T_face_print * vec4((2.0 * at - 1.0) * half_size, 0.0, 1.0)).xyz;
  vec2 pixel_z = face.xy * p.xy + (face.zw + 0.5) * p.z;
  gl_Position = vec4(2.0 * pixel_z / face_size - p.z, 0.01 * nearer, p.z);
}
