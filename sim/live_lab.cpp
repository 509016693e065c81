#include "sim/live_lab.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>

#include "common/error.hpp"
#include "sim/evenly.hpp"
#include "sim/motion.hpp"

namespace foresight::sim {
namespace {

constexpr double kBallPeriod = 8, kBallWay = 0.22;  // seconds; metres to either side
constexpr const char* kMovable[] = {"mug", "can", "bottle"};

void check(const char* field, double value, double most) {
  if (!(value >= 0 && value <= most))
    throw InputError(field, fmt::format("{:.9g} is outside 0 .. {:.9g}", value, most), "choose a value inside");
}

Lab lab_for(const LiveLab::Options& options) {
  if (!options.things) return make_lab(options.texel, options.seed, true, options.task);
  Lab lab = make_lab_with(*options.things, options.furniture, options.texel, options.seed, options.task);
  std::set<std::string> names;
  for (const Part& part : lab.parts)
    if (!names.insert(part.name).second)
      throw InputError("the mock lab", "has a '" + part.name + "' of its own", "rename the link or node of that name");
  return lab;
}

PanTilt head_shafts(const ShaftPositions& shafts) {
  return {shafts("pan").value_or(kHeadAtTable.pan), shafts("tilt").value_or(kHeadAtTable.tilt)};
}

}  // namespace

LiveLab::LiveLab(const Options& options) : lab_(lab_for(options)), things_(options.things) {
  for (std::size_t i = 0; i < lab_.parts.size(); ++i) {
    Part& part = lab_.parts[i];
    loose_.push_back(std::ranges::find(options.loose, part.name) != options.loose.end());
    part.moves = part.moves || loose_[i];
    if (part.name == kBall && !loose_[i] && (!things_ || options.furniture)) ball_ = static_cast<int>(i);
  }
  const HiddenDeviations& hidden = options.hidden;
  check("hidden object_m", hidden.object_m, 0.05);
  check("hidden object_rad", hidden.object_rad, std::numbers::pi);
  check("hidden joint_rad", hidden.joint_rad, 0.2);
  modelled_rest_ = lab_.at_rest();
  add_prints(options);
  std::mt19937 random(hidden.seed);
  for (double& offset : joint_offsets_) offset = evenly(random, hidden.joint_rad);
  head_offset_ = {evenly(random, hidden.joint_rad), evenly(random, hidden.joint_rad)};
  if (hidden.object_m == 0 && hidden.object_rad == 0) return;
  if (!options.furniture)
    throw InputError("hidden object_m", "displaces one of the lab's things, which are not there", "leave it 0");
  displaced_ = lab_.find(kMovable[random() % std::size(kMovable)]);
  Pose& pose = lab_.parts[static_cast<std::size_t>(displaced_)].T_world_part;
  const double direction = evenly(random, std::numbers::pi);
  pose.pretranslate(hidden.object_m * Eigen::Vector3d(std::cos(direction), std::sin(direction), 0));
  pose.rotate(Eigen::AngleAxisd(evenly(random, hidden.object_rad), Eigen::Vector3d::UnitZ()));
}

SceneModel LiveLab::modelled_scene() const {
  std::vector<Node> nodes = nodes_of(lab_, modelled_rest_);
  for (std::size_t i = 0; i < nodes.size(); ++i)
    nodes[i].may_move = lab_.parts[i].moves && !loose_[i] && nodes[i].name != kBall;
  return SceneModel(std::move(nodes), kLabAccuracy);
}

void LiveLab::add_prints(const Options& options) {
  prints_ = options.prints;
  if (options.board) {
    prints_.push_back(options.board->print);
    T_board_ = options.board->T_print;
    if (const std::string& part = options.board->part; !part.empty()) {
      const auto at = std::find_if(lab_.parts.begin(), lab_.parts.end(), [&](const Part& p) { return p.name == part; });
      if (at == lab_.parts.end())
        throw InputError("the board's part", "the lab has no '" + part + "'", "name one of its links");
      board_part_ = static_cast<int>(at - lab_.parts.begin());
    }
  }
  for (const Print& print : prints_) check(print);
}

std::vector<Pose> LiveLab::true_prints(const LabState& T_world_part, double t) const {
  std::vector<Pose> out;
  for (const Print& print : prints_) out.push_back(print.T_world_print);
  if (!T_board_) return out;
  out.back() = T_board_(t);
  if (board_part_ >= 0) out.back() = T_world_part[static_cast<std::size_t>(board_part_)] * out.back();
  return out;
}

LabState LiveLab::with_robot(LabState state, const ShaftPositions& shafts, const std::array<double, 7>& offsets) const {
  if (things_) {
    std::ranges::copy(things_->poses(shafts), state.begin() + lab_.things);
    return state;
  }
  ArmPosition arm;
  for (std::size_t j = 0; j < arm.joints.size(); ++j)
    arm.joints[j] = shafts(arm_joints()[j].name).value_or(*shafts_at_rest(arm_joints()[j].name)) + offsets[j];
  const char* const finger = arm_joints()[arm.joints.size()].name;
  arm.opening = shafts(finger).value_or(*shafts_at_rest(finger));
  const auto links = arm_links_at(arm);
  for (std::size_t i = 1; i < links.size(); ++i) state[static_cast<std::size_t>(lab_.arm) + i] = links[i];
  return state;
}

LabState LiveLab::true_state(const ShaftPositions& shafts, double t) const {
  LabState state = with_robot(lab_.at_rest(), shafts, joint_offsets_);
  if (ball_ >= 0) state[static_cast<std::size_t>(ball_)] = T_world_ball(t);
  return state;
}

LabState LiveLab::modelled_state(const ShaftPositions& shafts) const {
  return with_robot(modelled_rest_, shafts, {});
}

Pose LiveLab::T_world_left(const ShaftPositions& shafts) const {
  PanTilt head = head_shafts(shafts);
  head.pan += head_offset_.pan;
  head.tilt += head_offset_.tilt;
  return T_world_head_left(head);
}

Pose LiveLab::T_world_left_modelled(const ShaftPositions& shafts) {
  return T_world_head_left(head_shafts(shafts));
}

Pose LiveLab::T_world_ball(double t) {
  const double way = kBallWay * std::sin(2 * std::numbers::pi * t / kBallPeriod);
  Pose pose = Pose::Identity();
  pose.translate(Eigen::Vector3d(-0.30, 0.02 + way, 0.002 + kBallRadius));  // on the mat
  // Rolls about x; to the left (+y) is a negative turn.
  pose.rotate(Eigen::AngleAxisd(-way / kBallRadius, Eigen::Vector3d::UnitX()));
  return pose;
}

std::optional<double> shafts_at_rest(std::string_view joint) {
  static const ArmPosition arm = arm_position_at(0);
  for (std::size_t j = 0; j < arm.joints.size(); ++j)
    if (joint == arm_joints()[j].name) return arm.joints[j];
  if (joint == arm_joints()[arm.joints.size()].name) return arm.opening;
  if (joint == "pan") return kHeadAtTable.pan;
  if (joint == "tilt") return kHeadAtTable.tilt;
  return std::nullopt;
}

}  // namespace foresight::sim
