// Brightness of a colour as it is stored, with the weights of ITU-R BT.601.
float luma_of(vec3 rgb) {
  return dot(rgb, vec3(0.299, 0.587, 0.114));
}
