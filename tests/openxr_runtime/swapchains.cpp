// Images that are lent to the program: acquired, waited for, released, in that order.
#include <epoxy/gl.h>

#include "tests/openxr_runtime/state.hpp"

namespace foresight::openxr_runtime {
namespace {

constexpr std::size_t kImages = 3;

XrResult formats(XrSession session, std::uint32_t room, std::uint32_t* count, std::int64_t* out) {
  auto& s = here();
  const std::lock_guard lock(s.mutex);
  if (const XrResult wrong = s.session_problem(session, "xrEnumerateSwapchainFormats"); XR_FAILED(wrong)) return wrong;
  std::vector<std::int64_t> all{GL_RGBA16F, GL_SRGB8_ALPHA8, GL_RGBA8};
  if (s.settings.srgb == "no") all = {GL_RGBA16F, GL_RGBA8};
  return hand_out(all, room, count, out);
}

XrResult create(XrSession session, const XrSwapchainCreateInfo* info, XrSwapchain* out) {
  auto& s = here();
  const std::lock_guard lock(s.mutex);
  if (const XrResult wrong = s.session_problem(session, "xrCreateSwapchain"); XR_FAILED(wrong)) return wrong;
  if (!s.context_current()) return s.refuse(XR_ERROR_RUNTIME_FAILURE, "xrCreateSwapchain: its context is not current");
  if (info->format != GL_SRGB8_ALPHA8 && info->format != GL_RGBA8 && info->format != GL_RGBA16F)
    return s.refuse(XR_ERROR_SWAPCHAIN_FORMAT_UNSUPPORTED, "xrCreateSwapchain: a format that is not offered");
  if (info->width < 1 || info->height < 1 || info->width > 4096 || info->height > 4096 || info->sampleCount != 1 ||
      info->faceCount != 1 || info->arraySize != 1 || info->mipCount != 1)
    return s.refuse(XR_ERROR_VALIDATION_FAILURE, "xrCreateSwapchain: a size that is not offered");
  Swapchain chain;
  chain.width = info->width;
  chain.height = info->height;
  chain.textures.resize(kImages);
  glCreateTextures(GL_TEXTURE_2D, static_cast<GLsizei>(kImages), chain.textures.data());
  for (const unsigned texture : chain.textures)
    glTextureStorage2D(texture, 1, static_cast<GLenum>(info->format), static_cast<GLsizei>(info->width),
                       static_cast<GLsizei>(info->height));
  s.swapchains[s.next_handle] = chain;
  *out = to_handle<XrSwapchain>(s.next_handle++);
  return XR_SUCCESS;
}

/// Null where there is none, or nothing may be done with it; `result` says why.
Swapchain* find(XrSwapchain handle, const char* call, XrResult& result) {
  auto& s = here();
  const auto found = s.swapchains.find(from_handle(handle));
  if (found == s.swapchains.end()) {
    result = s.refuse(XR_ERROR_HANDLE_INVALID, std::string(call) + ": no such images");
    return nullptr;
  }
  result = s.instance_lost ? XR_ERROR_INSTANCE_LOST : s.session_lost ? XR_ERROR_SESSION_LOST : XR_SUCCESS;
  return XR_FAILED(result) ? nullptr : &found->second;
}

XrResult destroy(XrSwapchain handle) {
  auto& s = here();
  const std::lock_guard lock(s.mutex);
  const auto found = s.swapchains.find(from_handle(handle));
  if (found == s.swapchains.end()) return s.refuse(XR_ERROR_HANDLE_INVALID, "xrDestroySwapchain: no such images");
  if (s.context_current())
    glDeleteTextures(static_cast<GLsizei>(found->second.textures.size()), found->second.textures.data());
  else
    s.complaints.push_back("xrDestroySwapchain: its context is not current");
  s.swapchains.erase(found);
  return XR_SUCCESS;
}

XrResult images(XrSwapchain handle, std::uint32_t room, std::uint32_t* count, XrSwapchainImageBaseHeader* out) {
  auto& s = here();
  const std::lock_guard lock(s.mutex);
  XrResult result = XR_SUCCESS;
  const Swapchain* const chain = find(handle, "xrEnumerateSwapchainImages", result);
  if (!chain) return result;
  *count = kImages;
  if (room == 0) return XR_SUCCESS;
  if (room < kImages) return XR_ERROR_SIZE_INSUFFICIENT;
  auto* const typed = reinterpret_cast<XrSwapchainImageOpenGLKHR*>(out);
  for (std::size_t i = 0; i < kImages; ++i) {
    if (typed[i].type != XR_TYPE_SWAPCHAIN_IMAGE_OPENGL_KHR)
      return s.refuse(XR_ERROR_VALIDATION_FAILURE, "xrEnumerateSwapchainImages: the type of an image");
    typed[i].image = chain->textures[i];
  }
  return XR_SUCCESS;
}

XrResult acquire(XrSwapchain handle, const XrSwapchainImageAcquireInfo*, std::uint32_t* index) {
  auto& s = here();
  const std::lock_guard lock(s.mutex);
  XrResult result = XR_SUCCESS;
  Swapchain* const chain = find(handle, "xrAcquireSwapchainImage", result);
  if (!chain) return result;
  if (chain->acquired.size() + 1 >= kImages)
    return s.refuse(XR_ERROR_CALL_ORDER_INVALID, "xrAcquireSwapchainImage: all are acquired");
  *index = static_cast<std::uint32_t>(chain->next);
  chain->acquired.push_back(*index);
  chain->next = (chain->next + 1) % kImages;
  return XR_SUCCESS;
}

XrResult wait(XrSwapchain handle, const XrSwapchainImageWaitInfo*) {
  auto& s = here();
  const std::lock_guard lock(s.mutex);
  XrResult result = XR_SUCCESS;
  Swapchain* const chain = find(handle, "xrWaitSwapchainImage", result);
  if (!chain) return result;
  if (chain->acquired.empty() || chain->waited)
    return s.refuse(XR_ERROR_CALL_ORDER_INVALID, "xrWaitSwapchainImage: none is acquired");
  chain->waited = true;
  return XR_SUCCESS;
}

XrResult release(XrSwapchain handle, const XrSwapchainImageReleaseInfo*) {
  auto& s = here();
  const std::lock_guard lock(s.mutex);
  XrResult result = XR_SUCCESS;
  Swapchain* const chain = find(handle, "xrReleaseSwapchainImage", result);
  if (!chain) return result;
  if (!chain->waited) return s.refuse(XR_ERROR_CALL_ORDER_INVALID, "xrReleaseSwapchainImage: it was not waited for");
  if (!s.context_current()) s.complaints.push_back("xrReleaseSwapchainImage: the session's context is not current");
  chain->waited = false;
  chain->released = chain->acquired.front();
  chain->acquired.pop_front();
  return XR_SUCCESS;
}

}  // namespace

void add_swapchain_functions(Functions& out) {
  out["xrEnumerateSwapchainFormats"] = as_void(formats);
  out["xrCreateSwapchain"] = as_void(create);
  out["xrDestroySwapchain"] = as_void(destroy);
  out["xrEnumerateSwapchainImages"] = as_void(images);
  out["xrAcquireSwapchainImage"] = as_void(acquire);
  out["xrWaitSwapchainImage"] = as_void(wait);
  out["xrReleaseSwapchainImage"] = as_void(release);
}

}  // namespace foresight::openxr_runtime
