#include "sim/lab.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <stdexcept>

#include "sim/arm_covers.hpp"
#include "sim/lab_builder.hpp"
#include "sim/lab_furniture.hpp"
#include "sim/lab_prints.hpp"
#include "sim/lab_task.hpp"
#include "sim/things.hpp"

namespace foresight::sim {
namespace {

using Eigen::Vector3f;

constexpr float kMugRadius = 0.040f, kCanRadius = 0.034f, kBottleRadius = 0.036f;
constexpr double kTableY = 0.14;  // the arm's stand takes the place on the right
constexpr double kMugHeight = 0.095, kCanHeight = 0.110, kBottleHeight = 0.235;

Pose placed(double x, double y, double z, double yaw_deg) {
  Pose pose = Pose::Identity();
  pose.translate(Eigen::Vector3d(x, y, z));
  pose.rotate(Eigen::AngleAxisd(yaw_deg * std::numbers::pi / 180, Eigen::Vector3d::UnitZ()));
  return pose;
}

void add_room(LabBuilder& b) {
  const int wall = b.material([](double t, unsigned s) { return prints::plain(1.6, 1.6, t, 0xb9c3c1, 0.07, s); }, 3);
  const int floor = b.material([](double t, unsigned s) { return prints::floor_tiles(t, s); }, 3);
  const int base = b.plain(0x6a5b4c);
  Facets& room = b.part("room", Pose::Identity(), 0.03);
  for (int i = -3; i < 3; ++i) {
    const float left = 1.0f * static_cast<float>(i + 1);
    for (int j = 0; j < 2; ++j)
      add_rectangle(room, {0.62f, left, 1.65f - 1.2f * static_cast<float>(j)}, {0, -1.0f, 0}, {0, 0, -1.2f}, wall);
    for (int j = 0; j < 2; ++j)
      add_rectangle(room, {0.62f - 1.4f * static_cast<float>(j), left, -0.75f}, {0, -1.0f, 0}, {-1.4f, 0, 0}, floor);
  }
  add_box(room, {0.612f, 0, -0.75f}, {0.016f, 6, 0.08f}, 0.003f, BoxPaint::all(base));
}

void add_wall_things(LabBuilder& b) {
  const int frame = b.plain(0x2c2f33, 0.05), white = b.plain(0xe6e3da, 0.04), steel = b.plain(0x8d939a, 0.06);
  const int poster = b.material([](double t, unsigned s) { return prints::poster(t, s); });
  const int pegs = b.material([](double t, unsigned s) { return prints::pegboard(t, s); });
  BoxPaint paint = BoxPaint::all(frame);
  paint.front = poster;
  add_box(b.part("poster", placed(0.607, 0.36, 0.10, 0), 0.012), {0, 0, 0}, {0.024f, 0.62f, 0.44f}, 0, paint);
  paint = BoxPaint::all(b.plain(0xb09a72));
  paint.front = pegs;
  add_box(b.part("pegboard", placed(0.609, 1.13, 0.10, 0), 0.012), {0, 0, 0}, {0.020f, 0.70f, 0.44f}, 0, paint);

  const int board =
      b.material([](double t, unsigned s) { return prints::wood(0.90, 0.19, t, 0xd9b98c, 0xa2774a, 0.30, s); });
  Facets& shelf = b.part("shelf", placed(0.52, -0.52, 0.26, 0), 0.010);
  add_box(shelf, {0, 0, 0}, {0.19f, 0.90f, 0.018f}, 0.002f, BoxPaint::all(board));
  for (float y : {-0.34f, 0.34f}) add_box(shelf, {0.06f, y, -0.10f}, {0.06f, 0.02f, 0.10f}, 0, BoxPaint::all(steel));
  constexpr std::uint32_t kColours[] = {0x7a2f2b, 0x23516b, 0x4c6b3a, 0xb98a2e, 0x3b3f63, 0x8a4a63, 0x2f6f6b, 0x5b4a3c};
  Facets& books = b.part("books", placed(0.51, -0.16, 0.278, 0), 0.010);
  float y = 0;
  for (unsigned i = 0; i < 8; ++i) {
    const float thick = 0.024f + 0.006f * static_cast<float>((i * 5) % 4);
    const float tall = 0.170f + 0.012f * static_cast<float>((i * 3) % 5),
                deep = 0.120f + 0.006f * static_cast<float>(i % 3);
    BoxPaint book = BoxPaint::all(b.plain(kColours[i], 0.05));
    book.top = white;
    book.front = b.material([=](double t, unsigned) { return prints::book_spine(thick, tall, t, kColours[i], i); });
    add_box(books, {0, y - thick / 2, 0}, {deep, thick, tall}, 0, book);
    y -= thick + 0.0012f;
  }
  const int label = b.material([](double t, unsigned s) { return prints::cardboard(0.26, 0.13, t, true, s); });
  BoxPaint crate =
      BoxPaint::all(b.material([](double t, unsigned s) { return prints::cardboard(0.15, 0.26, t, false, s); }));
  crate.front = label;
  add_box(b.part("shelf_box", placed(0.52, -0.70, 0.278, 4), 0.010), {0, 0, 0}, {0.15f, 0.26f, 0.13f}, 0.002f, crate);
}

void add_table(LabBuilder& b) {
  const int top = b.material(
      [](double t, unsigned s) { return prints::wood(1.60, 0.96, t, 0xd2a878, 0x8f6137, 0.12, s); }, 1, 0.012f);
  const int leg = b.plain(0x3a3d42, 0.06);
  Facets& table = b.part("table", placed(0, kTableY, -0.03, 0), 0.007);
  BoxPaint paint = BoxPaint::all(top);
  add_box(table, {0, 0, 0}, {0.92f, 1.28f, 0.03f}, 0.004f, paint);
  for (float x : {-0.40f, 0.40f})
    for (float y : {-0.58f, 0.58f}) add_box(table, {x, y, -0.72f}, {0.05f, 0.05f, 0.72f}, 0, BoxPaint::all(leg));

  BoxPaint mat = BoxPaint::all(b.plain(0x1b5a4a));
  mat.top = b.material([](double t, unsigned s) { return prints::cutting_mat(t, s); }, 0.8);
  add_box(b.part("mat", placed(-0.19, 0.02, 0, 1.5), 0.006), {0, 0, 0}, {0.42f, 0.60f, 0.002f}, 0, mat);
  BoxPaint paper = BoxPaint::all(b.plain(0xe8e6de));
  paper.top = b.material([](double t, unsigned s) { return prints::graph_paper(t, s); }, 0.8);
  add_box(b.part("paper", placed(-0.21, 0.50, 0, 14), 0.006), {0, 0, 0}, {0.297f, 0.21f, 0.0012f}, 0, paper);
}

void add_boxes(LabBuilder& b) {
  const int tape = b.material([](double t, unsigned s) { return prints::cardboard(0.30, 0.21, t, false, s); });
  BoxPaint carton = BoxPaint::all(tape);
  carton.front = b.material([](double t, unsigned s) { return prints::cardboard(0.30, 0.19, t, true, s); });
  carton.left = carton.right = carton.edge =
      b.material([](double t, unsigned s) { return prints::plain(0.21, 0.19, t, 0xb0855a, 0.12, s); });
  add_box(b.part("carton", placed(0.20, 0.30, 0, -17), 0.007), {0, 0, 0}, {0.21f, 0.30f, 0.19f}, 0.002f, carton);

  BoxPaint product = BoxPaint::all(b.plain(0x16335c, 0.05));
  product.front = product.back =
      b.material([](double t, unsigned s) { return prints::product_front(t, s); }, 0.8, 0.02f);
  product.left = product.right =
      b.material([](double t, unsigned s) { return prints::product_side(t, s); }, 0.8, 0.02f);
  add_box(b.part("servo_kit", placed(0.13, -0.01, 0, 13), 0.007), {0, 0, 0}, {0.09f, 0.12f, 0.21f}, 0.0015f, product);

  const auto block = [&](const char* name, const Pose& pose, float size, std::uint32_t colour, char letter) {
    const int face = b.material([=](double t, unsigned s) { return prints::letter_block(size, t, colour, letter, s); });
    BoxPaint paint = BoxPaint::all(face);
    add_box(b.part(name, pose, 0.006), {0, 0, 0}, {size, size, size}, 0, paint);
  };
  block("block_a", placed(0.02, 0.50, 0, 24), 0.055f, 0xc8432f, 'A');
  block("block_b", placed(0.03, 0.565, 0, -12), 0.055f, 0x2f5f9e, 'B');
  block("block_c", placed(0.027, 0.530, 0.055, 40), 0.055f, 0x2b7f78, 'C');
  block("block_d", placed(0.20, 0.33, 0.19, -30), 0.070f, 0xb98a2e, 'F');
}

void add_turned_things(LabBuilder& b) {
  const auto around = [](float radius) { return 2 * std::numbers::pi * radius; };
  const int glaze = b.material(
      [=](double t, unsigned s) { return prints::mug_wrap(t, around(kMugRadius), kMugHeight, s); }, 0.8, 0.05f);
  const int inside = b.plain(0xefe9dc, 0.03, 0.04f), blue = b.plain(0x2b6f8f, 0.03, 0.05f);
  const int tea = b.plain(0x4a2713, 0.02, 0.05f);
  Facets& mug = b.part("mug", placed(-0.32, -0.36, 0, -118), 0.012);
  const float r = kMugRadius, h = kMugHeight;
  add_turned(mug,
             {{0, 0, blue},
              {r - 0.004f, 0, blue},
              {r, 0.004f, glaze},
              {r, 0.05f, glaze},
              {r, h - 0.003f, blue},
              {r - 0.002f, h, inside},
              {r - 0.004f, h - 0.003f, inside},
              {r - 0.004f, h - 0.016f, tea},
              {0, h - 0.016f, tea}},
             16, r, h);
  add_handle(mug, {r - 0.003f, 0, 0.5f * h}, 0.026f, 0.0055f, blue);

  const int wrap = b.material(
      [=](double t, unsigned s) { return prints::can_wrap(t, around(kCanRadius), kCanHeight, s); }, 0.8, 0.03f);
  const int tin = b.plain(0xb4b8bd, 0.05, 0.04f);
  const float c = kCanRadius, ch = kCanHeight;
  add_turned(b.part("can", placed(0.23, -0.36, 0, 150), 0.012),
             {{0, 0, tin},
              {c - 0.002f, 0, tin},
              {c, 0.002f, wrap},
              {c, ch - 0.002f, tin},
              {c - 0.002f, ch, tin},
              {c - 0.004f, ch - 0.004f, tin},
              {0, ch - 0.004f, tin}},
             16, c, ch);

  const int bottle =
      b.material([=](double t, unsigned s) { return prints::bottle_wrap(t, around(kBottleRadius), kBottleHeight, s); },
                 0.8, 0.05f);
  const float q = kBottleRadius, qh = kBottleHeight;
  add_turned(b.part("bottle", placed(0.22, -0.20, 0, 105), 0.012),
             {{0, 0, bottle},
              {q - 0.005f, 0, bottle},
              {q - 0.001f, 0.002f, bottle},
              {q, 0.007f, bottle},
              {q, 0.150f, bottle},
              {q - 0.008f, 0.176f, bottle},
              {q - 0.018f, 0.191f, bottle},
              {q - 0.023f, 0.209f, bottle},
              {q - 0.019f, 0.209f, bottle},
              {q - 0.019f, qh - 0.002f, bottle},
              {q - 0.021f, qh, bottle},
              {0, qh, bottle}},
             16, q, qh);

  const int yellow = b.plain(0xe2ab2c, 0.05, 0.02f), tip = b.plain(0xd8bd92, 0.05), lead = b.plain(0x26282c, 0.05);
  Pose lying = placed(-0.16, -0.36, 0.0035, 35);
  lying.rotate(Eigen::AngleAxisd(std::numbers::pi / 2, Eigen::Vector3d::UnitY()));
  add_turned(b.part("pencil", lying, 0.012),
             {{0, 0, lead}, {0.004f, 0, yellow}, {0.004f, 0.150f, tip}, {0.001f, 0.166f, lead}, {0, 0.170f, lead}}, 6,
             0.004f, 0.17f);
}

void add_all_but_robot(LabBuilder& b) {
  add_room(b);
  add_wall_things(b);
  add_table(b);
  add_boxes(b);
  add_turned_things(b);
  add_furniture(b);
}

// Banded, so that one sees it roll.
void add_ball(LabBuilder& b) {
  const int colours[] = {b.plain(0xd9542b, 0.04, 0.03f), b.plain(0xf0ece0, 0.04, 0.03f)};
  constexpr int kBands = 16;
  std::vector<ProfilePoint> profile;
  for (int i = 0; i <= kBands; ++i) {
    const float angle = std::numbers::pi_v<float> * static_cast<float>(i) / kBands;
    const bool pole = i == 0 || i == kBands;
    profile.push_back({pole ? 0 : kBallRadius * std::sin(angle), -kBallRadius * std::cos(angle), colours[i / 4 % 2]});
  }
  add_turned(b.part("ball", placed(-0.30, 0.02, 0.002 + kBallRadius, 0), 0.01, true), profile, 24, kBallRadius,
             kBallRadius);
}

}  // namespace

LabState Lab::at_rest() const {
  LabState state;
  for (const Part& part : parts) state.push_back(part.T_world_part);
  return state;
}

int Lab::find(const std::string& name) const {
  for (std::size_t i = 0; i < parts.size(); ++i)
    if (parts[i].name == name) return static_cast<int>(i);
  throw std::out_of_range("the lab has no part " + name);
}

Lab make_lab(double texel, unsigned seed, bool with_ball, std::optional<unsigned> task) {
  LabBuilder builder(texel, seed);
  add_all_but_robot(builder);
  const int arm = static_cast<int>(builder.part_count());
  add_arm(builder);
  if (with_ball) add_ball(builder);
  if (task) add_task_things(builder, *task);
  Lab lab = builder.finish();
  lab.arm = arm;
  return lab;
}

Lab make_lab_with(const RobotScene& things, bool furniture, double texel, unsigned seed, std::optional<unsigned> task) {
  LabBuilder builder(texel, seed);
  if (furniture) add_all_but_robot(builder);
  const int first = static_cast<int>(builder.part_count());
  add_things(builder, things);
  if (furniture) add_ball(builder);
  if (furniture && task) add_task_things(builder, *task);
  Lab lab = builder.finish();
  lab.arm = -1;
  lab.things = first;
  return lab;
}

Mesh mesh_of(const Part& part) {
  Mesh mesh;
  std::map<std::array<float, 3>, std::uint32_t> known;
  for (const Facet& facet : part.facets) {
    std::array<std::uint32_t, 3> triangle{};
    for (int k = 0; k < 3; ++k) {
      const Vector3f& p = facet.corners[k].p;
      const auto [at, added] =
          known.try_emplace({p.x(), p.y(), p.z()}, static_cast<std::uint32_t>(mesh.vertices.size()));
      if (added) mesh.vertices.push_back(p);
      triangle[k] = at->second;
    }
    mesh.triangles.push_back(triangle);
  }
  return mesh;
}

std::vector<Node> nodes_of(const Lab& lab, const LabState& T_world_part) {
  std::vector<Node> nodes;
  for (std::size_t i = 0; i < lab.parts.size(); ++i)
    nodes.push_back({lab.parts[i].name, mesh_of(lab.parts[i]), -1, T_world_part[i]});
  return nodes;
}

}  // namespace foresight::sim
