// A layer between program and validation layer. Debian's validation layer refuses sessions on EGL, as it was built
// without XR_MNDX_egl_enable's binding: it is told of one of GLX, and the runtime of the true one, which it checks
// itself.
#include "tests/openxr_runtime/graphics.hpp"
#include "tests/openxr_runtime/state.hpp"

namespace foresight::openxr_runtime {
namespace {

// As in loader.cpp: what the loader's own header would say (OpenXR loader specification 1.0, layer interface version
// 1).
enum class LayerStructure : std::uint32_t { loader_info = 1, layer_request = 2 };
struct LayerNext;
struct LayerCreate;
using CreateLayerInstance = XrResult (*)(const XrInstanceCreateInfo*, const LayerCreate*, XrInstance*);
struct LayerRequest {
  LayerStructure type;
  std::uint32_t version;
  std::size_t size;
  std::uint32_t interface_version;
  XrVersion api_version;
  PFN_xrGetInstanceProcAddr get_function;
  CreateLayerInstance create_instance;
};
struct LayerNext {
  LayerStructure type;
  std::uint32_t version;
  std::size_t size;
  char name[XR_MAX_API_LAYER_NAME_SIZE];
  PFN_xrGetInstanceProcAddr get_function;
  CreateLayerInstance create_instance;
  LayerNext* next;
};
struct LayerCreate {
  LayerStructure type;
  std::uint32_t version;
  std::size_t size;
  XrInstance unused;
  char settings[512];
  LayerNext* next;
};

PFN_xrGetInstanceProcAddr below = nullptr;
PFN_xrCreateSession create_session_below = nullptr;

XrResult create_session(XrInstance instance, const XrSessionCreateInfo* info, XrSession* out) {
  auto& s = here();
  s.told_by_layer = given_graphics(info->next);
  XrSessionCreateInfo told = *info;
  const auto as_glx = glx_in_name(*s.told_by_layer);
  if (s.told_by_layer->egl) told.next = as_glx.get();
  const XrResult result = create_session_below(instance, &told, out);
  s.told_by_layer.reset();
  return result;
}

XrResult get_function(XrInstance instance, const char* name, PFN_xrVoidFunction* out) {
  const XrResult result = below(instance, name, out);
  if (XR_FAILED(result) || std::string(name) != "xrCreateSession") return result;
  create_session_below = reinterpret_cast<PFN_xrCreateSession>(*out);
  *out = as_void(create_session);
  return result;
}

XrResult create_instance(const XrInstanceCreateInfo* info, const LayerCreate* layer, XrInstance* out) {
  LayerCreate rest = *layer;
  rest.next = layer->next->next;
  below = layer->next->get_function;
  return layer->next->create_instance(info, &rest, out);
}

}  // namespace

extern "C" __attribute__((visibility("default"))) XrResult xrNegotiateLoaderApiLayerInterface(const void* /*loader*/,
                                                                                              const char* /*name*/,
                                                                                              LayerRequest* request) {
  if (!request || request->type != LayerStructure::layer_request) return XR_ERROR_INITIALIZATION_FAILED;
  request->interface_version = 1;
  request->api_version = XR_MAKE_VERSION(1, 0, 20);
  request->get_function = get_function;
  request->create_instance = create_instance;
  return XR_SUCCESS;
}

}  // namespace foresight::openxr_runtime
