// Four classes of pixels, told apart by hatching, not by colour alone: plain, thin lines, dense lines, checked.
const vec3 kClasses[4] = vec3[](vec3(0.35, 0.75, 0.95), vec3(0.95, 0.85, 0.35), vec3(0.90, 0.40, 0.20), vec3(0.75, 0.35, 0.75));

bool is_hatched(ivec2 pixel, int level) {
  if (level == 1) return ((pixel.x + pixel.y) % 12) == 0;
  if (level == 2) return ((pixel.x + pixel.y) % 5) < 2;
  return level == 3 && (((pixel.x >> 3) ^ (pixel.y >> 3)) & 1) == 1;
}

/// What was shown lends its brightness.
vec3 class_colour(ivec2 pixel, int level, float grey) {
  return (0.35 + 0.65 * grey) * (is_hatched(pixel, level) ? 0.45 : 1.0) * kClasses[level];
}
