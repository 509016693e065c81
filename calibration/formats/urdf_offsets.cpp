#include "calibration/formats/urdf_offsets.hpp"

#include <tinyxml.h>

#include <array>
#include <cmath>
#include <sstream>

#include "common/error.hpp"
#include "common/exact_number.hpp"
#include "common/text.hpp"

namespace foresight {
namespace {

Eigen::Matrix3d rotation(const Eigen::Vector3d& rpy) {
  return (Eigen::AngleAxisd(rpy.z(), Eigen::Vector3d::UnitZ()) * Eigen::AngleAxisd(rpy.y(), Eigen::Vector3d::UnitY()) *
          Eigen::AngleAxisd(rpy.x(), Eigen::Vector3d::UnitX()))
      .toRotationMatrix();
}

// Yaw is taken off before the others are read, so that a pitch of 90 degrees loses nothing.
Eigen::Vector3d roll_pitch_yaw(const Eigen::Matrix3d& R) {
  const double yaw = std::atan2(R(1, 0), R(0, 0));
  const Eigen::Matrix3d M = rotation({0, 0, -yaw}) * R;
  return {std::atan2(-M(1, 2), M(1, 1)), std::atan2(-M(2, 0), M(0, 0)), yaw};
}

std::string text_of(const Eigen::Vector3d& v) {
  return exact_text(v.x()) + " " + exact_text(v.y()) + " " + exact_text(v.z());
}

class Document {
 public:
  Document(const std::string& urdf, std::string where) : where_(std::move(where)) {
    xml_.Parse(urdf.c_str(), nullptr, TIXML_ENCODING_UTF8);
    if (xml_.Error())
      throw InputError(where_ + ":" + std::to_string(xml_.ErrorRow()), std::string("is no XML: ") + xml_.ErrorDesc(),
                       "give a URDF file");
    robot_ = xml_.FirstChildElement("robot");
    if (!robot_) throw InputError(where_, "has no <robot>", "give a URDF file");
  }

  std::string text() const {
    TiXmlPrinter printer;
    printer.SetIndent("  ");
    xml_.Accept(&printer);
    return printer.Str();
  }

  void mount(const UrdfMount& m) {
    require("link", m.parent);
    if (TiXmlElement* joint = joint_of(m.child)) {
      if (attribute(*joint->FirstChildElement("parent"), "link") != m.parent)
        throw InputError(where_, "the link " + in_quotes(m.child) + " does not hang on " + in_quotes(m.parent),
                         "name its parent " + in_quotes(attribute(*joint->FirstChildElement("parent"), "link")));
      if (attribute(*joint, "type") != "fixed")
        throw InputError(where_, "the joint of " + in_quotes(m.child) + " moves", "give a link on a fixed joint");
      set_origin(*joint, m.T_parent_child);
      return;
    }
    if (!find("link", m.child)) add(*robot_, "link").SetAttribute("name", m.child);
    TiXmlElement& joint = add(*robot_, "joint");
    joint.SetAttribute("name", m.child + "_mount");
    joint.SetAttribute("type", "fixed");
    add(joint, "parent").SetAttribute("link", m.parent);
    add(joint, "child").SetAttribute("link", m.child);
    set_origin(joint, m.T_parent_child);
  }

  void head(const UrdfHead& h) {
    require("link", h.parent);
    const bool known[] = {find("joint", h.joints[0]) != nullptr, find("joint", h.joints[1]) != nullptr};
    if (known[0] != known[1]) require("joint", h.joints[known[0] ? 1 : 0]);
    if (!known[0]) {
      add_turning(h.joints[0], h.parent, h.T_parent_pan);
      add_turning(h.joints[1], h.joints[0] + "_link", h.T_pan_tilt);
      return mount({h.joints[1] + "_link", h.camera, h.T_tilt_camera});
    }
    TiXmlElement &pan = require("joint", h.joints[0]), &tilt = require("joint", h.joints[1]);
    require_between(pan, h.parent);
    require_between(tilt, child_of(pan));
    const Pose pan_axis = z_to(axis_of(pan)), tilt_axis = z_to(axis_of(tilt));
    set_origin(pan, h.T_parent_pan * pan_axis.inverse());
    set_origin(tilt, pan_axis * h.T_pan_tilt * tilt_axis.inverse());
    mount({child_of(tilt), h.camera, tilt_axis * h.T_tilt_camera});
  }

