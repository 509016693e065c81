// A pixel's share of all light that its samples see: means of light, as a sensor takes them.
layout(binding = 0) uniform sampler2DMS samples;  // sqrt(light / 2)
layout(location = 0) out vec4 colour;

void main() {
  vec3 sum = vec3(0.0);
  for (int k = 0; k < SAMPLES; ++k) {
    vec3 s = texelFetch(samples, ivec2(gl_FragCoord.xy), k).rgb;
    sum += s * s;
  }
  colour = vec4(sqrt(sum / float(SAMPLES)), 1.0);
}
