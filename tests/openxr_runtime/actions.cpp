// Actions: suggested, attached, synchronised, read. What each controller has is written down here once more, so that a
// mistake in the program's own table shows.
#include <algorithm>
#include <cstring>
#include <string_view>

#include "tests/openxr_runtime/state.hpp"

namespace foresight::openxr_runtime {
namespace {

// OpenXR 1.0, section 6.4: below /user/hand/*; "L:" and "R:" on one side only.
const std::map<std::string, std::vector<std::string>>& known_inputs() {
  static const std::map<std::string, std::vector<std::string>> all{
      {"/interaction_profiles/khr/simple_controller",
       {"input/select/click", "input/menu/click", "input/grip/pose", "input/aim/pose", "output/haptic"}},
      {"/interaction_profiles/oculus/touch_controller",
       {"L:input/x/click",        "L:input/x/touch",        "L:input/y/click",       "L:input/y/touch",
        "L:input/menu/click",     "R:input/a/click",        "R:input/a/touch",       "R:input/b/click",
        "R:input/b/touch",        "R:input/system/click",   "input/squeeze/value",   "input/trigger/value",
        "input/trigger/touch",    "input/thumbstick",       "input/thumbstick/x",    "input/thumbstick/y",
        "input/thumbstick/click", "input/thumbstick/touch", "input/thumbrest/touch", "input/grip/pose",
        "input/aim/pose",         "output/haptic"}},
      {"/interaction_profiles/valve/index_controller",
       {"input/system/click", "input/a/click", "input/b/click", "input/squeeze/value", "input/squeeze/force",
        "input/trigger/click", "input/trigger/value", "input/trigger/touch", "input/thumbstick",
        "input/thumbstick/click", "input/thumbstick/touch", "input/trackpad", "input/trackpad/force", "input/grip/pose",
        "input/aim/pose", "output/haptic"}},
      {"/interaction_profiles/htc/vive_controller",
       {"input/system/click", "input/squeeze/click", "input/menu/click", "input/trigger/click", "input/trigger/value",
        "input/trackpad", "input/trackpad/click", "input/trackpad/touch", "input/grip/pose", "input/aim/pose",
        "output/haptic"}},
      {"/interaction_profiles/microsoft/motion_controller",
       {"input/menu/click", "input/squeeze/click", "input/trigger/value", "input/thumbstick", "input/thumbstick/click",
        "input/trackpad", "input/trackpad/click", "input/trackpad/touch", "input/grip/pose", "input/aim/pose",
        "output/haptic"}},
  };
  return all;
}

constexpr std::array<std::string_view, 2> kSides{"/user/hand/left/", "/user/hand/right/"};

bool known(const std::string& profile, const std::string& path, Binding& out) {
  for (std::size_t side = 0; side < 2; ++side) {
    if (!path.starts_with(kSides[side])) continue;
    out.input = path.substr(kSides[side].size());
    out.side = static_cast<int>(side);
    const auto& inputs = known_inputs().at(profile);
    const std::string here_only = (side == 0 ? "L:" : "R:") + out.input;
    return std::ranges::find(inputs, out.input) != inputs.end() || std::ranges::find(inputs, here_only) != inputs.end();
  }
  return false;
}

XrResult create_set(XrInstance instance, const XrActionSetCreateInfo* info, XrActionSet* out) {
  auto& s = here();
  const std::lock_guard lock(s.mutex);
  if (from_handle(instance) != s.instance) return s.refuse(XR_ERROR_HANDLE_INVALID, "xrCreateActionSet: instance");
  if (info->actionSetName[0] == 0 || info->localizedActionSetName[0] == 0)
    return s.refuse(XR_ERROR_NAME_INVALID, "xrCreateActionSet: no name");
  s.action_sets.insert(s.next_handle);
  *out = to_handle<XrActionSet>(s.next_handle++);
  return XR_SUCCESS;
}

XrResult destroy_set(XrActionSet set) {
  auto& s = here();
  const std::lock_guard lock(s.mutex);
  if (s.action_sets.erase(from_handle(set)) == 0)
    return s.refuse(XR_ERROR_HANDLE_INVALID, "xrDestroyActionSet: no such set");
  std::erase_if(s.actions, [&](const auto& one) { return one.second.set == from_handle(set); });
  s.bindings.clear();
  return XR_SUCCESS;
}

XrResult create_action(XrActionSet set, const XrActionCreateInfo* info, XrAction* out) {
  auto& s = here();
  const std::lock_guard lock(s.mutex);
  if (!s.action_sets.contains(from_handle(set)))
    return s.refuse(XR_ERROR_HANDLE_INVALID, "xrCreateAction: no such set");
  if (s.attached.contains(from_handle(set)))
    return s.refuse(XR_ERROR_ACTIONSETS_ALREADY_ATTACHED, "xrCreateAction: its set is attached");
  const std::string name = info->actionName;
  if (name.empty() || name.find_first_not_of("abcdefghijklmnopqrstuvwxyz0123456789-_.") < name.size())
    return s.refuse(XR_ERROR_PATH_FORMAT_INVALID, "xrCreateAction: the name " + name);
  if (info->localizedActionName[0] == 0)
    return s.refuse(XR_ERROR_LOCALIZED_NAME_INVALID, "xrCreateAction: no localised name");
  s.actions[s.next_handle] = {info->actionType, from_handle(set)};
  *out = to_handle<XrAction>(s.next_handle++);
  return XR_SUCCESS;
}

XrResult suggest(XrInstance, const XrInteractionProfileSuggestedBinding* info) {
  auto& s = here();
  const std::lock_guard lock(s.mutex);
  if (!s.attached.empty()) return s.refuse(XR_ERROR_ACTIONSETS_ALREADY_ATTACHED, "bindings after sets were attached");
  if (info->interactionProfile == 0 || info->interactionProfile > s.paths.size())
    return s.refuse(XR_ERROR_PATH_INVALID, "bindings of no profile");
  const std::string& profile = s.paths[info->interactionProfile - 1];
  if (!known_inputs().contains(profile)) return s.refuse(XR_ERROR_PATH_UNSUPPORTED, "no such profile: " + profile);
  std::vector<Binding> all;
  for (std::uint32_t i = 0; i < info->countSuggestedBindings; ++i) {
    const auto& given = info->suggestedBindings[i];
    Binding binding;
    binding.action = from_handle(given.action);
    if (!s.actions.contains(binding.action)) return s.refuse(XR_ERROR_HANDLE_INVALID, "a binding of no action");
    if (given.binding == 0 || given.binding > s.paths.size() || !known(profile, s.paths[given.binding - 1], binding))
      return s.refuse(XR_ERROR_PATH_UNSUPPORTED,
                      profile + " has no " + (given.binding <= s.paths.size() ? s.paths[given.binding - 1] : ""));
    all.push_back(binding);
  }
  s.bindings[profile] = all;
  return XR_SUCCESS;
}

XrResult attach(XrSession session, const XrSessionActionSetsAttachInfo* info) {
  auto& s = here();
  const std::lock_guard lock(s.mutex);
  if (const XrResult wrong = s.session_problem(session, "xrAttachSessionActionSets"); XR_FAILED(wrong)) return wrong;
  if (!s.attached.empty()) return s.refuse(XR_ERROR_ACTIONSETS_ALREADY_ATTACHED, "sets are attached twice");
  for (std::uint32_t i = 0; i < info->countActionSets; ++i) s.attached.insert(from_handle(info->actionSets[i]));
  return XR_SUCCESS;
}

XrResult sync(XrSession session, const XrActionsSyncInfo* info) {
  auto& s = here();
  const std::lock_guard lock(s.mutex);
  if (const XrResult wrong = s.session_problem(session, "xrSyncActions"); XR_FAILED(wrong)) return wrong;
  for (std::uint32_t i = 0; i < info->countActiveActionSets; ++i)
    if (!s.attached.contains(from_handle(info->activeActionSets[i].actionSet)))
      return s.refuse(XR_ERROR_ACTIONSET_NOT_ATTACHED, "xrSyncActions: a set that is not attached");
  s.synced = s.session_state == XR_SESSION_STATE_FOCUSED;
  return s.synced ? XR_SUCCESS : XR_SESSION_NOT_FOCUSED;
}

struct Reading {
  bool active = false;
  float x = 0, y = 0;
};

Reading value_of(const SimulatedController& hand, const std::string& input) {
  if (input.ends_with("squeeze/value") || input.ends_with("squeeze/click")) return {true, hand.squeeze, 0};
  if (input.ends_with("select/click")) return {true, hand.squeeze > 0.5f ? 1.0f : 0.0f, 0};
  if (input.ends_with("trigger/value")) return {true, hand.trigger, 0};
  if (input.ends_with("thumbstick") || input.ends_with("trackpad")) return {true, hand.stick_x, hand.stick_y};
  if (input.ends_with("thumbstick/click") || input.ends_with("trackpad/click"))
    return {true, hand.stick_pressed ? 1.0f : 0.0f, 0};
  if (input.ends_with("menu/click")) return {true, hand.menu ? 1.0f : 0.0f, 0};
  return {true, hand.first_button ? 1.0f : 0.0f, 0};
}

XrResult read(XrSession session, const XrActionStateGetInfo* info, XrActionType type, Reading& out) {
  auto& s = here();
  if (const XrResult wrong = s.session_problem(session, "xrGetActionState"); XR_FAILED(wrong)) return wrong;
  const auto action = s.actions.find(from_handle(info->action));
  if (action == s.actions.end()) return s.refuse(XR_ERROR_HANDLE_INVALID, "xrGetActionState: no such action");
  if (action->second.type != type) return s.refuse(XR_ERROR_ACTION_TYPE_MISMATCH, "xrGetActionState: of another type");
  if (!s.attached.contains(action->second.set))
    return s.refuse(XR_ERROR_ACTIONSET_NOT_ATTACHED, "xrGetActionState: not attached");
  if (!s.synced || s.frames.empty()) return XR_SUCCESS;
  const World& world = s.frames.back().world;
  for (const Binding& binding : s.bindings[s.settings.profile]) {
    const bool this_side =
        s.paths[info->subactionPath - 1] == (binding.side == 0 ? "/user/hand/left" : "/user/hand/right");
    const SimulatedController& hand = world.hands[static_cast<std::size_t>(binding.side)];
    if (binding.action == action->first && this_side && hand.on) out = value_of(hand, binding.input);
  }
  return XR_SUCCESS;
}

XrResult read_float(XrSession session, const XrActionStateGetInfo* info, XrActionStateFloat* out) {
  const std::lock_guard lock(here().mutex);
  Reading reading;
  const XrResult result = read(session, info, XR_ACTION_TYPE_FLOAT_INPUT, reading);
  out->currentState = reading.x;
  out->isActive = reading.active;
  return result;
}

XrResult read_boolean(XrSession session, const XrActionStateGetInfo* info, XrActionStateBoolean* out) {
  const std::lock_guard lock(here().mutex);
  Reading reading;
  const XrResult result = read(session, info, XR_ACTION_TYPE_BOOLEAN_INPUT, reading);
  out->currentState = reading.x > 0.5f;
  out->isActive = reading.active;
  return result;
}

XrResult read_vector(XrSession session, const XrActionStateGetInfo* info, XrActionStateVector2f* out) {
  const std::lock_guard lock(here().mutex);
  Reading reading;
  const XrResult result = read(session, info, XR_ACTION_TYPE_VECTOR2F_INPUT, reading);
  out->currentState = {reading.x, reading.y};
  out->isActive = reading.active;
  return result;
}

}  // namespace

void add_action_functions(Functions& out) {
  out["xrCreateActionSet"] = as_void(create_set);
  out["xrDestroyActionSet"] = as_void(destroy_set);
  out["xrCreateAction"] = as_void(create_action);
  out["xrSuggestInteractionProfileBindings"] = as_void(suggest);
  out["xrAttachSessionActionSets"] = as_void(attach);
  out["xrSyncActions"] = as_void(sync);
  out["xrGetActionStateFloat"] = as_void(read_float);
  out["xrGetActionStateBoolean"] = as_void(read_boolean);
  out["xrGetActionStateVector2f"] = as_void(read_vector);
}

}  // namespace foresight::openxr_runtime
