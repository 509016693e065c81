// Charts that no camera has seen yet take the mean colour of the charts that touch them.
// One invocation a chart; run repeatedly between two buffers, it reaches one chart farther each time.
layout(local_size_x = 64) in;
layout(binding = 7) uniform usamplerBuffer neighbour_start;
layout(binding = 8) uniform usamplerBuffer neighbours;
layout(binding = 9) uniform usamplerBuffer means_in;
layout(binding = 0, r32ui) uniform writeonly uimageBuffer means_out;
uniform int chart_count;
const float kHandedOn = 128.0 / 255.0;

void main() {
  int index = int(gl_GlobalInvocationID.x);
  if (index >= chart_count) return;
  uint own = texelFetch(means_in, index).r;
  if ((own >> 24) != 255u) {  // alpha 255: from its own texels
    vec4 sum = vec4(0.0);
    int end = int(texelFetch(neighbour_start, index + 1).r);
    for (int i = int(texelFetch(neighbour_start, index).r); i < end; ++i) {
      vec4 c = unpackUnorm4x8(texelFetch(means_in, int(texelFetch(neighbours, i).r)).r);
      // Colours from cameras count more than those handed on.
      if (c.a > 0.0) sum += (c.a == 1.0 ? 4.0 : 1.0) * vec4(c.rgb, 1.0);
    }
    if (sum.a > 0.0) own = packUnorm4x8(vec4(sum.rgb / sum.a, kHandedOn));
  }
  imageStore(means_out, index, uvec4(own));
}
