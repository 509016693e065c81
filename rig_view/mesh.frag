// Flat faces, lit from the eye and a little from above: form without a lamp to place.
in vec3 p_world;
uniform vec4 colour;
uniform vec4 to_eye;  // world, unit
layout(location = 0) out vec4 seen;

void main() {
  vec3 n = normalize(cross(dFdx(p_world), dFdy(p_world)));
  float facing = abs(dot(n, to_eye.xyz));
  float above = 0.5 + 0.5 * (dot(n, to_eye.xyz) < 0.0 ? -n.z : n.z);
  seen = vec4(colour.rgb * (0.34 + 0.48 * facing + 0.22 * above), colour.a);
}
