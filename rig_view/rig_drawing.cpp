#include "rig_view/rig_drawing.hpp"

#include <algorithm>
#include <cmath>

namespace foresight {
namespace {

using Eigen::Vector3d;

const Colour kText{0.10f, 0.12f, 0.15f, 1};
const Colour kGrid{0.55f, 0.58f, 0.62f, 0.35f};
const Colour kNow{0.85f, 0.10f, 0.45f, 1};

/// Lengths of marks follow the robot's size.
double mark_size(const RigBody& body) {
  Eigen::AlignedBox3d box;
  const auto poses = body.nodes().poses([](std::string_view) { return std::nullopt; });
  for (std::size_t i = 0; i < body.nodes().nodes().size(); ++i)
    if (body.nodes().moves(i)) box.extend(poses[i].translation());
  const double reach = box.isEmpty() ? 1 : box.diagonal().norm();
  return std::clamp(0.11 * reach, 0.02, 0.12);
}

void draw_guards(const PlacedRig& placed, Drawing& out) {
  const Colour usual = style_of(Layer::guards).colour;
  for (const GuardedLink& link : placed.guards)
    out.capsule(link.body.a, link.body.b, link.body.radius,
                with_opacity(is_too_close(placed, link.name) ? kBadColour : usual, 0.20f));
}

void draw_surroundings(const Surroundings& around, const Layers& layers, Drawing& out) {
  if (shows(layers, Layer::workspace) && !around.workspace.isEmpty()) {
    const Colour colour = style_of(Layer::workspace).colour;
    out.box(around.workspace, colour, with_opacity(colour, 0), 1.6f);
    if (shows(layers, Layer::names)) out.word(around.workspace.max(), "workspace", colour);
  }
  if (!shows(layers, Layer::obstacles)) return;
  const Colour colour = style_of(Layer::obstacles).colour;
  for (const Obstacle& obstacle : around.obstacles) {
    out.box(obstacle.box, colour, with_opacity(colour, 0.35f));
    const Vector3d kept = Vector3d::Constant(around.clearance);
    out.box({obstacle.box.min() - kept, obstacle.box.max() + kept}, with_opacity(kClearanceColour, 0.8f),
            with_opacity(kClearanceColour, 0), 1);
    if (shows(layers, Layer::names) && !obstacle.name.empty()) out.word(obstacle.box.center(), obstacle.name, colour);
  }
}

/// The range as an arc with its ends and the zero marked, and a hand that points where the joint stands.
void draw_turning(const PlacedJoint& joint, const DriveConfig& drive, double now, double radius, bool bold,
                  Drawing& out) {
  const Colour colour = style_of(Layer::limits).colour;
  const auto at = [&](double angle, double r) -> Vector3d {
    return joint.place + r * (Eigen::AngleAxisd(angle, joint.axis) * joint.zero);
  };
  const float width = bold ? 4.0f : 2.2f;
  out.arc(joint.place, joint.axis, joint.zero, radius, drive.min_position, drive.max_position, colour, width);
  for (const double end : {drive.min_position, drive.max_position})
    out.line(at(end, 0.82 * radius), at(end, 1.18 * radius), colour, width);
  out.line(at(0, 0.94 * radius), at(0, 1.06 * radius), kText, 1.2f);
  out.line(joint.place, at(now, radius), kNow, bold ? 3.5f : 2);
}

void draw_sliding(const PlacedJoint& joint, const DriveConfig& drive, double now, double size, bool bold,
                  Drawing& out) {
  const Colour colour = style_of(Layer::limits).colour;
  const auto at = [&](double way, double beside) -> Vector3d {
    return joint.place + way * joint.axis + beside * joint.zero;
  };
  const float width = bold ? 4.0f : 2.2f;
  const double tick = 0.2 * size;
  out.line(at(drive.min_position, size), at(drive.max_position, size), colour, width);
  for (const double end : {drive.min_position, drive.max_position})
    out.line(at(end, size - tick), at(end, size + tick), colour, width);
  out.line(at(now, 0), at(now, size + tick), kNow, bold ? 3.5f : 2);
}

void draw_limits(const RigBody& body, const PlacedRig& placed, std::span<const double> positions, double size,
                 int selected, Drawing& out) {
  std::size_t number = 0;
  for (const PlacedJoint& joint : placed.joints) {
    const RigJoint& of = body.rig().joints[joint.joint];
    const bool bold = static_cast<int>(joint.joint) == selected;
    const double now = positions[joint.joint];
    if (joint.slides)
      draw_sliding(joint, of.drive, now, 0.6 * size, bold, out);
    else  // neighbours of different size, as their axes may meet
      draw_turning(joint, of.drive, now, size * (1 + 0.16 * static_cast<double>(number++ % 3)), bold, out);
  }
}

void draw_frames(const RigBody& body, const PlacedRig& placed, const Layers& layers, double size, Drawing& out) {
  const auto& nodes = body.nodes().nodes();
  out.axes(Pose::Identity(), 1.5 * size, 2.5f);
  if (shows(layers, Layer::names)) out.word(Vector3d::Zero(), "world", kText);
  if (!body.rig().robot) return;
  for (const Node& link : body.rig().robot->links) {
    const auto at = static_cast<std::size_t>(std::ranges::find(nodes, link.name, &Node::name) - nodes.begin());
    out.axes(placed.T_world_node[at], 0.6 * size);
    if (shows(layers, Layer::names)) out.word(placed.T_world_node[at].translation(), link.name, kText);
  }
}

/// Its edges to `depth` metres, through the lens: a straight line of the world may be a bent one of the picture.
void draw_camera(const PlacedCamera& camera, double depth, bool named, Drawing& out) {
  const Colour colour = style_of(Layer::cameras).colour;
  const double w = camera.lens.width() - 1, h = camera.lens.height() - 1;
  constexpr int kSteps = 6;  // of each edge
  const Eigen::Vector2d corners[] = {{0, 0}, {w, 0}, {w, h}, {0, h}};
  const Vector3d eye = camera.T_world_camera.translation();
  std::vector<Vector3d> rim;
  for (std::size_t k = 0; k < 4; ++k)
    for (int i = 0; i < kSteps; ++i) {
      const double share = static_cast<double>(i) / kSteps;
      const auto ray = camera.lens.unproject((1 - share) * corners[k] + share * corners[(k + 1) % 4]);
      if (!ray || ray->z() <= 0) return;  // a lens that sees half of all has no such pyramid
      rim.push_back(camera.T_world_camera * Vector3d(*ray * (depth / ray->z())));
    }
  for (std::size_t i = 0; i < rim.size(); ++i) {
    out.line(rim[i], rim[(i + 1) % rim.size()], colour);
    out.triangle(eye, rim[i], rim[(i + 1) % rim.size()], with_opacity(colour, 0.07f));
    if (i % kSteps == 0) out.line(eye, rim[i], colour);
  }
  out.axes(camera.T_world_camera, 0.3 * depth);
  if (named) out.word(eye, "camera " + camera.name, colour);
}

}  // namespace

const LayerStyle& style_of(Layer layer) {
  static const LayerStyle styles[kLayers] = {
      {"links", {0.62f, 0.65f, 0.69f, 1}},        {"guarded by the gate", {0.10f, 0.45f, 0.80f, 1}},
      {"obstacles", {0.55f, 0.33f, 0.12f, 1}},    {"workspace", {0.13f, 0.55f, 0.30f, 1}},
      {"joint limits", {0.45f, 0.25f, 0.70f, 1}}, {"frames: x y z", {0.75f, 0.15f, 0.15f, 1}},
      {"cameras", {0.00f, 0.50f, 0.55f, 1}},      {"names", {0.10f, 0.12f, 0.15f, 1}},
  };
  return styles[static_cast<std::size_t>(layer)];
}

bool is_too_close(const PlacedRig& placed, const std::string& link) {
  return std::ranges::any_of(placed.couples, [&](const NearCouple& couple) {
    return couple.margin_m < 0 && couple.text.find("'" + link + "'") != std::string::npos;
  });
}

Drawing draw_rig(const RigBody& body, const PlacedRig& placed, std::span<const double> positions, const Layers& layers,
                 int selected) {
  Drawing out;
  const double size = mark_size(body);
  Pose floor = Pose::Identity();
  const Eigen::AlignedBox3d& space = body.rig().surroundings.workspace;
  floor.translation().z() = space.isEmpty() ? body.rig().T_world_robot.translation().z() : space.min().z();
  out.grid(floor, 0.1, 15, kGrid);
  if (shows(layers, Layer::guards)) draw_guards(placed, out);
  draw_surroundings(body.rig().surroundings, layers, out);
  if (shows(layers, Layer::limits)) draw_limits(body, placed, positions, size, selected, out);
  if (shows(layers, Layer::frames)) draw_frames(body, placed, layers, size, out);
  if (shows(layers, Layer::cameras))
    for (const PlacedCamera& camera : placed.cameras)
      draw_camera(camera, 0.25, shows(layers, Layer::names) && camera.name == "left", out);
  return out;
}

}  // namespace foresight
