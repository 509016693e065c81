// How the OpenXR loader finds the runtime's functions (OpenXR loader specification 1.0, runtime interface version 1).
#include "tests/openxr_runtime/state.hpp"

namespace foresight::openxr_runtime {
namespace {

const Functions& functions() {
  static const Functions all = [] {
    Functions out;
    add_instance_functions(out);
    add_session_functions(out);
    add_frame_functions(out);
    add_swapchain_functions(out);
    add_action_functions(out);
    return out;
  }();
  return all;
}

// What the loader's own header would say; it is no part of the distribution's package.
enum class LoaderStructure : std::uint32_t { loader_info = 1, runtime_request = 3 };
struct LoaderInfo {
  LoaderStructure type;
  std::uint32_t version;
  std::size_t size;
  std::uint32_t least_interface, most_interface;
  XrVersion least_api, most_api;
};
struct RuntimeRequest {
  LoaderStructure type;
  std::uint32_t version;
  std::size_t size;
  std::uint32_t interface_version;
  XrVersion api_version;
  PFN_xrGetInstanceProcAddr get_function;
};

XRAPI_ATTR XrResult XRAPI_CALL get_function(XrInstance instance, const char* name, PFN_xrVoidFunction* out) {
  *out = nullptr;
  const std::string wanted = name;
  if (wanted == "xrGetInstanceProcAddr") {
    *out = as_void(get_function);
    return XR_SUCCESS;
  }
  const bool before_instance = wanted == "xrEnumerateInstanceExtensionProperties" || wanted == "xrCreateInstance";
  if (instance == XR_NULL_HANDLE && !before_instance) return XR_ERROR_HANDLE_INVALID;
  const auto found = functions().find(wanted);
  if (found == functions().end()) return XR_ERROR_FUNCTION_UNSUPPORTED;
  *out = found->second;
  return XR_SUCCESS;
}

}  // namespace

extern "C" __attribute__((visibility("default"))) XrResult xrNegotiateLoaderRuntimeInterface(const LoaderInfo* loader,
                                                                                             RuntimeRequest* request) {
  if (!loader || !request || loader->type != LoaderStructure::loader_info ||
      request->type != LoaderStructure::runtime_request || loader->least_interface > 1 || loader->most_interface < 1)
    return XR_ERROR_INITIALIZATION_FAILED;
  request->interface_version = 1;
  request->api_version = XR_MAKE_VERSION(1, 0, 20);
  request->get_function = get_function;
  return XR_SUCCESS;
}

}  // namespace foresight::openxr_runtime
