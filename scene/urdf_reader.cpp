#include "scene/urdf_reader.hpp"

#include <console_bridge/console.h>
#include <fmt/core.h>
#include <urdf_parser/urdf_parser.h>

#include <algorithm>
#include <limits>
#include <mutex>
#include <set>

#include "common/error.hpp"
#include "common/text.hpp"
#include "scene/files.hpp"
#include "scene/mesh_builder.hpp"
#include "scene/mesh_reader.hpp"
#include "scene/primitives.hpp"
#include "scene/text_table.hpp"
#include "scene/urdf_check.hpp"

namespace foresight {
namespace fs = std::filesystem;
namespace {

constexpr double kInfinite = std::numeric_limits<double>::infinity();

// urdfdom reports only through a process-wide logger: this keeps the first error for our own
// message and the terminal quiet.
class LogCapture : public console_bridge::OutputHandler {
 public:
  LogCapture() : lock_(mutex()) { console_bridge::useOutputHandler(this); }
  ~LogCapture() override { console_bridge::restorePreviousOutputHandler(); }
  LogCapture(const LogCapture&) = delete;

  void log(const std::string& text, console_bridge::LogLevel level, const char*, int) override {
    if (first_error_.empty() && level == console_bridge::CONSOLE_BRIDGE_LOG_ERROR) first_error_ = text;
  }
  const std::string& first_error() const { return first_error_; }

 private:
  static std::mutex& mutex() {
    static std::mutex m;
    return m;
  }
  std::lock_guard<std::mutex> lock_;
  std::string first_error_;
};

// urdfdom's XML reader recurses into nested elements; a hostile file could exhaust the stack.
bool is_deep(std::string_view xml) {
  int depth = 0;
  for (std::size_t at = xml.find('<'); at != std::string_view::npos; at = xml.find('<', at + 1)) {
    const char next = at + 1 < xml.size() ? xml[at + 1] : '>';
    if (next == '/')
      --depth;
    else if (std::isalpha(static_cast<unsigned char>(next)) || next == '_')
      ++depth;
    const std::size_t end = xml.find('>', at);
    if (end != std::string_view::npos && xml[end - 1] == '/' && next != '/') --depth;
    if (depth > 1000) return true;
  }
  return false;
}

// What a comment says of macros is none.
std::string without_comments(std::string_view xml) {
  std::string out;
  for (;;) {
    const std::size_t begin = xml.find("<!--");
    out += xml.substr(0, begin);
    const std::size_t end = begin == std::string_view::npos ? begin : xml.find("-->", begin + 4);
    if (end == std::string_view::npos) return out;
    xml.remove_prefix(end + 3);
  }
}

bool is_xacro(const std::string& xml) {
  const std::string text = without_comments(xml);
  // A URDF that was made of a xacro file keeps its name space, but none of its macros and variables.
  return text.find("<xacro:") != std::string::npos ||
         (text.find("xmlns:xacro") != std::string::npos && text.find("${") != std::string::npos);
}

struct ParsedUrdf {
  urdf::ModelInterfaceSharedPtr model;
  std::map<std::string, UrdfShapeCount> shapes;  // by link
  std::string complaint;                         // the parser's first; it goes on where it can
};

ParsedUrdf parse(const fs::path& file) {
  const std::string xml = read_file(file);
  if (is_deep(xml)) throw InputError(file.string(), "its elements nest too deep", "write a plain URDF");
  if (is_xacro(xml))
    throw InputError(file.string(), "is a xacro file, from which a URDF is still to be made",
                     "run `xacro " + file.filename().string() + " > robot.urdf` first, and give robot.urdf");
  ParsedUrdf out{nullptr, check_urdf(file, xml), {}};
  urdf::ModelInterfaceSharedPtr& model = out.model;
  std::string reason;
  {
    LogCapture log;
    try {
      model = urdf::parseURDF(xml);
      reason = log.first_error();
    } catch (const std::exception& error) {
      reason = error.what();
    }
  }
  if (!model || !model->getRoot())
    throw InputError(file.string(), "is not a valid URDF (" + (reason.empty() ? "no XML" : reason) + ")",
                     "correct it; check_urdf shows more");
  out.complaint = reason;
  return out;
}

/// A link that is this small or large is in another unit, and the gate would guard it in vain.
void require_size_of_a_link(const Mesh& body, const std::string& where) {
  constexpr double kSmallest = 1e-3, kLargest = 20;
  if (body.vertices.empty()) return;
  Eigen::AlignedBox3d box;
  for (const auto& v : body.vertices) box.extend(v.cast<double>());
  const double size = box.sizes().maxCoeff();
  const std::string shown = fmt::format("its shapes are {:.3g} m large", size);
  if (size < kSmallest)
    throw InputError(where, shown, "write them in metres; a mesh in metres takes no scale of 0.001");
  if (size > kLargest)
    throw InputError(where, shown, "write them in metres; a mesh in millimetres takes scale=\"0.001 0.001 0.001\"");
}

class RobotBuilder {
 public:
  RobotBuilder(const fs::path& file, const MeshSearch& search, UrdfShapes shapes)
      : file_(file), search_(search), shapes_(shapes), parsed_(parse(file)), model_(parsed_.model) {}