  UrdfMount attach(const UrdfMount& m, const std::string& link) {
    require("link", link);
    if (!find("link", m.parent) || m.parent == link) return {link, m.child, m.T_parent_child};
    const auto [root_a, T_a] = rigid_root(link);
    const auto [root_b, T_b] = rigid_root(m.parent);
    if (root_a != root_b)
      throw InputError(where_,
                       "the links " + in_quotes(link) + " and " + in_quotes(m.parent) + " move against each other",
                       "attach to " + in_quotes(m.parent) + ", or to a link that is fixed to it");
    return {link, m.child, T_a.inverse() * T_b * m.T_parent_child};
  }

  void shift(const std::string& name, double offset) {
    TiXmlElement& joint = require("joint", name);
    const std::string type = attribute(joint, "type");
    if (type != "revolute" && type != "continuous" && type != "prismatic")
      throw InputError(where_, "the joint " + in_quotes(name) + " is of type " + type, "give a joint that moves");
    const Eigen::Vector3d along = axis_of(joint);
    Pose T = Pose::Identity();
    if (type == "prismatic")
      T.translation() = offset * along;
    else
      T.linear() = Eigen::AngleAxisd(offset, along).toRotationMatrix();
    set_origin(joint, origin(joint) * T);
  }

  UrdfMount read(const std::string& child) {
    TiXmlElement* joint = joint_of(child);
    if (!joint) throw InputError(where_, "the link " + in_quotes(child) + " hangs on no joint", "name another link");
    return {attribute(*joint->FirstChildElement("parent"), "link"), child, origin(*joint)};
  }

 private:
  static std::string attribute(const TiXmlElement& element, const char* name) {
    const char* value = element.Attribute(name);
    return value ? value : "";
  }

  Eigen::Vector3d axis_of(const TiXmlElement& joint) const {
    const TiXmlElement* axis = joint.FirstChildElement("axis");
    return (axis ? vector(*axis, "xyz", {1, 0, 0}) : Eigen::Vector3d{1, 0, 0}).normalized();
  }

  static Pose z_to(const Eigen::Vector3d& axis) {
    return Pose(Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitZ(), axis));
  }

  static std::string child_of(const TiXmlElement& joint) {
    const TiXmlElement* child = joint.FirstChildElement("child");
    return child ? attribute(*child, "link") : "";
  }

  void require_between(const TiXmlElement& joint, const std::string& parent) const {
    const TiXmlElement* there = joint.FirstChildElement("parent");
    if (there && attribute(*there, "link") == parent) return;
    throw InputError(where_,
                     "the joint " + in_quotes(attribute(joint, "name")) + " does not hang on " + in_quotes(parent),
                     "name the link that it hangs on with --link" +
                         (there ? ", " + in_quotes(attribute(*there, "link")) : std::string()));
  }

  void add_turning(const std::string& name, const std::string& parent, const Pose& origin) {
    const std::string link = name + "_link";
    if (!find("link", link)) add(*robot_, "link").SetAttribute("name", link);
    TiXmlElement& joint = add(*robot_, "joint");
    joint.SetAttribute("name", name);
    joint.SetAttribute("type", "continuous");
    add(joint, "parent").SetAttribute("link", parent);
    add(joint, "child").SetAttribute("link", link);
    add(joint, "axis").SetAttribute("xyz", "0 0 1");
    set_origin(joint, origin);
  }

