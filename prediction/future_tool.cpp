#include "prediction/future_tool.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/error.hpp"
#include "common/text.hpp"

namespace foresight {

FutureTool::FutureTool(ArmChain chain, std::span<const std::string> names, const std::string& where)
    : chain_(std::move(chain)) {
  for (const ArmJoint& joint : chain_.joints()) {
    const auto found = std::find(names.begin(), names.end(), joint.name);
    if (found == names.end())
      throw InputError(where, "the robot has no joint " + in_quotes(joint.name) + ", which moves the tool",
                       "choose a tool that only the robot's own joints move");
    joints_.push_back(static_cast<std::size_t>(found - names.begin()));
  }
}

PredictedTool FutureTool::show(const PredictedRobot& robot) noexcept {
  PredictedTool out;
  out.status = robot.status;
  out.sigma = std::numeric_limits<double>::infinity();
  TipChange change;
  out.T_base_tip = chain_.tip_pose(joints_of(robot.position, joints_), change);
  if (robot.status == StateStatus::invalid) return out;
  double square = 0;
  for (std::size_t i = 0; i < joints_.size(); ++i)
    square += change[i].head<3>().squaredNorm() * robot.sigma[joints_[i]] * robot.sigma[joints_[i]];
  const double prior = std::sqrt(square), scale = scale_.sigma();
  out.sigma = scale * prior;
  if (robot.status == StateStatus::predicted) told_.next() = {robot.time, prior, scale};
  return out;
}

std::optional<ToolError> FutureTool::score(const ScoredRobot& scored) noexcept {
  while (!told_.empty() && told_[0].time < scored.shown.time) told_.drop_oldest();
  if (told_.empty() || told_[0].time != scored.shown.time) return {};
  const Told told = told_[0];
  told_.drop_oldest();
  ToolError out;
  out.T_base_tip = place(scored.truth);
  const Vector6 off = pose_difference(place(scored.shown.position), out.T_base_tip);
  out.position = off.head<3>().norm();
  out.rotation = off.tail<3>().norm();
  out.sigma = told.scale * told.prior;
  const double passed = std::clamp(to_seconds(scored.shown.time - scored_), 0.0, 1.0);
  scored_ = scored.shown.time;
  if (told.prior > 0 && !scored.shown.settling)
    scale_.score(CalibratedSigma::usual_part(out.position / told.prior, told.scale), told.scale, passed);
  return out;
}

std::optional<double> pixel_error(const Lens& lens, const Pose& T_camera_base, const Pose& T_base_shown,
                                  const Pose& T_base_true) noexcept {
  const auto shown = lens.project(T_camera_base * T_base_shown.translation());
  const auto seen = lens.project(T_camera_base * T_base_true.translation());
  if (!shown || !seen) return {};
  return (*shown - *seen).norm();
}

}  // namespace foresight
