#include "display/head/xr_calls.hpp"

#include <fmt/core.h>

namespace foresight::head {

std::string words_for(XrResult result) {
  switch (result) {
    case XR_ERROR_RUNTIME_UNAVAILABLE:
    case XR_ERROR_FILE_ACCESS_ERROR:
    case XR_ERROR_FILE_CONTENTS_INVALID: return "there is no OpenXR runtime";
    case XR_ERROR_RUNTIME_FAILURE: return "the OpenXR runtime failed";
    case XR_ERROR_FORM_FACTOR_UNAVAILABLE: return "the headset is not there";
    case XR_ERROR_FORM_FACTOR_UNSUPPORTED: return "the OpenXR runtime knows no headset";
    case XR_ERROR_INSTANCE_LOST: return "the OpenXR runtime has gone";
    case XR_ERROR_SESSION_LOST: return "the headset was lost";
    case XR_ERROR_GRAPHICS_DEVICE_INVALID: return "the headset's runtime cannot use this graphics driver";
    case XR_ERROR_API_VERSION_UNSUPPORTED: return "the OpenXR runtime does not know OpenXR 1.0";
    case XR_ERROR_EXTENSION_NOT_PRESENT: return "the OpenXR runtime does not know OpenGL";
    case XR_TIMEOUT_EXPIRED: return "the OpenXR runtime does not answer";
    case XR_ERROR_SIZE_INSUFFICIENT: return "the OpenXR runtime wants pictures without a pixel";
    case XR_ERROR_SWAPCHAIN_FORMAT_UNSUPPORTED: return "the OpenXR runtime takes no 8-bit sRGB pictures";
    case XR_ERROR_VIEW_CONFIGURATION_TYPE_UNSUPPORTED: return "the headset does not show a picture to each eye";
    default: return fmt::format("the OpenXR runtime answered error {}", static_cast<int>(result));
  }
}

std::string cure_for(XrResult result) {
  switch (result) {
    case XR_ERROR_RUNTIME_UNAVAILABLE:
    case XR_ERROR_FILE_ACCESS_ERROR:
    case XR_ERROR_FILE_CONTENTS_INVALID:
      return "install one and start it (Monado, SteamVR), or name its file in XR_RUNTIME_JSON";
    case XR_ERROR_FORM_FACTOR_UNAVAILABLE:
    case XR_ERROR_SESSION_LOST: return "plug it in, switch it on, and start its runtime";
    case XR_ERROR_INSTANCE_LOST:
    case XR_ERROR_RUNTIME_FAILURE:
    case XR_TIMEOUT_EXPIRED: return "start it again";
    case XR_ERROR_GRAPHICS_DEVICE_INVALID: return "run on the graphics card that the headset is plugged into";
    default: return "take another OpenXR runtime, or `--head-display none`";
  }
}

CallFailed::CallFailed(XrResult why, const std::string& call)
    : RuntimeFailure(words_for(why) + " (" + call + ")", cure_for(why)),
      result(why),
      words(words_for(why) + " (" + call + ")") {}

void check(XrResult result, const char* call) {
  if (XR_FAILED(result)) throw CallFailed(result, call);
}

}  // namespace foresight::head