  /// The topmost link that `link` is fixed to, and `link` in its frame.
  std::pair<std::string, Pose> rigid_root(std::string link) const {
    Pose T = Pose::Identity();
    for (const TiXmlElement* joint = joint_of(link); joint && attribute(*joint, "type") == "fixed";
         joint = joint_of(link)) {
      T = origin(*joint) * T;
      link = attribute(*joint->FirstChildElement("parent"), "link");
    }
    return {link, T};
  }

  static TiXmlElement& add(TiXmlElement& parent, const char* name) {
    return *parent.InsertEndChild(TiXmlElement(name))->ToElement();
  }

  TiXmlElement* find(const char* kind, const std::string& name) const {
    for (TiXmlElement* e = robot_->FirstChildElement(kind); e; e = e->NextSiblingElement(kind))
      if (attribute(*e, "name") == name) return e;
    return nullptr;
  }

  TiXmlElement& require(const char* kind, const std::string& name) const {
    if (TiXmlElement* e = find(kind, name)) return *e;
    std::vector<std::string> names;
    for (TiXmlElement* e = robot_->FirstChildElement(kind); e; e = e->NextSiblingElement(kind))
      names.push_back(attribute(*e, "name"));
    throw InputError(where_, std::string("there is no ") + kind + " " + in_quotes(name),
                     did_you_mean(name, names, "give a URDF with one"));
  }

  TiXmlElement* joint_of(const std::string& child) const {
    for (TiXmlElement* e = robot_->FirstChildElement("joint"); e; e = e->NextSiblingElement("joint")) {
      const TiXmlElement* link = e->FirstChildElement("child");
      if (link && attribute(*link, "link") == child && e->FirstChildElement("parent")) return e;
    }
    return nullptr;
  }

  Eigen::Vector3d vector(const TiXmlElement& element, const char* name, const Eigen::Vector3d& absent) const {
    if (!element.Attribute(name)) return absent;
    std::istringstream words(attribute(element, name));
    std::array<std::string, 4> word;
    Eigen::Vector3d out;
    for (auto& w : word) words >> w;
    for (int i = 0; i < 3; ++i) {
      const auto value = parse_number(word[static_cast<std::size_t>(i)]);
      if (!value || !std::isfinite(*value) || !word[3].empty())
        throw InputError(where_ + ":" + std::to_string(element.Row()),
                         std::string(name) + " is " + in_quotes(attribute(element, name)), "write three numbers");
      out[i] = *value;
    }
    return out;
  }

  Pose origin(const TiXmlElement& joint) const {
    Pose T = Pose::Identity();
    const TiXmlElement* o = joint.FirstChildElement("origin");
    if (!o) return T;
    T.linear() = rotation(vector(*o, "rpy", {0, 0, 0}));
    T.translation() = vector(*o, "xyz", {0, 0, 0});
    return T;
  }

  void set_origin(TiXmlElement& joint, const Pose& T) {
    TiXmlElement* o = joint.FirstChildElement("origin");
    if (!o) o = &add(joint, "origin");
    o->SetAttribute("xyz", text_of(T.translation()));
    o->SetAttribute("rpy", text_of(roll_pitch_yaw(T.linear())));
  }

  std::string where_;
  TiXmlDocument xml_;
  TiXmlElement* robot_ = nullptr;
};

}  // namespace

std::string with_offsets(const std::string& urdf, const UrdfOffsets& offsets, const std::string& where) {
  Document document(urdf, where);
  for (const UrdfMount& m : offsets.mounts) document.mount(m);
  if (offsets.head) document.head(*offsets.head);
  for (const auto& [name, offset] : offsets.joints) document.shift(name, offset);
  return document.text();
}

UrdfMount attached(const UrdfMount& mount, const std::string& link, const std::string& urdf, const std::string& where) {
  return Document(urdf, where).attach(mount, link);
}

UrdfMount read_mount(const std::string& urdf, const std::string& child, const std::string& where) {
  return Document(urdf, where).read(child);
}

std::string empty_urdf(const std::string& root) {
  return "<?xml version=\"1.0\"?>\n<robot name=\"cameras\">\n  <link name=\"" + root + "\"/>\n</robot>\n";
}

}  // namespace foresight
