// What the alpha of a view's picture says of a pixel: pictures/view_alpha.hpp.
const float kFromImage = 1.0, kFromEdge = 254.0 / 255.0, kFromFill = 128.0 / 255.0, kBare = 64.0 / 255.0;

// Of this surface for sure.
bool is_from_image(float alpha) {
  return alpha > 254.5 / 255.0;
}

// Of this surface or of another.
bool is_image_or_edge(float alpha) {
  return alpha > 0.99;
}

bool is_coloured(float alpha) {
  return alpha > 0.4;
}