  UrdfRobot build() {
    robot_.name = model_->getName();
    add_link(*model_->getRoot(), -1);
    // The list grows while it is walked: parents come before their children.
    for (std::size_t i = 0; i < robot_.links.size(); ++i) {
      const auto link = model_->getLink(robot_.links[i].name);
      for (const auto& joint : link->child_joints) add_joint(*joint, static_cast<int>(i));
    }
    if (robot_.links.size() != model_->links_.size())
      throw InputError(file_.string(), "some links hang in a circle", "connect every link to " + robot_.links[0].name);
    add_mimics();
    return std::move(robot_);
  }

 private:
  void add_link(const urdf::Link& link, int parent) {
    if (!seen_.insert(link.name).second)
      throw InputError(file_.string(), "link " + in_quotes(link.name) + " has two parent joints", "remove one of them");
    const std::string where = file_.string() + ": link " + in_quotes(link.name);
    const UrdfShapeCount written = parsed_.shapes[link.name];
    require_all(link.visual_array.size(), written.visual, "<visual>", where);
    require_all(link.collision_array.size(), written.collision, "<collision>", where);
    Node node{link.name, {}, parent, Pose::Identity()};
    if (shapes_ != UrdfShapes::none) node.mesh = merged_shapes(link.visual_array, where + " <visual>");
    robot_.links.push_back(std::move(node));
    if (shapes_ != UrdfShapes::all) return;
    robot_.collision.push_back(merged_shapes(link.collision_array, where + " <collision>"));
    require_size_of_a_link(robot_.body(robot_.links.size() - 1), where);
  }

  // check_urdf() has seen that all are right; whatever the parser still passed over must not go without a word.
  void require_all(std::size_t found, std::size_t written, const char* what, const std::string& where) const {
    if (found != written)
      throw InputError(where,
                       "only " + std::to_string(found) + " of its " + std::to_string(written) + " " + what +
                           " can be read (" + parsed_.complaint + ")",
                       "compare it with the URDF specification; check_urdf shows more");
  }

  /// `shapes`: of <visual> or <collision> elements.
  template <typename Elements>
  Mesh merged_shapes(const Elements& elements, const std::string& where) const {
    std::vector<Mesh> parts;
    std::vector<Eigen::Affine3d> T;
    for (const auto& element : elements) {
      if (!element || !element->geometry) throw InputError(where, "has no shape", "give it a <geometry>");
      Eigen::Vector3d scale(1, 1, 1);
      parts.push_back(read_geometry(*element->geometry, where, scale));
      T.push_back(Eigen::Affine3d(to_pose(element->origin, where).matrix()) * Eigen::Scaling(scale));
    }
    Mesh out = merged(parts, T);
    for (const auto& v : out.vertices)
      if (!v.allFinite()) throw InputError(where, "its geometry is not finite", "correct its scale");
    return out;
  }

  Mesh read_geometry(const urdf::Geometry& geometry, const std::string& where, Eigen::Vector3d& scale) const {
    const auto positive = [&](double size) {
      if (!(size > 0 && size <= kFarthest))
        throw InputError(where, "the size " + std::to_string(size) + " is not positive", "write it in metres");
      return size;
    };
    switch (geometry.type) {
      case urdf::Geometry::BOX: {
        const auto& d = static_cast<const urdf::Box&>(geometry).dim;
        return make_box({positive(d.x), positive(d.y), positive(d.z)});
      }
      case urdf::Geometry::CYLINDER: {
        const auto& cylinder = static_cast<const urdf::Cylinder&>(geometry);
        return make_cylinder(positive(cylinder.radius), positive(cylinder.length));
      }
      case urdf::Geometry::SPHERE: return make_sphere(positive(static_cast<const urdf::Sphere&>(geometry).radius));
      case urdf::Geometry::MESH: break;
    }
    const auto& mesh = static_cast<const urdf::Mesh&>(geometry);
    scale = {mesh.scale.x, mesh.scale.y, mesh.scale.z};  // negative mirrors
    for (double s : scale) positive(std::abs(s));
    return read_mesh(find_mesh(mesh.filename, file_, search_, where));
  }

