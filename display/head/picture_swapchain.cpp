#include "display/head/picture_swapchain.hpp"

namespace foresight::head {
namespace {

constexpr XrDuration kLongestWait = 1'000'000'000;  // ns

}  // namespace

std::int64_t picture_format(XrSession session) {
  const auto formats = listed<std::int64_t>("xrEnumerateSwapchainFormats", 0,
                                            [session](std::uint32_t room, std::uint32_t* count, std::int64_t* out) {
                                              return xrEnumerateSwapchainFormats(session, room, count, out);
                                            });
  if (std::ranges::find(formats, GL_SRGB8_ALPHA8) == formats.end())
    throw CallFailed(XR_ERROR_SWAPCHAIN_FORMAT_UNSUPPORTED, "no pictures in GL_SRGB8_ALPHA8");
  return GL_SRGB8_ALPHA8;
}

PictureSwapchain::PictureSwapchain(XrSession session, std::int64_t format, int width, int height)
    : width_(width), height_(height) {
  XrSwapchainCreateInfo info{};
  info.type = XR_TYPE_SWAPCHAIN_CREATE_INFO;
  info.usageFlags = XR_SWAPCHAIN_USAGE_COLOR_ATTACHMENT_BIT | XR_SWAPCHAIN_USAGE_SAMPLED_BIT;
  info.format = format;
  info.sampleCount = info.faceCount = info.arraySize = info.mipCount = 1;
  info.width = static_cast<std::uint32_t>(width);
  info.height = static_cast<std::uint32_t>(height);
  check(xrCreateSwapchain(session, &info, &swapchain_), "xrCreateSwapchain");
  try {
    XrSwapchainImageOpenGLKHR empty{};
    empty.type = XR_TYPE_SWAPCHAIN_IMAGE_OPENGL_KHR;
    const auto images = listed<XrSwapchainImageOpenGLKHR>(
        "xrEnumerateSwapchainImages", empty,
        [this](std::uint32_t room, std::uint32_t* count, XrSwapchainImageOpenGLKHR* out) {
          return xrEnumerateSwapchainImages(swapchain_, room, count,
                                            reinterpret_cast<XrSwapchainImageBaseHeader*>(out));
        });
    // As all of OpenGL, runtimes have the first row at the bottom.
    for (const auto& image : images) targets_.emplace_back(image.image, width, height, -1, false);
    if (targets_.empty()) throw CallFailed(XR_ERROR_RUNTIME_FAILURE, "xrEnumerateSwapchainImages");
  } catch (...) {
    xrDestroySwapchain(swapchain_);
    throw;
  }
}

PictureSwapchain::~PictureSwapchain() {
  xrDestroySwapchain(swapchain_);
}

const ViewTarget& PictureSwapchain::acquire() {
  std::uint32_t index = 0;
  check(xrAcquireSwapchainImage(swapchain_, nullptr, &index), "xrAcquireSwapchainImage");
  XrSwapchainImageWaitInfo info{};
  info.type = XR_TYPE_SWAPCHAIN_IMAGE_WAIT_INFO;
  info.timeout = kLongestWait;
  const XrResult waited = xrWaitSwapchainImage(swapchain_, &info);
  check(waited, "xrWaitSwapchainImage");
  if (waited == XR_TIMEOUT_EXPIRED || index >= targets_.size()) throw CallFailed(waited, "xrWaitSwapchainImage");
  return targets_[index].whole();
}

void PictureSwapchain::release() {
  check(xrReleaseSwapchainImage(swapchain_, nullptr), "xrReleaseSwapchainImage");
  filled_ = true;
}

XrSwapchainSubImage PictureSwapchain::whole() const {
  return {swapchain_, {{0, 0}, {width_, height_}}, 0};
}

}  // namespace foresight::head
