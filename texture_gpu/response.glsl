// The bend of a camera's response, both ways; see response_bend.hpp.
uniform float bend;

vec3 light_of(vec3 value) {
  vec3 v2 = value * value;
  return value + value * (bend * v2 * v2 * v2);
}

// White at any light from light_of(1) on. Newton, from above.
vec3 value_of(vec3 light) {
  vec3 v = min(light, vec3(1.0));
  for (int i = 0; i < 4; ++i) {
    vec3 v2 = v * v;
    vec3 t = bend * v2 * v2 * v2;
    v -= (v * (1.0 + t) - light) / (1.0 + 7.0 * t);
  }
  return min(v, vec3(1.0));
}

float brightest_light() {
  return 1.0 + bend;
}
