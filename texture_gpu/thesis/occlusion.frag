// Compares with the depth of the whole scene: 1 visible, 0 occluded. The thesis draws twice with
// opposite depth tests; reading the depth does both at once.
layout(binding = 0) uniform sampler2DArray scene_depth;  // near / z
uniform float tolerance;                                 // share of the depth
layout(location = 0) out vec4 colour;

void main() {
  float nearest = texelFetch(scene_depth, ivec3(ivec2(gl_FragCoord.xy), 0), 0).r;
  colour = vec4(0.0, 0.0, 0.0, gl_FragCoord.z * (1.0 + tolerance) >= nearest ? 1.0 : 0.0);
}