  Pose to_pose(const urdf::Pose& pose, const std::string& where) const {
    return checked_pose({pose.position.x, pose.position.y, pose.position.z},
                        {pose.rotation.x, pose.rotation.y, pose.rotation.z, pose.rotation.w}, where);
  }

  void add_joint(const urdf::Joint& from, int parent) {
    const std::string where = file_.string() + ": joint " + in_quotes(from.name);
    UrdfJoint joint;
    joint.name = from.name;
    joint.T_parent_joint = to_pose(from.parent_to_joint_origin_transform, where);
    joint.axis = {from.axis.x, from.axis.y, from.axis.z};
    const bool moves = from.type == urdf::Joint::REVOLUTE || from.type == urdf::Joint::CONTINUOUS ||
                       from.type == urdf::Joint::PRISMATIC;
    joint.loose = from.type == urdf::Joint::FLOATING || from.type == urdf::Joint::PLANAR;
    if (moves) {
      joint.kind = from.type == urdf::Joint::PRISMATIC ? UrdfJoint::Kind::sliding : UrdfJoint::Kind::rotating;
      if (!(joint.axis.norm() > 1e-6 && joint.axis.norm() < kFarthest))
        throw InputError(where, "its axis has no direction", "write a unit vector");
      joint.axis.normalize();
      const bool endless = from.type == urdf::Joint::CONTINUOUS || !from.limits;
      joint.lower = endless ? -kInfinite : from.limits->lower;
      joint.upper = endless ? kInfinite : from.limits->upper;
      // Values as 1e5 stand for none; degrees are smaller.
      constexpr double kEndless = 3600;
      if (joint.kind == UrdfJoint::Kind::rotating && joint.lower < -kEndless) joint.lower = -kInfinite;
      if (joint.kind == UrdfJoint::Kind::rotating && joint.upper > kEndless) joint.upper = kInfinite;
      if (from.limits && std::isfinite(from.limits->velocity)) joint.velocity = std::max(from.limits->velocity, 0.0);
      if (!(joint.lower <= joint.upper))
        throw InputError(where, "its lower limit exceeds the upper one", "swap lower and upper");
    }
    const auto link = model_->getLink(from.child_link_name);
    if (!link) throw InputError(where, "has no child link", "name one");
    joint.child = static_cast<int>(robot_.links.size());
    add_link(*link, parent);
    robot_.links.back().T_parent_node = joint.T_parent_joint;
    robot_.joints.push_back(std::move(joint));
  }

  void add_mimics() {
    for (UrdfJoint& joint : robot_.joints) {
      const auto from = model_->getJoint(joint.name);
      if (!from || !from->mimic || joint.kind == UrdfJoint::Kind::fixed) continue;
      const auto leader = std::find_if(robot_.joints.begin(), robot_.joints.end(),
                                       [&](const UrdfJoint& j) { return j.name == from->mimic->joint_name; });
      const bool is_joint = leader != robot_.joints.end();
      if (!is_joint || leader->kind == UrdfJoint::Kind::fixed)
        throw InputError(file_.string() + ": joint " + in_quotes(joint.name),
                         "follows " + in_quotes(from->mimic->joint_name) +
                             (is_joint ? ", which does not move" : ", which is no joint"),
                         "name a moving joint in <mimic>");
      joint.mimic = {static_cast<int>(leader - robot_.joints.begin()), from->mimic->multiplier, from->mimic->offset};
    }
    for (const UrdfJoint& joint : robot_.joints) {
      std::size_t steps = 0;
      for (const UrdfJoint* j = &joint; j->mimic; j = &robot_.joints[static_cast<std::size_t>(j->mimic->joint)])
        if (++steps > robot_.joints.size())
          throw InputError(file_.string() + ": joint " + in_quotes(joint.name), "follows itself in a circle",
                           "remove one <mimic>");
    }
  }

  const fs::path& file_;
  const MeshSearch& search_;
  const UrdfShapes shapes_;
  ParsedUrdf parsed_;
  urdf::ModelInterfaceSharedPtr model_;
  UrdfRobot robot_;
  std::set<std::string> seen_;
};

}  // namespace

UrdfRobot read_urdf(const fs::path& file, const fs::path& root, UrdfShapes shapes) {
  return read_urdf(file, MeshSearch{root, {}}, shapes);
}

UrdfRobot read_urdf(const fs::path& file, const MeshSearch& search, UrdfShapes shapes) {
  return RobotBuilder(file, search, shapes).build();
}

}  // namespace foresight
