#include "display/head/xr_instance.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cstring>

#include "common/held_stderr.hpp"
#include "display/head/runtime_offer.hpp"

namespace foresight::head {
namespace {

constexpr const char* kEgl = "XR_MNDX_egl_enable";  // its name is given away only with EGL's own header

std::vector<XrExtensionProperties> offered() {
  const HeldStderr quiet;  // the loader tells at length what we say in a sentence
  XrExtensionProperties empty{};
  empty.type = XR_TYPE_EXTENSION_PROPERTIES;
  return listed<XrExtensionProperties>("xrEnumerateInstanceExtensionProperties", empty,
                                       [](std::uint32_t room, std::uint32_t* count, XrExtensionProperties* out) {
                                         return xrEnumerateInstanceExtensionProperties(nullptr, room, count, out);
                                       });
}

bool has(const std::vector<XrExtensionProperties>& all, const char* name) {
  return std::ranges::any_of(
      all, [name](const auto& one) { return std::strncmp(one.extensionName, name, XR_MAX_EXTENSION_NAME_SIZE) == 0; });
}

std::string text_of(const char* characters, std::size_t most) {
  return {characters, ::strnlen(characters, most)};
}

}  // namespace

RuntimeOffer ask_runtime() {
  RuntimeOffer out;
  try {
    const auto all = offered();
    out.there = true;
    out.opengl = has(all, XR_KHR_OPENGL_ENABLE_EXTENSION_NAME);
    out.egl = has(all, kEgl);
  } catch (const CallFailed&) {
    // No runtime: that is the answer.
  }
  return out;
}

Instance::Instance(ContextKind kind) {
  const auto all = offered();
  std::vector<const char*> extensions{XR_KHR_OPENGL_ENABLE_EXTENSION_NAME};
  if (kind == ContextKind::egl) extensions.push_back(kEgl);
  for (const char* name : extensions)
    if (!has(all, name)) throw CallFailed(XR_ERROR_EXTENSION_NOT_PRESENT, name);
  XrInstanceCreateInfo info{};
  info.type = XR_TYPE_INSTANCE_CREATE_INFO;
  std::strncpy(info.applicationInfo.applicationName, "Foresight", XR_MAX_APPLICATION_NAME_SIZE - 1);
  std::strncpy(info.applicationInfo.engineName, "Foresight", XR_MAX_ENGINE_NAME_SIZE - 1);
  info.applicationInfo.apiVersion = XR_MAKE_VERSION(1, 0, 0);
  info.enabledExtensionCount = static_cast<std::uint32_t>(extensions.size());
  info.enabledExtensionNames = extensions.data();
  {
    const HeldStderr quiet;
    check(xrCreateInstance(&info, &instance_), "xrCreateInstance");
  }
  XrInstanceProperties properties{};
  properties.type = XR_TYPE_INSTANCE_PROPERTIES;
  if (XR_FAILED(xrGetInstanceProperties(instance_, &properties))) return;
  const XrVersion version = properties.runtimeVersion;
  runtime_ = fmt::format("{} {}.{}.{}", text_of(properties.runtimeName, XR_MAX_RUNTIME_NAME_SIZE),
                         XR_VERSION_MAJOR(version), XR_VERSION_MINOR(version), XR_VERSION_PATCH(version));
}

Instance::~Instance() {
  xrDestroyInstance(instance_);
}

XrSystemId Instance::headset() const {
  XrSystemGetInfo info{};
  info.type = XR_TYPE_SYSTEM_GET_INFO;
  info.formFactor = XR_FORM_FACTOR_HEAD_MOUNTED_DISPLAY;
  XrSystemId out = XR_NULL_SYSTEM_ID;
  check(xrGetSystem(instance_, &info, &out), "xrGetSystem");
  return out;
}

void Instance::check_graphics(XrSystemId system) const {
  PFN_xrVoidFunction function = nullptr;
  check(xrGetInstanceProcAddr(instance_, "xrGetOpenGLGraphicsRequirementsKHR", &function), "xrGetInstanceProcAddr");
  XrGraphicsRequirementsOpenGLKHR needs{};
  needs.type = XR_TYPE_GRAPHICS_REQUIREMENTS_OPENGL_KHR;
  check(reinterpret_cast<PFN_xrGetOpenGLGraphicsRequirementsKHR>(function)(instance_, system, &needs),
        "xrGetOpenGLGraphicsRequirementsKHR");
  GLint major = 0, minor = 0;
  glGetIntegerv(GL_MAJOR_VERSION, &major);
  glGetIntegerv(GL_MINOR_VERSION, &minor);
  const XrVersion here = XR_MAKE_VERSION(static_cast<std::uint64_t>(major), static_cast<std::uint64_t>(minor), 0);
  if (needs.minApiVersionSupported > here)
    throw CallFailed(XR_ERROR_GRAPHICS_DEVICE_INVALID,
                     fmt::format("needs OpenGL {}.{}", XR_VERSION_MAJOR(needs.minApiVersionSupported),
                                 XR_VERSION_MINOR(needs.minApiVersionSupported)));
}

}  // namespace foresight::head
