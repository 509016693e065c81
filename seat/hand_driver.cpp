#include "seat/hand_driver.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <iterator>
#include <utility>

#include "display/head/eye_geometry.hpp"
#include "input/hand_of_rig.hpp"

namespace foresight {
namespace {

// Of the window. Longer than keys are held for: pictures of a busy machine may take this long.
constexpr Duration kAnswersWithin = std::chrono::milliseconds(500);
constexpr Duration kCycleEvery = std::chrono::milliseconds(10);  // a look at what is near costs milliseconds

std::vector<Tracker*> all_of(KeyboardMouse& keyboard, const std::vector<std::unique_ptr<Tracker>>& devices) {
  std::vector<Tracker*> out{&keyboard};
  for (const auto& device : devices) out.push_back(device.get());
  return out;
}

/// Each under a label of its own: a log tells news by label.
std::vector<SeatLine> missing_lines(const std::vector<AnyTracker::Missing>& missing) {
  std::vector<SeatLine> out;
  for (const AnyTracker::Missing& one : missing) {
    const std::string label = out.empty() ? "device" : "device " + std::to_string(out.size() + 1);
    SeatLine line{label, one.trouble, one.cure, one.drove ? Urgency::trouble : Urgency::note};
    if (line.words.empty()) line.words = one.device->name() + (one.drove ? " has gone" : " is not there");
    if (line.cure.empty()) line.cure = words_for(HandFault::device_gone).cure;
    out.push_back(std::move(line));
  }
  return out;
}

SeatLine keys_line(Duration late) {
  return {"keys",
          fmt::format("the switch did not count: a picture took {:.1f} s, and a key counts for {:.2f} s",
                      to_seconds(late), to_seconds(KeyboardMouseOptions{}.window_answers_within)),
          "let go, and press again; make the window smaller, or drive by another device", Urgency::trouble};
}

/// As of a device that is not there. Static texts.
TrackerState not_there(const char* trouble, const char* cure) {
  TrackerState out;
  out.trouble = trouble;
  out.cure = cure;
  return out;
}

}  // namespace

HandDriver::HandDriver(const Rig& rig, std::vector<std::unique_ptr<Tracker>> devices,
                       std::shared_ptr<const SceneModel> scene)
    : rig_(rig),
      options_(hand_options(rig)),
      guard_(options_.arm ? std::make_unique<ContactGuard>(rig, options_, std::move(scene)) : nullptr),
      hand_(options_, rig.name),
      devices_(std::move(devices)),
      any_(all_of(keyboard_, devices_)) {
  hand_.set_guard(guard_.get());
  for (const auto& device : devices_)
    if (auto* const sink = dynamic_cast<ForceSink*>(device.get()))
      pushing_.push_back({device.get(), BoundedForce(*sink)});
}

void HandDriver::take(const gl::WindowInput& input, OperatorTime now) {
  const std::lock_guard lock(mutex_);
  if (input.lost_focus) keyboard_.focus_lost();
  for (const auto& event : input.key_events)
    if (const auto key = hand_key(event.code)) keyboard_.key(*key, event.down);
  keyboard_.mouse_button(KeyboardMouse::MouseButton::left, input.left);
  keyboard_.mouse_button(KeyboardMouse::MouseButton::right, input.other);
  keyboard_.mouse_moved(input.moved_x, input.moved_y);
  keyboard_.wheel(input.scrolled);
  keyboard_.looked(now);
  looked_ = now;
  const bool any = !input.key_events.empty() || input.moved_x != 0 || input.moved_y != 0 || input.scrolled != 0;
  if (any && !event_) event_ = now;
}

void HandDriver::look_from(const Pose& T_world_camera) {
  const std::lock_guard lock(mutex_);
  T_world_camera_ = T_world_camera;
}

void HandDriver::look_within(const std::optional<Pose>& T_world_space) {
  const std::lock_guard lock(mutex_);
  T_world_space_ = T_world_space;
}

void HandDriver::interrupt(const char* trouble, const char* cure) {
  const std::lock_guard lock(mutex_);
  interruption_ = not_there(trouble, cure);
}

void HandDriver::may_push(std::span<const std::string> nodes) {
  const std::lock_guard lock(mutex_);
  if (guard_) guard_->may_push(nodes);
}

void HandDriver::scene_stands(std::span<const Pose> T_world_node) {
  const std::lock_guard lock(mutex_);
  if (guard_) guard_->scene_stands(T_world_node);
}

void HandDriver::ask(LineRequest request) {
  const std::lock_guard lock(mutex_);
  requests_.push_back(request);
}

void HandDriver::toggle_control() {
  const std::lock_guard lock(mutex_);
  control_ = !control_;
}

void HandDriver::hand_over() {
  const std::lock_guard lock(mutex_);
  hand_over_ = true;
}

SeatWish HandDriver::tick(const SeatView& view) {
  const std::lock_guard lock(mutex_);
  if (!cycled_ || view.now - *cycled_ >= kCycleEvery || view.now < *cycled_) cycle(view);
  SeatWish wish = wish_;
  // What somebody else was given is not asked for again. Nobody asked for it: it is still wanted.
  if (std::exchange(handed_over_, false) && !view.control.wanted) control_ = false;
  wish.control = control_;
  wish.hand_over = handed_over_ = std::exchange(hand_over_, false);
  if (!requests_.empty()) {
    wish.request = requests_.front();
    requests_.erase(requests_.begin());
  }
  return wish;
}

void HandDriver::heed_window(OperatorTime now) {
  if (now - *looked_ <= kAnswersWithin) return;
  interruption_ = not_there("the window does not answer", "wait until its picture moves; press the switch anew");
}

void HandDriver::cycle(const SeatView& view) {
  // Before the window's first look nobody sees the robot: a switch that is held by then is none that was pressed.
  if (!looked_) return;
  cycled_ = view.now;
  heed_window(view.now);
  HandInput input;
  input.now = view.now;
  input.device = any_.read(view.now);
  const auto interruption = std::exchange(interruption_, std::nullopt);
  interrupted_ = interruption.has_value();
  if (interruption) {
    input.device = *interruption;
    input.device.time = view.now;
  }
  input.robot = view.robot;
  // Of the same moment as the hand: a head that turns moves no tool.
  const auto& head = input.device.T_space_head;
  const bool within = T_world_space_ && head;  // keys mean what the camera sees
  hand_.settings().view_turns_with_head = within;
  const Pose T_world_view = within ? *T_world_space_ * *head * head::T_body_camera() : T_world_camera_;
  input.T_base_view = rig_.T_world_robot.inverse() * T_world_view;
  const HandCycle& cycle = hand_.cycle(input);
  wish_.deadman = cycle.deadman;
  wish_.refused = cycle.phase == HandPhase::refused || (keyboard_.has_to_let_go() && !cycle.deadman);
  wish_.position = cycle.positions;
  if (!pushing_.empty()) feel(view.now);
  if (const auto event = std::exchange(event_, std::nullopt)) input_took_ = view.now - *event;
}

/// What the tool leans on, or what the robot's gate keeps it from: back to where the tool is, then.
HandContact HandDriver::contact() const {
  if (!guard_) return {};
  const GhostHand& ghost = guard_->ghost();
  if (ghost.depth > 0) return {hand_.in_space(rig_.T_world_robot.linear().transpose() * ghost.out), ghost.depth, 0};
  if (ghost.reason != GhostReason::gate) return {};
  const Eigen::Vector3d back = hand_.last().T_base_tip.translation() - ghost.T_base_hand.translation();
  return {hand_.in_space(back), back.norm(), 0};
}

/// As whoever drives feels it.
void HandDriver::feel(OperatorTime now) {
  const HandContact felt = contact();
  for (Pushing& one : pushing_) {
    one.force.feel(now, felt);
    one.force.cycle(now, wish_.deadman && one.device == any_.in_charge());
  }
}

std::optional<Duration> HandDriver::input_took() const {
  const std::lock_guard lock(mutex_);
  return input_took_;
}

HandSight HandDriver::sight() const {
  const std::lock_guard lock(mutex_);
  const HandCycle& cycle = hand_.last();
  HandSight out;
  out.phase = cycle.phase;
  out.has_tool = options_.arm.has_value();
  out.mode = cycle.mode;
  out.joint = cycle.joint;
  if (cycle.T_base_target) out.T_world_hand = rig_.T_world_robot * *cycle.T_base_target;
  out.T_world_tool = rig_.T_world_robot * cycle.T_base_tip;
  out.joints = cycle.joints;
  out.positions = cycle.positions;
  out.follow = cycle.follow;
  out.follow_joint = cycle.follow_joint;
  if (guard_) out.touch = guard_->sight();
  if (cycle.joints > 0) out.limits = near_limits(options_, cycle.positions);
  return out;
}

std::vector<SeatLine> HandDriver::lines() const {
  const HandSight seen = sight();
  std::vector<SeatLine> out = hand_lines(seen, rig_.joint_names());
  const std::lock_guard lock(mutex_);
  const std::vector<AnyTracker::Missing> missing = any_.missing();
  std::vector<SeatLine> devices = missing_lines(missing);
  out.insert(out.begin(), std::make_move_iterator(devices.begin()), std::make_move_iterator(devices.end()));
  if (const auto late = looked_ ? keyboard_.held_in_vain(*looked_) : std::nullopt) out.push_back(keys_line(*late));
  // What touches is told by name.
  if (std::ranges::find(out, "hand", &SeatLine::label) != out.end()) return out;
  const HandCycle& cycle = hand_.last();
  const bool refused = cycle.phase == HandPhase::refused;
  // What interrupts a hand that holds no switch takes nothing from anybody.
  if (interrupted_ && !refused) return out;
  const bool is_named = std::ranges::any_of(missing, &AnyTracker::Missing::drove);
  if (is_named && cycle.fault == HandFault::device_gone) return out;
  const HandWords words = describe(cycle, options_.gate.joints);
  if (words.name.empty()) return out;
  out.insert(out.begin(), {"hand", words.name, words.cure, refused ? Urgency::trouble : Urgency::note});
  return out;
}

DrivenParts driven_parts(const Rig& rig) {
  const auto has = [&](JointGroup group) {
    return std::ranges::find(rig.joints, group, &RigJoint::group) != rig.joints.end();
  };
  return {has(JointGroup::gripper), has(JointGroup::pan_tilt)};
}

std::vector<std::pair<std::string, std::string>> HandDriver::keys(const DrivenParts& parts) {
  const auto printed = [](std::initializer_list<HandKey> keys) {
    std::string out;
    for (const HandKey key : keys)
      out += (out.empty() ? "" : " ") + std::string(key_bindings()[static_cast<std::size_t>(key)].printed);
    return out;
  };
  using enum HandKey;
  std::vector<std::pair<std::string, std::string>> out = {
      {printed({deadman}) + "; + " + printed({to_start}), "held: the robot moves; it goes to its start"},
      {"left button", "of the mouse, held: the robot moves, too"},
      {printed({slow}), "held: slowly"},
      {printed({forward, left, back, right, up, down}), "the tool: forward, left, back, right, up, down"},
      {printed({pitch_down, yaw_left, pitch_up, yaw_right, roll_left, roll_right}), "it turns"},
      {"mouse, wheel", "with its left button: the tool goes right, up; forward"},
      {"right button", "of the mouse, held with the left one: it turns"}};
  if (parts.head) out.emplace_back("arrows", "the camera");
  if (parts.gripper) out.emplace_back(printed({gripper_close, gripper_open}), "gripper closes, opens");
  out.emplace_back(printed({joint_mode}) + ", 1 .. 0, - =", "single joints, which one, to and fro");
  out.emplace_back(printed({recentre, home_view}), "forward is where you look; the view as it began");
  return out;
}

}  // namespace foresight
