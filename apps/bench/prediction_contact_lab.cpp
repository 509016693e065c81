#include "apps/bench/prediction_contact_lab.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include "scene/primitives.hpp"
#include "scene/simplify.hpp"
#include "sim/arm.hpp"
#include "sim/lab.hpp"

namespace foresight {
namespace {

constexpr float kBall = 0.03f;  // m, radius of what is carried

UrdfRobot lab_arm(const sim::Lab& lab) {
  UrdfRobot robot;
  robot.name = "arm";
  const auto mesh = [&](std::size_t link) { return mesh_of(lab.parts[static_cast<std::size_t>(lab.arm) + link]); };
  robot.links.push_back({sim::kArmStand, mesh(0), -1, Pose::Identity()});
  for (std::size_t i = 0; i < sim::arm_joints().size(); ++i) {
    const sim::ArmJoint& own = sim::arm_joints()[i];
    UrdfJoint joint;
    joint.name = own.name;
    joint.kind = own.slides ? UrdfJoint::Kind::sliding : UrdfJoint::Kind::rotating;
    joint.child = static_cast<int>(i + 1);
    joint.T_parent_joint.translation() = own.xyz;
    joint.axis = own.axis;
    joint.lower = own.lower;
    joint.upper = own.upper;
    joint.velocity = own.slides ? 0.1 : 2;
    if (own.mimics) joint.mimic = UrdfJoint::Mimic{static_cast<int>(i - 1)};
    robot.joints.push_back(joint);
    robot.links.push_back({own.child, mesh(i + 1), own.parent, joint.T_parent_joint});
  }
  return robot;
}

// Longest edges first are halved, with the triangles on both sides, until there are enough.
Mesh split(Mesh mesh, std::size_t triangles) {
  while (!mesh.triangles.empty() && mesh.triangles.size() < triangles) {
    std::array<std::uint32_t, 2> edge{};
    float longest = -1;
    for (const auto& t : mesh.triangles)
      for (std::size_t i = 0; i < 3; ++i) {
        const std::uint32_t a = std::min(t[i], t[(i + 1) % 3]), b = std::max(t[i], t[(i + 1) % 3]);
        if (const float length = (mesh.vertices[a] - mesh.vertices[b]).norm(); length > longest) {
          longest = length;
          edge = {a, b};
        }
      }
    const auto middle = static_cast<std::uint32_t>(mesh.vertices.size());
    mesh.vertices.push_back(0.5f * (mesh.vertices[edge[0]] + mesh.vertices[edge[1]]));
    const std::size_t before = mesh.triangles.size();
    for (std::size_t k = 0; k < before; ++k)
      for (std::size_t i = 0; i < 3; ++i) {
        const auto t = mesh.triangles[k];
        const std::uint32_t a = t[i], b = t[(i + 1) % 3], c = t[(i + 2) % 3];
        if (std::min(a, b) != edge[0] || std::max(a, b) != edge[1]) continue;
        mesh.triangles[k] = {a, middle, c};
        mesh.triangles.push_back({middle, b, c});
        break;
      }
  }
  return mesh;
}

Mesh with_triangles(Mesh mesh, std::size_t triangles) {
  if (triangles == 0) return mesh;
  Mesh fewer = mesh;
  for (double tolerance = 1e-4; fewer.triangles.size() > triangles + triangles / 4 && tolerance < 0.02;
       tolerance *= 1.4)
    fewer = simplified(mesh, tolerance);
  return split(std::move(fewer), triangles);
}

std::size_t turns_above(const UrdfRobot& robot, std::size_t link) {
  std::size_t out = 0;
  for (; link != 0; link = static_cast<std::size_t>(robot.links[link].parent))
    out += robot.joints[link - 1].kind == UrdfJoint::Kind::rotating;
  return out;
}

// In the hand: the links behind the last turning joint, and a ball before what they reach to.
void carry_ball(ContactLab& lab) {
  std::size_t most = 0, hand = 0;
  for (std::size_t i = 0; i < lab.robot.links.size(); ++i)
    if (!lab.robot.body(i).triangles.empty() && turns_above(lab.robot, i) > most)
      most = turns_above(lab.robot, hand = i);
  lab.model->pose(std::vector<double>(lab.joints.size(), 0.0));
  const PosedLinks& links = lab.model->links();
  std::vector<std::size_t> holding;
  Eigen::AlignedBox3d box;
  for (std::size_t i = 0; i < lab.robot.links.size(); ++i) {
    if (turns_above(lab.robot, i) != most) continue;
    holding.push_back(i);
    const Pose T = links.T_world_link(hand).inverse() * links.T_world_link(i);
    for (const auto& v : lab.robot.body(i).vertices) box.extend(T * v.cast<double>());
  }
  Pose T = Pose::Identity();
  T.translation() << box.center().x(), box.center().y(), box.max().z() + double{kBall} / 2;
  lab.hand = lab.robot.links[hand].name;
  lab.model->attach(0, hand, T, holding);
}

}  // namespace

std::vector<const Mesh*> ContactLab::meshes() const {
  std::vector<const Mesh*> out;
  for (std::size_t i = 0; i < model->parts(); ++i) {
    const std::string& name = model->part_name(i);
    const auto link = std::ranges::find(robot.links, name, &Node::name);
    out.push_back(link != robot.links.end() ? &robot.body(static_cast<std::size_t>(link - robot.links.begin()))
                                            : &scene.nodes()[static_cast<std::size_t>(*scene.find(name))].mesh);
  }
  return out;
}

ContactLab make_contact_lab(const std::optional<std::filesystem::path>& urdf, std::size_t triangles) {
  const sim::Lab world = sim::make_lab(0.02, 1);
  ContactLab lab;
  lab.robot = urdf ? read_urdf(*urdf, MeshSearch{}, UrdfShapes::all) : lab_arm(world);
  for (std::size_t i = 0; i < lab.robot.links.size(); ++i) {
    Mesh body = with_triangles(lab.robot.body(i), triangles);
    lab.triangles += body.triangles.size();
    if (i < lab.robot.collision.size()) lab.robot.collision[i] = {};
    lab.robot.links[i].mesh = std::move(body);
  }
  for (const UrdfJoint& joint : lab.robot.joints)
    if (joint.kind != UrdfJoint::Kind::fixed && !joint.mimic) lab.joints.push_back(joint.name);

  std::vector<Node> nodes{{"carried ball", with_triangles(make_sphere(kBall), triangles), -1, Pose::Identity()}};
  lab.triangles += nodes[0].mesh.triangles.size();
  for (std::size_t i = 0; i < world.parts.size(); ++i) {
    const auto arm = static_cast<std::size_t>(world.arm);
    if (i >= arm && i < arm + sim::kArmLinks) continue;
    nodes.push_back({world.parts[i].name, mesh_of(world.parts[i]), -1, world.parts[i].T_world_part});
  }
  lab.scene = SceneModel(std::move(nodes));
  lab.T_world_root = sim::T_world_stand();
  if (urdf) lab.T_world_root.translation().z() = 0;  // as high as the table
  lab.model = std::make_unique<ContactModel>(lab.robot, lab.joints, &lab.scene, lab.T_world_root,
                                             urdf ? urdf->string() : "lab");
  carry_ball(lab);
  return lab;
}

namespace {

std::vector<double> uniform(const ContactLab& lab, std::mt19937_64& random) {
  std::vector<double> q;
  for (const std::string& name : lab.joints) {
    const auto joint = std::ranges::find(lab.robot.joints, name, &UrdfJoint::name);
    const bool ends = std::isfinite(joint->lower) && std::isfinite(joint->upper);
    const double low = ends ? joint->lower : -std::numbers::pi, high = ends ? joint->upper : std::numbers::pi;
    q.push_back(low + (high - low) * static_cast<double>(random() >> 11) * 0x1p-53);
  }
  return q;
}

}  // namespace

std::vector<std::vector<double>> uniform_poses(const ContactLab& lab, std::size_t count) {
  std::mt19937_64 random(1);
  std::vector<std::vector<double>> out;
  while (out.size() < count) out.push_back(uniform(lab, random));
  return out;
}

std::vector<std::vector<double>> motion_poses(const ContactLab& lab, std::size_t count) {
  std::mt19937_64 random(2);
  std::vector<std::vector<double>> out;
  std::vector<double> from = uniform(lab, random);
  while (out.size() < count) {
    const std::vector<double> to = uniform(lab, random);
    double pictures = 1;
    for (std::size_t i = 0; i < to.size(); ++i) {
      const auto joint = std::ranges::find(lab.robot.joints, lab.joints[i], &UrdfJoint::name);
      const double velocity = joint->velocity > 0 ? joint->velocity : 1;
      pictures = std::max(pictures, std::ceil(60 * std::abs(to[i] - from[i]) / (0.5 * velocity)));
    }
    for (double k = 0; k < pictures && out.size() < count; ++k) {
      std::vector<double> q = from;
      for (std::size_t i = 0; i < q.size(); ++i) q[i] += k / pictures * (to[i] - from[i]);
      out.push_back(std::move(q));
    }
    from = to;
  }
  return out;
}

}  // namespace foresight
