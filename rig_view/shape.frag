in vec4 tint;
layout(location = 0) out vec4 seen;

void main() {
  seen = tint;
}
