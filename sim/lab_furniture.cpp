#include "sim/lab_furniture.hpp"

#include <numbers>

#include "sim/lab_prints.hpp"

namespace foresight::sim {
namespace {

Pose at(double x, double y, double z, double yaw_deg = 0) {
  Pose pose = Pose::Identity();
  pose.translate(Eigen::Vector3d(x, y, z));
  pose.rotate(Eigen::AngleAxisd(yaw_deg * std::numbers::pi / 180, Eigen::Vector3d::UnitZ()));
  return pose;
}

// Left of the table, along the wall.
void add_cabinet(LabBuilder& b) {
  const int body = b.plain(0x4c5a66, 0.05), front = b.plain(0x7d8d9a, 0.05), steel = b.plain(0xa9afb5, 0.05);
  const int top =
      b.material([](double t, unsigned s) { return prints::wood(0.60, 1.30, t, 0xc9a478, 0x94683d, 0.30, s); }, 2);
  Facets& cabinet = b.part("cabinet", at(0.38, 1.75, -0.75), 0.04);
  add_box(cabinet, {0, 0, 0}, {0.42f, 1.20f, 0.70f}, 0.004f, BoxPaint::all(body));
  add_box(cabinet, {0, 0, 0.70f}, {0.46f, 1.24f, 0.03f}, 0.004f, BoxPaint::all(top));
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 2; ++j) {
      const float z = 0.04f + 0.22f * static_cast<float>(i), y = 0.30f - 0.60f * static_cast<float>(j);
      add_box(cabinet, {-0.215f, y, z}, {0.012f, 0.56f, 0.20f}, 0.003f, BoxPaint::all(front));
      add_box(cabinet, {-0.232f, y, z + 0.14f}, {0.016f, 0.14f, 0.014f}, 0, BoxPaint::all(steel));
    }
  const int lid = b.plain(0x3a3d42, 0.05);
  constexpr std::uint32_t kJars[] = {0xb7492f, 0x2f6f8f, 0xd0a23a, 0x4c7a4a};
  for (int i = 0; i < 4; ++i) {
    const int jar = b.plain(kJars[i], 0.04, 0.04f);
    add_turned(b.part("jar_" + std::to_string(i + 1), at(0.44, 1.28 + 0.14 * i, -0.02), 0.02),
               {{0, 0, jar},
                {0.046f, 0, jar},
                {0.050f, 0.006f, jar},
                {0.050f, 0.100f, jar},
                {0.040f, 0.116f, lid},
                {0.042f, 0.136f, lid},
                {0, 0.136f, lid}},
               14, 0.05f, 0.136f);
  }
  const int label = b.material([](double t, unsigned s) { return prints::cardboard(0.34, 0.18, t, true, s); });
  const int side = b.material([](double t, unsigned s) { return prints::cardboard(0.24, 0.34, t, false, s); });
  BoxPaint crate = BoxPaint::all(side);
  crate.front = label;
  add_box(b.part("crate", at(0.40, 2.08, -0.02, 9), 0.02), {0, 0, 0}, {0.24f, 0.34f, 0.18f}, 0.002f, crate);
}

void add_stool(LabBuilder& b) {
  const int seat = b.plain(0x8a3d35, 0.05, 0.02f), steel = b.plain(0xa9afb5, 0.05, 0.03f);
  Facets& stool = b.part("stool", at(-0.75, 1.30, -0.75, 20), 0.03);
  add_turned(stool,
             {{0, 0.44f, steel},
              {0.16f, 0.44f, seat},
              {0.185f, 0.46f, seat},
              {0.185f, 0.49f, seat},
              {0.16f, 0.505f, seat},
              {0, 0.505f, seat}},
             18, 0.185f, 0.505f);
  for (float x : {-0.11f, 0.11f})
    for (float y : {-0.11f, 0.11f}) add_box(stool, {x, y, 0}, {0.022f, 0.022f, 0.445f}, 0.002f, BoxPaint::all(steel));
}

void add_bin(LabBuilder& b) {
  const int plastic = b.plain(0x37474f, 0.05, 0.02f), inside = b.plain(0x232b30, 0.05);
  add_turned(b.part("bin", at(0.28, -1.25, -0.75), 0.03),
             {{0, 0, plastic},
              {0.11f, 0, plastic},
              {0.14f, 0.30f, plastic},
              {0.148f, 0.31f, plastic},
              {0.148f, 0.325f, plastic},
              {0.134f, 0.325f, inside},
              {0.105f, 0.02f, inside},
              {0, 0.02f, inside}},
             18, 0.14f, 0.325f);
}

}  // namespace

void add_furniture(LabBuilder& builder) {
  add_cabinet(builder);
  add_stool(builder);
  add_bin(builder);
}

}  // namespace foresight::sim
