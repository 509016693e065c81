// The depth once more, where a colour is drawn into.
layout(location = 0) out float depth;

void main() {
  depth = gl_FragCoord.z;
}
