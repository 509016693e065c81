#include "motion/near_couples.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <mutex>

#include "scene/robot_scene.hpp"
#include "scene/simplify.hpp"

namespace foresight {
namespace {

double largest_norm(const Mesh& body) {
  double out = 0;
  for (const auto& v : body.vertices) out = std::max(out, v.cast<double>().norm());
  return out;
}

/// How far it can go from where it stands at 0.
double travel(const UrdfJoint& joint) {
  return joint.kind == UrdfJoint::Kind::sliding ? std::max(std::abs(joint.lower), std::abs(joint.upper)) : 0;
}

NearCouples make(const MovedRobot& moved, double clearance) {
  NearCouples out;
  out.clearance = clearance;
  const UrdfRobot& robot = moved.robot;
  std::vector<TriangleTree>& bodies = out.bodies;
  bodies.resize(robot.links.size());
  const auto body = [&](std::size_t i) -> const TriangleTree& {
    if (bodies[i].size() == 0) {
      const Mesh& mesh = robot.body(i);
      bodies[i] = TriangleTree(mesh.triangles.size() > kFineLink ? simplified(mesh, kLinkTolerance) : mesh);
    }
    return bodies[i];
  };
  for (std::size_t i = 0; i < robot.links.size(); ++i)
    for (std::size_t k = 0; k < i; ++k) {
      if (robot.body(i).triangles.empty() || robot.body(k).triangles.empty()) continue;
      const LinkPath between = moved.between(i, k);
      if (!between.apart()) continue;
      if (!between.near()) {
        out.far.push_back({i, k});
        continue;
      }
      NearLinks apart(moved.posed, between.axes, i, body(i), k, body(k), clearance);
      if (apart.nested())
        out.nested.push_back({robot.links[i].name, robot.links[k].name});
      else
        out.couples.push_back({i, k, std::move(apart)});
    }
  return out;
}

/// Bytes that are the same where NearCouples are.
class Key {
 public:
  Key(const MovedRobot& moved, double clearance) {
    add(&clearance, 1);
    for (std::size_t i = 0; i < moved.joints.size(); ++i) {
      add(moved.joints[i]);
      add(moved.jaws[i] ? 1.0 : 0.0);
    }
    for (std::size_t i = 0; i < moved.robot.links.size(); ++i) {
      const Mesh& body = moved.robot.body(i);
      add(moved.robot.links[i].name);
      add(moved.robot.links[i].parent);
      add(body.vertices.data(), body.vertices.size());
      add(body.triangles.data(), body.triangles.size());
    }
    for (std::size_t j = 0; j < moved.robot.joints.size(); ++j) {
      const UrdfJoint& joint = moved.robot.joints[j];
      const JointSource source = source_of(moved.robot, j);
      add(joint.name);
      add(joint.T_parent_joint.matrix().data(), 16);
      add(joint.axis.data(), 3);
      for (const double value : {static_cast<double>(joint.kind), joint.lower, joint.upper,
                                 static_cast<double>(source.joint), source.factor, source.offset})
        add(value);
    }
  }
  const std::string& bytes() const { return bytes_; }

 private:
  template <typename T>
  void add(const T* values, std::size_t count) {
    bytes_.append(reinterpret_cast<const char*>(&count), sizeof count);
    bytes_.append(reinterpret_cast<const char*>(values), count * sizeof(T));
  }
  void add(double value) { add(&value, 1); }
  void add(const std::string& text) { add(text.data(), text.size()); }

  std::string bytes_;
};

}  // namespace

LinkPath MovedRobot::between(std::size_t link, std::size_t other) const {
  LinkPath out;
  const int ancestor = static_cast<int>(posed.common_ancestor(link, other));
  for (const std::size_t end : {link, other}) {
    double far = largest_norm(robot.body(end));  // its farthest point from the frame that the joint moves
    for (const std::size_t j : posed.joints_between(end, ancestor)) {
      const UrdfJoint& joint = robot.joints[j];
      const int input = posed.input_of(j);
      if (joint.kind != UrdfJoint::Kind::fixed && input >= 0) {
        ++out.joints;
        out.jaws = out.jaws && jaws[static_cast<std::size_t>(input)];
        auto axis = std::ranges::find(out.axes, input, &NearLinks::Axis::input);
        const JointSource source = source_of(robot, j);
        if (axis == out.axes.end()) {
          const UrdfJoint& leads = robot.joints[static_cast<std::size_t>(source.joint)];
          axis = out.axes.insert(out.axes.end(), {input, leads.lower, leads.upper, 0});
        }
        axis->lever += std::abs(source.factor) * (joint.kind == UrdfJoint::Kind::sliding ? 1 : far);
      }
      far += joint.T_parent_joint.translation().norm() + travel(joint);
    }
  }
  return out;
}

double NearCouples::distance(const Couple& couple, const PosedLinks& posed) const noexcept {
  const Pose T = posed.T_world_link(couple.link).inverse(Eigen::Isometry) * posed.T_world_link(couple.other);
  return bodies[couple.link].nearest(bodies[couple.other], T, std::numeric_limits<double>::max()).distance;
}

std::shared_ptr<const NearCouples> NearCouples::of(const MovedRobot& robot, double clearance) {
  static std::mutex mutex;
  static std::map<std::string, std::weak_ptr<const NearCouples>> made;
  const Key key(robot, clearance);
  const std::lock_guard lock(mutex);
  std::erase_if(made, [](const auto& one) { return one.second.expired(); });
  if (const auto found = made.find(key.bytes()); found != made.end())
    if (auto held = found->second.lock()) return held;
  auto out = std::make_shared<const NearCouples>(make(robot, clearance));
  made[key.bytes()] = out;
  return out;
}

}  // namespace foresight
