#include "tests/input/hand_world.hpp"

#include <gtest/gtest.h>

#include <bit>

#include "tests/support/folders.hpp"

namespace foresight {
namespace {

using namespace std::chrono_literals;

DrawNonce counting(Nonce first) {
  return [next = std::make_shared<Nonce>(first)] { return (*next)++; };
}

Identity identity(const std::string& name, const Rig& rig) {
  return {kLineProtocol, "1.0", name, 11, 22, 33, rig.joint_names()};
}

ControlDeskOptions desk_options(const Rig& rig) {
  ControlDeskOptions out;
  out.identity = identity("the robot", rig);
  out.draw = counting(1'000'000);
  return out;
}

std::vector<Drive*> pointers(std::vector<PromptDrive>& drives) {
  std::vector<Drive*> out;
  for (PromptDrive& drive : drives) out.push_back(&drive);
  return out;
}

}  // namespace

HandWorld::HandWorld(Duration delay)
    : rig_([] {
        static const Rig rig = read_rig(source_folder() / "configs/minerva.yaml");
        return rig;
      }()),
      options_(hand_options(rig_)),
      drives_(rig_.joints.size()),
      robot_(rig_.gate_options(), nullptr, {&network_}, pointers(drives_)),
      line_(rig_.gate_options(), desk_options(rig_)),
      seat_({identity("anna", rig_), counting(1)}),
      delay_(delay) {
  const std::array<double, 10> stands{0.2, 0.6, -0.1, 1.2, 0.3, 0.7, -0.2, 0.03, 0.1, -0.2};
  for (std::size_t i = 0; i < drives_.size(); ++i) {
    drives_[i].state.homed = true;
    drives_[i].state.position = stands[i];
  }
  hand_.emplace(options_, "minerva");
  robot_.ask(RobotRequest::enable);
  seat_.want_control(true);
  for (int i = 0; i < 250; ++i) step(false, nullptr, false);
  cycles(100, device_at({0, 0, 0}, false));
}

void HandWorld::judge(const HandRobot& robot, const HandCycle& out) {
  for (std::size_t i = 0; i < out.joints; ++i)
    for (const double position : {out.positions[i], drives_[i].state.position})
      digest = digest * 1'099'511'628'211U + std::bit_cast<std::uint64_t>(position);
  driving += out.phase == HandPhase::driving;
  const bool begins = out.deadman && !sent_;
  presses += begins;
  if (!out.deadman || begins)
    for (std::size_t i = 0; i < out.joints; ++i)
      (begins ? jumps_at_press : moved_while_open) += out.positions[i] != robot.begin[i];
  if (out.deadman && sent_)
    for (std::size_t i = 0; i < out.joints; ++i)
      steps_too_long += !(std::abs(out.positions[i] - (*sent_)[i]) <=
                          options_.gate.joints[i].limits.velocity * to_seconds(now() - sent_at_));
  sent_ = out.deadman ? std::optional(out.positions) : std::nullopt;
  sent_at_ = now();
}

void HandWorld::command(const TrackerState& device, bool stamped) {
  HandInput input;
  input.now = now();
  input.device = device;
  if (!stamped) input.device.time = now();
  input.robot = hand_robot(seat_, now());
  input.T_base_view = T_base_view;
  input.others = others;
  const HandCycle& out = hand_->cycle(input);
  judge(input.robot, out);
  LinePositions positions{};
  std::copy_n(out.positions.begin(), out.joints, positions.begin());
  seat_.command(now(), positions, out.deadman && out.joints > 0);
}

void HandWorld::watch_shafts() {
  const GateState state = gate().state;
  following += state == GateState::following;
  const bool may_move = state == GateState::following || state == GateState::stopping;
  for (std::size_t i = 0; i < drives_.size(); ++i) {
    const double stands = drives_[i].state.position;
    if (!shafts_.empty() && !may_move && robot_.status().phase == RobotPhase::ready)
      shafts_moved_at_rest += stands != shafts_[i];
  }
  shafts_.clear();
  for (const PromptDrive& drive : drives_) shafts_.push_back(drive.state.position);
}

void HandWorld::step(bool operator_runs, const TrackerState* device, bool stamped) {
  now_ = now_ + 4ms;
  for (; !down_.empty() && down_.front().first <= now_; down_.pop_front()) seat_.receive(down_.front().second, now());
  if (operator_runs || device == nullptr) seat_.advance(now());
  if (device) command(*device, stamped);
  for (FromOperator& message : seat_.take_outgoing())
    if (!up_cut) up_.push_back({now_ + delay_, std::move(message)});
  for (; !up_.empty() && up_.front().first <= now_; up_.pop_front()) line_.desk().receive(up_.front().second, now_);
  Commander* const commander = &line_;
  serve({&commander, 1}, robot_, now_);
  for (FromRobot& message : line_.desk().take_outgoing())
    if (!down_cut) down_.push_back({now_ + delay_, std::move(message)});
  robot_.cycle(now_);
  watch_shafts();
}

const HandCycle& HandWorld::cycle(const TrackerState& device, bool stamped) {
  step(true, &device, stamped);
  step(true, nullptr, false);
  return hand_->last();
}

const HandCycle& HandWorld::cycles(int count, const TrackerState& device) {
  for (int i = 0; i < count; ++i) cycle(device);
  return hand_->last();
}

void HandWorld::stand_still(Duration time) {
  for (const RobotTime end = now_ + time; now_ < end;) {
    now_ = now_ + 4ms;
    for (; !up_.empty() && up_.front().first <= now_; up_.pop_front()) line_.desk().receive(up_.front().second, now_);
    Commander* const commander = &line_;
    serve({&commander, 1}, robot_, now_);
    for (FromRobot& message : line_.desk().take_outgoing()) down_.push_back({now_ + delay_, std::move(message)});
    robot_.cycle(now_);
    watch_shafts();
  }
}

TrackerState device_at(const Eigen::Vector3d& position, bool held, bool clutched) {
  TrackerState out;
  out.connected = out.tracked = true;
  out.T_space_hand.translation() = position;
  out.buttons.set(TrackerButton::deadman, held);
  out.buttons.set(TrackerButton::clutch, clutched);
  return out;
}

}  // namespace foresight
