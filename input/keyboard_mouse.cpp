#include "input/keyboard_mouse.hpp"

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace foresight {
namespace {

constexpr double kMouseLeads = 0.1;  // s of full speed that the mouse may be ahead of the hand; the rest is dropped

constexpr std::array<KeyBinding, kHandKeys> kBindings{{
    {HandKey::forward, GLFW_KEY_W, "W", "forward"},
    {HandKey::back, GLFW_KEY_S, "S", "back"},
    {HandKey::left, GLFW_KEY_A, "A", "left"},
    {HandKey::right, GLFW_KEY_D, "D", "right"},
    {HandKey::up, GLFW_KEY_R, "R", "up"},
    {HandKey::down, GLFW_KEY_F, "F", "down"},
    {HandKey::pitch_down, GLFW_KEY_I, "I", "tip down"},
    {HandKey::pitch_up, GLFW_KEY_K, "K", "tip up"},
    {HandKey::yaw_left, GLFW_KEY_J, "J", "turn left"},
    {HandKey::yaw_right, GLFW_KEY_L, "L", "turn right"},
    {HandKey::roll_left, GLFW_KEY_U, "U", "roll left"},
    {HandKey::roll_right, GLFW_KEY_O, "O", "roll right"},
    {HandKey::pan_left, GLFW_KEY_LEFT, "left", "camera left"},
    {HandKey::pan_right, GLFW_KEY_RIGHT, "right", "camera right"},
    {HandKey::tilt_up, GLFW_KEY_UP, "up", "camera up"},
    {HandKey::tilt_down, GLFW_KEY_DOWN, "down", "camera down"},
    {HandKey::deadman, GLFW_KEY_LEFT_SHIFT, "left shift", "hold to move the robot"},
    {HandKey::slow, GLFW_KEY_LEFT_CONTROL, "left control", "hold to move slowly"},
    {HandKey::gripper_close, GLFW_KEY_C, "C", "close the gripper"},
    {HandKey::gripper_open, GLFW_KEY_V, "V", "open the gripper"},
    {HandKey::home_view, GLFW_KEY_HOME, "Home", "the view as it began"},
    {HandKey::recentre, GLFW_KEY_N, "N", "forward is where you look now"},
    {HandKey::joint_mode, GLFW_KEY_M, "M", "move single joints, or the tool"},
    {HandKey::joint_less, GLFW_KEY_MINUS, "-", "move the joint back"},
    {HandKey::joint_more, GLFW_KEY_EQUAL, "=", "move the joint on"},
    {HandKey::to_start, GLFW_KEY_ENTER, "Enter", "hold to go to the start position"},
    {HandKey::joint_1, GLFW_KEY_1, "1", "the first joint"},
    {HandKey::joint_2, GLFW_KEY_2, "2", "the second joint"},
    {HandKey::joint_3, GLFW_KEY_3, "3", "the third joint"},
    {HandKey::joint_4, GLFW_KEY_4, "4", "the fourth joint"},
    {HandKey::joint_5, GLFW_KEY_5, "5", "the fifth joint"},
    {HandKey::joint_6, GLFW_KEY_6, "6", "the sixth joint"},
    {HandKey::joint_7, GLFW_KEY_7, "7", "the seventh joint"},
    {HandKey::joint_8, GLFW_KEY_8, "8", "the eighth joint"},
    {HandKey::joint_9, GLFW_KEY_9, "9", "the ninth joint"},
    {HandKey::joint_10, GLFW_KEY_0, "0", "the tenth joint"},
}};

constexpr bool in_order() {
  for (std::size_t i = 0; i < kHandKeys; ++i)
    if (static_cast<std::size_t>(kBindings[i].key) != i) return false;
  return true;
}
static_assert(in_order());

// What of `left` goes within the step, at no more than `speed`, as a share of it.
Eigen::Vector3d take_share(Eigen::Vector3d& left, double speed, double seconds) noexcept {
  const double most = speed * kMouseLeads, wanted = left.norm(), room = speed * seconds;
  if (wanted > most) left *= most / wanted;
  if (!(room > 0) || !(wanted > 0)) return Eigen::Vector3d::Zero();
  const Eigen::Vector3d goes = left * std::min(1.0, room / left.norm());
  left -= goes;
  return goes / room;
}

}  // namespace

std::span<const KeyBinding> key_bindings() noexcept {
  return kBindings;
}

std::optional<HandKey> hand_key(int glfw_code) noexcept {
  const auto found = std::ranges::find(kBindings, glfw_code, &KeyBinding::code);
  if (found == kBindings.end()) return std::nullopt;
  return found->key;
}

void KeyboardMouse::change(bool& is_down, bool down) noexcept {
  const bool was_held = held();
  is_down = down;
  let_go_ = let_go_ || (was_held && !held());
}

void KeyboardMouse::release_all() noexcept {
  let_go_ = let_go_ || held();
  down_.fill(false);
  tapped_.fill(false);
  mouse_.fill(false);
  way_.setZero();
  turn_.setZero();
}

void KeyboardMouse::key(HandKey key, bool down) noexcept {
  change(down_[static_cast<std::size_t>(key)], down);
  if (key == HandKey::deadman) is_in_vain_ = false;
  if (down) tapped_[static_cast<std::size_t>(key)] = true;
  if (down && key >= HandKey::joint_1)
    joint_ = static_cast<std::size_t>(key) - static_cast<std::size_t>(HandKey::joint_1);
}

void KeyboardMouse::mouse_button(MouseButton button, bool down) noexcept {
  const auto i = static_cast<std::size_t>(button);
  if (std::exchange(mouse_told_[i], down) == down) return;
  change(mouse_[i], down);
  if (button == MouseButton::left) is_in_vain_ = false;
}

void KeyboardMouse::mouse_moved(double right_px, double down_px) noexcept {
  if (!mouse_[0] || !std::isfinite(right_px) || !std::isfinite(down_px)) return;
  const double scale = down(HandKey::slow) ? options_.slow : 1;
  if (mouse_[1])
    turn_ += scale * options_.rad_per_px * Eigen::Vector3d(0, down_px, -right_px);
  else
    way_ += scale * options_.metres_per_px * Eigen::Vector3d(0, -right_px, -down_px);
}

void KeyboardMouse::wheel(double notches) noexcept {
  if (!mouse_[0] || !std::isfinite(notches)) return;
  way_.x() += (down(HandKey::slow) ? options_.slow : 1) * options_.metres_per_notch * notches;
}

void KeyboardMouse::focus_lost() noexcept {
  is_in_vain_ = false;  // that it is let go of may not be told
  release_all();
}

// A window that draws ten pictures a second tells of a short press and of its end at once.
bool KeyboardMouse::take_tap(HandKey key) noexcept {
  const bool tapped = std::exchange(tapped_[static_cast<std::size_t>(key)], false);
  return down(key) || tapped;
}

double KeyboardMouse::way(HandKey more, HandKey less) const noexcept {
  return (down(more) ? 1.0 : 0.0) - (down(less) ? 1.0 : 0.0);
}

HandRate KeyboardMouse::rate_of_keys() const noexcept {
  const double scale = down(HandKey::slow) ? options_.slow : 1;
  HandRate out;
  out.linear = scale * Eigen::Vector3d(way(HandKey::forward, HandKey::back), way(HandKey::left, HandKey::right),
                                       way(HandKey::up, HandKey::down));
  out.angular =
      scale * Eigen::Vector3d(way(HandKey::roll_right, HandKey::roll_left), way(HandKey::pitch_down, HandKey::pitch_up),
                              way(HandKey::yaw_left, HandKey::yaw_right));
  return out;
}

HandRate KeyboardMouse::take_mouse(double seconds) noexcept {
  if (!mouse_[0]) {
    way_.setZero();
    turn_.setZero();
  }
  return {take_share(way_, options_.hand.speed, seconds), take_share(turn_, options_.hand.turn, seconds)};
}

void KeyboardMouse::looked(OperatorTime now) noexcept {
  if (std::exchange(was_in_vain_, false)) late_ = {now, now - *looked_};
  looked_ = now;
}

std::optional<Duration> KeyboardMouse::held_in_vain(OperatorTime now) const noexcept {
  return late_ && (is_in_vain_ || now - late_->at < kToldFor) ? std::optional(late_->after) : std::nullopt;
}

TrackerState KeyboardMouse::read(OperatorTime now) noexcept {
  if (!looked_ || now - *looked_ > options_.window_answers_within) {
    was_in_vain_ = was_in_vain_ || (looked_ && held());
    is_in_vain_ = is_in_vain_ || was_in_vain_;
    release_all();
  }
  TrackerState out;
  out.connected = out.tracked = out.integrated = true;
  out.time = now;
  HandRate rate = rate_of_keys();
  const double passed = read_ && now > *read_ ? to_seconds(std::min(now - *read_, options_.hand.longest_step)) : 0;
  read_ = now;
  const HandRate mouse = take_mouse(passed);
  rate.linear += mouse.linear;
  rate.angular += mouse.angular;
  out.T_space_hand = hand_.step(now, rate);
  const auto set = [&](TrackerButton button, bool held) { out.buttons.set(button, held); };
  const bool switch_held = !std::exchange(let_go_, false) && held();
  set(TrackerButton::deadman, switch_held);
  set(TrackerButton::clutch, switch_held);
  set(TrackerButton::gripper_close, down(HandKey::gripper_close));
  set(TrackerButton::gripper_open, down(HandKey::gripper_open));
  set(TrackerButton::to_start, down(HandKey::to_start));
  set(TrackerButton::home_view, take_tap(HandKey::home_view));
  set(TrackerButton::recentre, take_tap(HandKey::recentre));
  set(TrackerButton::joint_mode, take_tap(HandKey::joint_mode));
  const double scale = down(HandKey::slow) ? options_.slow : 1;
  out.joint = joint_;
  out.joint_rate = scale * way(HandKey::joint_more, HandKey::joint_less);
  out.pan_rate = scale * way(HandKey::pan_left, HandKey::pan_right);
  out.tilt_rate = scale * way(HandKey::tilt_up, HandKey::tilt_down);
  joint_.reset();
  return out;
}

}  // namespace foresight
