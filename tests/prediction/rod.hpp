// A rod that turns about y above a plate, and a flag on it: two joints, and a shelf that the rod must stay clear of.
#pragma once

#include <memory>

#include "motion/gate_options.hpp"
#include "tests/scene/test_run.hpp"

namespace foresight {

class Rod {
 public:
  Rod() {
    const std::string text =
        "<robot name='rod'><link name='base'/><link name='rod'><visual><origin xyz='0 0 0.2'/><geometry>"
        "<box size='0.04 0.04 0.4'/></geometry></visual></link><joint name='turn' type='revolute'>"
        "<parent link='base'/><child link='rod'/><axis xyz='0 1 0'/>"
        "<limit lower='-2' upper='2' effort='1' velocity='1'/></joint>"
        "<link name='flag'><visual><geometry><box size='0.01 0.01 0.01'/></geometry></visual></link>"
        "<joint name='wave' type='revolute'><parent link='rod'/><child link='flag'/><origin xyz='0 0 0.4'/>"
        "<axis xyz='1 0 0'/><limit lower='-1' upper='1' effort='1' velocity='2'/></joint></robot>";
    file_ = folder_.write("rod.urdf", text);
  }
  std::unique_ptr<RobotShape> shape() const {
    return std::make_unique<RobotShape>(read_urdf(file_, folder_.path()), std::vector<std::string>{"turn", "wave"},
                                        Pose::Identity(), "rod");
  }
  GateOptions options() const {
    GateOptions out;
    out.joints = {{"turn", {-2, 2, 1, 4, 60}, 0.2}, {"wave", {-1, 1, 2, 8, 120}, 0.2}};
    out.ramp_s = 0.5;
    out.surroundings.obstacles = {{"shelf", {Eigen::Vector3d(0.35, -1, -1), Eigen::Vector3d(1, 1, 1)}}};
    return out;
  }
  const std::filesystem::path& urdf() const { return file_; }

 private:
  TempFolder folder_;
  std::filesystem::path file_;
};

}  // namespace foresight
