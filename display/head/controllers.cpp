#include "display/head/controllers.hpp"

#include <cmath>
#include <cstring>

#include "display/head/xr_poses.hpp"
#include "input/rate_hand.hpp"

namespace foresight::head {
namespace {

constexpr double kPress = 0.6, kLetGo = 0.4;  // of a squeeze
constexpr double kStickDead = 0.15;

constexpr std::array kSides{"/user/hand/left", "/user/hand/right"};

XrPath path(XrInstance instance, const std::string& text) {
  XrPath out = XR_NULL_PATH;
  check(xrStringToPath(instance, text.c_str(), &out), "xrStringToPath");
  return out;
}

/// What each action is bound to, below /user/hand/left and /user/hand/right (OpenXR 1.0, section 6.4). Null: nothing.
struct Profile {
  const char* name;
  const char *squeeze, *trigger, *stick, *recentre;
  std::array<const char*, 2> home;  // left and right
};
constexpr std::array kProfiles{
    Profile{"khr/simple_controller", "select/click", nullptr, nullptr, "menu/click", {nullptr, nullptr}},
    Profile{"oculus/touch_controller",
            "squeeze/value",
            "trigger/value",
            "thumbstick",
            "thumbstick/click",
            {"x/click", "a/click"}},
    Profile{"valve/index_controller",
            "squeeze/value",
            "trigger/value",
            "thumbstick",
            "thumbstick/click",
            {"a/click", "a/click"}},
    Profile{"htc/vive_controller",
            "squeeze/click",
            "trigger/value",
            "trackpad",
            "trackpad/click",
            {"menu/click", "menu/click"}},
    Profile{"microsoft/motion_controller",
            "squeeze/click",
            "trigger/value",
            "thumbstick",
            "thumbstick/click",
            {"menu/click", "menu/click"}},
};

constexpr XrSpaceLocationFlags kValid = XR_SPACE_LOCATION_POSITION_VALID_BIT | XR_SPACE_LOCATION_ORIENTATION_VALID_BIT;
// What is only inferred (a hand behind the back) is no hand to follow.
constexpr XrSpaceLocationFlags kSeen =
    kValid | XR_SPACE_LOCATION_POSITION_TRACKED_BIT | XR_SPACE_LOCATION_ORIENTATION_TRACKED_BIT;

}  // namespace

bool squeezed(double squeeze, bool was) noexcept {
  return squeeze > (was ? kLetGo : kPress);
}

Controllers::Controllers(XrInstance instance, XrSession session) : instance_(instance), session_(session) {
  XrActionSetCreateInfo info{};
  info.type = XR_TYPE_ACTION_SET_CREATE_INFO;
  std::strcpy(info.actionSetName, "hands");
  std::strcpy(info.localizedActionSetName, "The operator's hands");
  check(xrCreateActionSet(instance, &info, &set_), "xrCreateActionSet");
  try {
    for (std::size_t i = 0; i < hands_.size(); ++i) hands_[i].path = path(instance, kSides[i]);
    grip_ = make(XR_ACTION_TYPE_POSE_INPUT, "grip", "Where the hand is");
    squeeze_ = make(XR_ACTION_TYPE_FLOAT_INPUT, "switch", "Held, the robot moves");
    trigger_ = make(XR_ACTION_TYPE_FLOAT_INPUT, "gripper", "The gripper");
    stick_ = make(XR_ACTION_TYPE_VECTOR2F_INPUT, "camera", "Turns the camera");
    recentre_ = make(XR_ACTION_TYPE_BOOLEAN_INPUT, "recentre", "Forward is where you look");
    home_ = make(XR_ACTION_TYPE_BOOLEAN_INPUT, "home_view", "The view as it began");
    suggest();
    XrSessionActionSetsAttachInfo attach{};
    attach.type = XR_TYPE_SESSION_ACTION_SETS_ATTACH_INFO;
    attach.countActionSets = 1;
    attach.actionSets = &set_;
    check(xrAttachSessionActionSets(session, &attach), "xrAttachSessionActionSets");
    for (Hand& hand : hands_) {
      XrActionSpaceCreateInfo space{};
      space.type = XR_TYPE_ACTION_SPACE_CREATE_INFO;
      space.action = grip_;
      space.subactionPath = hand.path;
      space.poseInActionSpace.orientation.w = 1;
      check(xrCreateActionSpace(session, &space, &hand.space), "xrCreateActionSpace");
    }
  } catch (...) {
    xrDestroyActionSet(set_);
    throw;
  }
}

Controllers::~Controllers() {
  for (const Hand& hand : hands_) xrDestroySpace(hand.space);
  xrDestroyActionSet(set_);
}

XrAction Controllers::make(XrActionType type, const char* name, const char* shown) {
  const std::array paths{hands_[0].path, hands_[1].path};
  XrActionCreateInfo info{};
  info.type = XR_TYPE_ACTION_CREATE_INFO;
  std::strncpy(info.actionName, name, XR_MAX_ACTION_NAME_SIZE - 1);
  std::strncpy(info.localizedActionName, shown, XR_MAX_LOCALIZED_ACTION_NAME_SIZE - 1);
  info.actionType = type;
  info.countSubactionPaths = static_cast<std::uint32_t>(paths.size());
  info.subactionPaths = paths.data();
  XrAction out = XR_NULL_HANDLE;
  check(xrCreateAction(set_, &info, &out), "xrCreateAction");
  return out;
}

void Controllers::suggest() const {
  for (const Profile& profile : kProfiles) {
    std::vector<XrActionSuggestedBinding> bindings;
    const auto bind = [&](XrAction action, std::size_t side, const char* input) {
      if (!input) return;
      bindings.push_back({action, path(instance_, std::string(kSides[side]) + "/input/" + input)});
    };
    for (std::size_t side = 0; side < kSides.size(); ++side) {
      bind(grip_, side, "grip/pose");
      bind(squeeze_, side, profile.squeeze);
      bind(trigger_, side, profile.trigger);
      bind(stick_, side, profile.stick);
      bind(recentre_, side, profile.recentre);
      bind(home_, side, profile.home[side]);
    }
    XrInteractionProfileSuggestedBinding suggestion{};
    suggestion.type = XR_TYPE_INTERACTION_PROFILE_SUGGESTED_BINDING;
    suggestion.interactionProfile = path(instance_, std::string("/interaction_profiles/") + profile.name);
    suggestion.countSuggestedBindings = static_cast<std::uint32_t>(bindings.size());
    suggestion.suggestedBindings = bindings.data();
    const XrResult result = xrSuggestInteractionProfileBindings(instance_, &suggestion);
    if (result != XR_ERROR_PATH_UNSUPPORTED) check(result, "xrSuggestInteractionProfileBindings");
  }
}

void Controllers::update(const Now& now, HeldControllers& out) {
  XrActiveActionSet active{set_, XR_NULL_PATH};
  XrActionsSyncInfo info{};
  info.type = XR_TYPE_ACTIONS_SYNC_INFO;
  info.countActiveActionSets = 1;
  info.activeActionSets = &active;
  check(xrSyncActions(session_, &info), "xrSyncActions");
  for (std::size_t i = 0; i < hands_.size(); ++i) out.hands[i].say(state_of(hands_[i], now));
}

std::optional<Pose> Controllers::seen_at(const Hand& hand, const Now& now) const {
  XrSpaceLocation place{};
  place.type = XR_TYPE_SPACE_LOCATION;
  check(xrLocateSpace(hand.space, now.space, now.display_time, &place), "xrLocateSpace");
  if ((place.locationFlags & kSeen) != kSeen || !now.poses_count) return std::nullopt;
  return pose_of(place.pose);
}

TrackerState Controllers::state_of(Hand& hand, const Now& now) {
  TrackerState out;
  out.time = now.time;
  out.T_space_head = now.T_space_head;
  const auto squeeze = value(squeeze_, hand);
  out.connected = now.focused && squeeze.has_value();
  if (!out.connected) {
    hand.held = false;
    out.trouble = now.focused ? "the controller is off" : "the headset shows a menu, or nobody wears it";
    out.cure = now.focused ? "switch it on" : "put it on, and close its menu";
    return out;
  }
  const auto T_space_hand = seen_at(hand, now);
  out.tracked = T_space_hand.has_value();
  if (T_space_hand) {
    out.T_space_hand = *T_space_hand;
  } else {
    out.trouble = "the headset does not see the hand";
    out.cure = "hold it where the headset sees it";
  }
  hand.held = squeezed(*squeeze, hand.held);
  out.buttons.set(TrackerButton::deadman, hand.held);
  out.buttons.set(TrackerButton::clutch, hand.held);
  out.buttons.set(TrackerButton::recentre, pressed(recentre_, hand));
  out.buttons.set(TrackerButton::home_view, pressed(home_, hand));
  if (const auto trigger = value(trigger_, hand); trigger && std::isfinite(*trigger))
    out.grip = std::clamp(*trigger, 0.0, 1.0);
  const Eigen::Vector2d stick = stick_of(hand);
  out.pan_rate = -without_dead_zone(stick.x(), kStickDead);
  out.tilt_rate = out.joint_rate = without_dead_zone(stick.y(), kStickDead);
  return out;
}

Eigen::Vector2d Controllers::stick_of(const Hand& hand) const {
  XrActionStateGetInfo info{XR_TYPE_ACTION_STATE_GET_INFO, nullptr, stick_, hand.path};
  XrActionStateVector2f state{};
  state.type = XR_TYPE_ACTION_STATE_VECTOR2F;
  check(xrGetActionStateVector2f(session_, &info, &state), "xrGetActionStateVector2f");
  if (!state.isActive) return {0, 0};
  return {state.currentState.x, state.currentState.y};
}

bool Controllers::pressed(XrAction action, const Hand& hand) const {
  XrActionStateGetInfo info{XR_TYPE_ACTION_STATE_GET_INFO, nullptr, action, hand.path};
  XrActionStateBoolean state{};
  state.type = XR_TYPE_ACTION_STATE_BOOLEAN;
  check(xrGetActionStateBoolean(session_, &info, &state), "xrGetActionStateBoolean");
  return state.isActive && state.currentState;
}

std::optional<double> Controllers::value(XrAction action, const Hand& hand) const {
  XrActionStateGetInfo info{XR_TYPE_ACTION_STATE_GET_INFO, nullptr, action, hand.path};
  XrActionStateFloat state{};
  state.type = XR_TYPE_ACTION_STATE_FLOAT;
  check(xrGetActionStateFloat(session_, &info, &state), "xrGetActionStateFloat");
  if (!state.isActive) return std::nullopt;
  return state.currentState;
}

}  // namespace foresight::head
