// For each triangle of a view: the way from its picture to that in an image. What is seen along `ray` of a plane m . p = 1 lies
// at p = ray / (m . ray), and at q = H ray / (m . ray) in the image's camera, H = R + T m^T (Hartley and Zisserman, 2nd ed.,
// equation 13.2). Three texels each: the rows of H, in their last columns m.
layout(local_size_x = 64) in;
layout(binding = 0) uniform samplerBuffer view_nodes;    // T_node_camera
layout(binding = 2) uniform samplerBuffer triangles;     // surface_records.hpp
layout(binding = 16) uniform samplerBuffer image_nodes;  // T_image_node
layout(binding = 3, std430) writeonly buffer Homographies { vec4 homographies[]; };
uniform int triangle_count;

void main() {
  int triangle = int(gl_GlobalInvocationID.x);
  if (triangle >= triangle_count) return;
  vec4 plane = texelFetch(triangles, 2 * triangle);
  int node = int(texelFetch(triangles, 2 * triangle + 1).y);
  vec4 x = texelFetch(view_nodes, 3 * node), y = texelFetch(view_nodes, 3 * node + 1), z = texelFetch(view_nodes, 3 * node + 2);
  vec3 eye = vec3(x.w, y.w, z.w);
  vec3 normal = plane.x * x.xyz + plane.y * y.xyz + plane.z * z.xyz;
  float distance = plane.w - dot(plane.xyz, eye);
  vec3 m = normal / (abs(distance) > 1e-9 ? distance : 1e-9);
  for (int row = 0; row < 3; ++row) {
    vec4 r = texelFetch(image_nodes, 3 * node + row);
    vec3 rotated = r.x * x.xyz + r.y * y.xyz + r.z * z.xyz;
    homographies[3 * triangle + row] = vec4(rotated + (dot(r.xyz, eye) + r.w) * m, m[row]);
  }
}
