// The tool of the robot that will be, how sure its place is, and how far off it was.
//
//   sigma^2 = scale^2 sum_i |J_i|^2 sigma_i^2        J_i: change of the tool's place per change of joint i
//
// `scale` is learnt as for joints (calibrated_sigma.hpp): what joints have in common, such as a command that acts late,
// adds up or cancels in the tool.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "common/lens.hpp"
#include "prediction/arm_chain.hpp"
#include "prediction/robot_future.hpp"

namespace foresight {

struct PredictedTool {
  StateStatus status = StateStatus::invalid;
  Pose T_base_tip = Pose::Identity();  ///< of an invalid state: as last measured
  double sigma = 0;  ///< m: the truth lies within twice of it in 95 % of cases; infinite where invalid
};

/// How far the tool was from where it was shown.
struct ToolError {
  Pose T_base_tip = Pose::Identity();  ///< the truth
  double position = 0;                 ///< m
  double rotation = 0;                 ///< rad
  double sigma = 0;                    ///< m, as it was told
};

/// One thread. Allocates at the start only; no method but the constructor throws.
class FutureTool {
 public:
  /// `names`: the robot's joints, in its order. Throws InputError at `where` where they lack one of the chain's.
  FutureTool(ArmChain chain, std::span<const std::string> names, const std::string& where);

  Pose place(const JointValues& joints) const noexcept { return chain_.tip_pose(joints_of(joints, joints_)); }
  /// Where what RobotFuture::show() gave puts the tool.
  PredictedTool show(const PredictedRobot& robot) noexcept;
  /// Of what was shown, in that order. Nothing where it was not.
  std::optional<ToolError> score(const ScoredRobot& scored) noexcept;

 private:
  struct Told {
    RobotTime time;
    double prior = 0, scale = 0;
  };

  ArmChain chain_;
  std::vector<std::size_t> joints_;  // of the robot, per joint of the chain
  CalibratedSigma scale_{1, 1e-3, 5, CalibratedSigma::kScaleOfThree};
  LastOf<Told> told_{1024};
  RobotTime scored_;
};

/// Distance in the image of a camera, px, of where the tool was shown and where it was; nothing where the camera sees
/// either not.
std::optional<double> pixel_error(const Lens& lens, const Pose& T_camera_base, const Pose& T_base_shown,
                                  const Pose& T_base_true) noexcept;

}  // namespace foresight
