// The plane of the triangle that a face shows at a place: unit normal n in the node's frame, and n p of its points. Needs
// `triangles`. Defines: LEVELS 1 where the view may show a coarser level there: then it was drawn with the surface.
#if LEVELS
layout(binding = 7) uniform sampler2DArray planes;
vec4 seen_plane(ivec3 at, uint surface) {
  return texelFetch(planes, at, 0);
}
#else
vec4 seen_plane(ivec3 at, uint surface) {
  return texelFetch(triangles, 2 * int(surface - 1u));
}
#endif
