// Instances, the headset as a system, events, paths.
#include <cstring>

#include "tests/openxr_runtime/state.hpp"

namespace foresight::openxr_runtime {
namespace {

constexpr XrSystemId kHeadset = 7;
constexpr const char* kEgl = "XR_MNDX_egl_enable";

XrResult problem(XrInstance instance, const char* call) {
  auto& s = here();
  if (s.instance == 0 || from_handle(instance) != s.instance)
    return s.refuse(XR_ERROR_HANDLE_INVALID, std::string(call) + ": no such instance");
  return s.instance_lost ? XR_ERROR_INSTANCE_LOST : XR_SUCCESS;
}

XrResult extensions(const char* layer, std::uint32_t room, std::uint32_t* count, XrExtensionProperties* out) {
  auto& s = here();
  const std::lock_guard lock(s.mutex);
  if (s.instance == 0) read_script(s);
  if (layer) return XR_ERROR_API_LAYER_NOT_PRESENT;
  std::vector<XrExtensionProperties> all;
  const auto add = [&](const char* name) {
    XrExtensionProperties one{};
    one.type = XR_TYPE_EXTENSION_PROPERTIES;
    one.extensionVersion = 1;
    std::strncpy(one.extensionName, name, XR_MAX_EXTENSION_NAME_SIZE - 1);
    all.push_back(one);
  };
  if (s.settings.opengl) add(XR_KHR_OPENGL_ENABLE_EXTENSION_NAME);
  if (s.settings.egl) add(kEgl);
  for (std::uint32_t i = 0; out && i < room; ++i)
    if (out[i].type != XR_TYPE_EXTENSION_PROPERTIES) return XR_ERROR_VALIDATION_FAILURE;
  return hand_out(all, room, count, out);
}

XrResult create_instance(const XrInstanceCreateInfo* info, XrInstance* out) {
  auto& s = here();
  const std::lock_guard lock(s.mutex);
  if (s.instance) return s.refuse(XR_ERROR_LIMIT_REACHED, "a second instance");
  read_script(s);
  if (XR_VERSION_MAJOR(info->applicationInfo.apiVersion) != 1) return XR_ERROR_API_VERSION_UNSUPPORTED;
  if (info->applicationInfo.applicationName[0] == 0) return s.refuse(XR_ERROR_NAME_INVALID, "a program without a name");
  bool opengl = false;
  s.egl_enabled = false;
  for (std::uint32_t i = 0; i < info->enabledExtensionCount; ++i) {
    const std::string name = info->enabledExtensionNames[i];
    const bool is_opengl = name == XR_KHR_OPENGL_ENABLE_EXTENSION_NAME, is_egl = name == kEgl;
    if ((!is_opengl || !s.settings.opengl) && (!is_egl || !s.settings.egl))
      return s.refuse(XR_ERROR_EXTENSION_NOT_PRESENT, "an extension that is not offered: " + name);
    opengl |= is_opengl;
    s.egl_enabled |= is_egl;
  }
  if (!opengl) return s.refuse(XR_ERROR_EXTENSION_NOT_PRESENT, "an instance without a graphics extension");
  s.instance = s.next_handle++;
  s.instance_lost = s.graphics_asked = false;
  s.events.clear();
  s.action_sets.clear();
  s.actions.clear();
  s.bindings.clear();
  s.attached.clear();
  ++s.counts.instances;
  *out = to_handle<XrInstance>(s.instance);
  return XR_SUCCESS;
}

XrResult destroy_instance(XrInstance instance) {
  auto& s = here();
  const std::lock_guard lock(s.mutex);
  if (const XrResult wrong = problem(instance, "xrDestroyInstance"); wrong == XR_ERROR_HANDLE_INVALID) return wrong;
  if (s.session) s.complaints.push_back("xrDestroyInstance: its session was not destroyed before");
  s.instance = s.session = 0;
  s.instance_lost = s.session_lost = false;
  return XR_SUCCESS;
}

XrResult instance_properties(XrInstance instance, XrInstanceProperties* out) {
  auto& s = here();
  const std::lock_guard lock(s.mutex);
  if (const XrResult wrong = problem(instance, "xrGetInstanceProperties"); XR_FAILED(wrong)) return wrong;
  out->runtimeVersion = XR_MAKE_VERSION(0, 1, 0);
  std::strcpy(out->runtimeName, "test runtime");
  return XR_SUCCESS;
}

XrResult get_system(XrInstance instance, const XrSystemGetInfo* info, XrSystemId* out) {
  auto& s = here();
  const std::lock_guard lock(s.mutex);
  if (const XrResult wrong = problem(instance, "xrGetSystem"); XR_FAILED(wrong)) return wrong;
  if (info->formFactor != XR_FORM_FACTOR_HEAD_MOUNTED_DISPLAY) return XR_ERROR_FORM_FACTOR_UNSUPPORTED;
  if (!s.settings.headset) return XR_ERROR_FORM_FACTOR_UNAVAILABLE;
  *out = kHeadset;
  return XR_SUCCESS;
}

XrResult system_properties(XrInstance instance, XrSystemId system, XrSystemProperties* out) {
  auto& s = here();
  const std::lock_guard lock(s.mutex);
  if (const XrResult wrong = problem(instance, "xrGetSystemProperties"); XR_FAILED(wrong)) return wrong;
  if (system != kHeadset) return s.refuse(XR_ERROR_SYSTEM_INVALID, "xrGetSystemProperties: no such system");
  out->systemId = kHeadset;
  out->vendorId = 0;
  std::strcpy(out->systemName, "simulated headset");
  out->graphicsProperties = {4096, 4096, 16};
  out->trackingProperties = {XR_TRUE, XR_TRUE};
  return XR_SUCCESS;
}

XrResult blend_modes(XrInstance instance, XrSystemId, XrViewConfigurationType, std::uint32_t room, std::uint32_t* count,
                     XrEnvironmentBlendMode* out) {
  auto& s = here();
  const std::lock_guard lock(s.mutex);
  if (const XrResult wrong = problem(instance, "xrEnumerateEnvironmentBlendModes"); XR_FAILED(wrong)) return wrong;
  return hand_out<XrEnvironmentBlendMode>({XR_ENVIRONMENT_BLEND_MODE_OPAQUE}, room, count, out);
}

XrResult view_configurations(XrInstance instance, XrSystemId, std::uint32_t room, std::uint32_t* count,
                             XrViewConfigurationType* out) {
  auto& s = here();
  const std::lock_guard lock(s.mutex);
  if (const XrResult wrong = problem(instance, "xrEnumerateViewConfigurations"); XR_FAILED(wrong)) return wrong;
  return hand_out<XrViewConfigurationType>({XR_VIEW_CONFIGURATION_TYPE_PRIMARY_STEREO}, room, count, out);
}

XrResult view_configuration_views(XrInstance instance, XrSystemId, XrViewConfigurationType type, std::uint32_t room,
                                  std::uint32_t* count, XrViewConfigurationView* out) {
  auto& s = here();
  const std::lock_guard lock(s.mutex);
  if (const XrResult wrong = problem(instance, "xrEnumerateViewConfigurationViews"); XR_FAILED(wrong)) return wrong;
  if (type != XR_VIEW_CONFIGURATION_TYPE_PRIMARY_STEREO) return XR_ERROR_VIEW_CONFIGURATION_TYPE_UNSUPPORTED;
  const XrViewConfigurationView view{
      XR_TYPE_VIEW_CONFIGURATION_VIEW, nullptr, s.settings.width, 4096, s.settings.height, 4096, 1, 1};
  return hand_out<XrViewConfigurationView>({view, view}, room, count, out);
}

XrResult requirements(XrInstance instance, XrSystemId system, XrGraphicsRequirementsOpenGLKHR* out) {
  auto& s = here();
  const std::lock_guard lock(s.mutex);
  if (const XrResult wrong = problem(instance, "xrGetOpenGLGraphicsRequirementsKHR"); XR_FAILED(wrong)) return wrong;
  if (system != kHeadset) return XR_ERROR_SYSTEM_INVALID;
  out->minApiVersionSupported = XR_MAKE_VERSION(4, 0, 0);
  out->maxApiVersionSupported = XR_MAKE_VERSION(4, 6, 0);
  s.graphics_asked = true;
  return XR_SUCCESS;
}

XrResult poll_event(XrInstance instance, XrEventDataBuffer* out) {
  auto& s = here();
  const std::lock_guard lock(s.mutex);
  if (const XrResult wrong = problem(instance, "xrPollEvent"); XR_FAILED(wrong)) return wrong;
  if (out->type != XR_TYPE_EVENT_DATA_BUFFER)
    return s.refuse(XR_ERROR_VALIDATION_FAILURE, "xrPollEvent: the buffer's type was not set");
  if (s.events.empty()) return XR_EVENT_UNAVAILABLE;
  *out = s.events.front();
  s.events.pop_front();
  return XR_SUCCESS;
}

XrResult result_to_string(XrInstance, XrResult value, char out[XR_MAX_RESULT_STRING_SIZE]) {
  std::snprintf(out, XR_MAX_RESULT_STRING_SIZE, "result %d", static_cast<int>(value));
  return XR_SUCCESS;
}

XrResult structure_to_string(XrInstance, XrStructureType value, char out[XR_MAX_STRUCTURE_NAME_SIZE]) {
  std::snprintf(out, XR_MAX_STRUCTURE_NAME_SIZE, "structure %d", static_cast<int>(value));
  return XR_SUCCESS;
}

XrResult string_to_path(XrInstance instance, const char* text, XrPath* out) {
  auto& s = here();
  const std::lock_guard lock(s.mutex);
  if (const XrResult wrong = problem(instance, "xrStringToPath"); XR_FAILED(wrong)) return wrong;
  const std::string path = text;
  if (path.empty() || path[0] != '/' ||
      path.find_first_not_of("abcdefghijklmnopqrstuvwxyz0123456789-_./") < path.size())
    return s.refuse(XR_ERROR_PATH_FORMAT_INVALID, "no path: " + path);
  for (std::size_t i = 0; i < s.paths.size(); ++i) {
    *out = i + 1;
    if (s.paths[i] == path) return XR_SUCCESS;
  }
  s.paths.push_back(path);
  *out = s.paths.size();
  return XR_SUCCESS;
}

XrResult path_to_string(XrInstance instance, XrPath path, std::uint32_t room, std::uint32_t* count, char* out) {
  auto& s = here();
  const std::lock_guard lock(s.mutex);
  if (const XrResult wrong = problem(instance, "xrPathToString"); XR_FAILED(wrong)) return wrong;
  if (path == 0 || path > s.paths.size()) return XR_ERROR_PATH_INVALID;
  const std::string& text = s.paths[path - 1];
  return hand_out(std::vector<char>(text.c_str(), text.c_str() + text.size() + 1), room, count, out);
}

}  // namespace

void add_instance_functions(Functions& out) {
  out["xrEnumerateInstanceExtensionProperties"] = as_void(extensions);
  out["xrCreateInstance"] = as_void(create_instance);
  out["xrDestroyInstance"] = as_void(destroy_instance);
  out["xrGetInstanceProperties"] = as_void(instance_properties);
  out["xrGetSystem"] = as_void(get_system);
  out["xrGetSystemProperties"] = as_void(system_properties);
  out["xrEnumerateEnvironmentBlendModes"] = as_void(blend_modes);
  out["xrEnumerateViewConfigurations"] = as_void(view_configurations);
  out["xrEnumerateViewConfigurationViews"] = as_void(view_configuration_views);
  out["xrGetOpenGLGraphicsRequirementsKHR"] = as_void(requirements);
  out["xrPollEvent"] = as_void(poll_event);
  out["xrResultToString"] = as_void(result_to_string);
  out["xrStructureTypeToString"] = as_void(structure_to_string);
  out["xrStringToPath"] = as_void(string_to_path);
  out["xrPathToString"] = as_void(path_to_string);
}

}  // namespace foresight::openxr_runtime
