// Charts that no camera has seen yet take the mean colour of the charts that touch them.
// One invocation a chart; run repeatedly between two buffers, it reaches one chart farther each time.
layout(local_size_x = 64) in;
layout(binding = 7) uniform usamplerBuffer neighbour_start;
layout(binding = 8) uniform usamplerBuffer neighbours;
layout(binding = 9) uniform samplerBuffer means_in;
layout(binding = 0, rgba16f) uniform writeonly imageBuffer means_out;
uniform int chart_count;
const float kHandedOn = 0.5;  // alpha; 1: from its own texels

void main() {
  int index = int(gl_GlobalInvocationID.x);
  if (index >= chart_count) return;
  vec4 own = texelFetch(means_in, index);
  if (own.a < 1.0) {
    vec4 sum = vec4(0.0);
    int end = int(texelFetch(neighbour_start, index + 1).r);
    for (int i = int(texelFetch(neighbour_start, index).r); i < end; ++i) {
      vec4 c = texelFetch(means_in, int(texelFetch(neighbours, i).r));
      // Colours from cameras count more than those handed on.
      if (c.a > 0.0) sum += (c.a == 1.0 ? 4.0 : 1.0) * vec4(c.rgb, 1.0);
    }
    if (sum.a > 0.0) own = vec4(sum.rgb / sum.a, kHandedOn);
  }
  imageStore(means_out, index, own);
}
