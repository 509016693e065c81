// The memory of libcamera's buffers. Private to this module; only in builds with libcamera.
#pragma once

#include <libcamera/framebuffer.h>

#include <cstdint>
#include <span>
#include <string>

namespace foresight::libcam {

/// All planes of a buffer, which must lie in one file, one after the other.
class Mapping {
 public:
  /// Throws RuntimeFailure; `where` names the camera.
  Mapping(const libcamera::FrameBuffer& buffer, const std::string& where);
  Mapping(const Mapping&) = delete;
  Mapping& operator=(const Mapping&) = delete;
  ~Mapping();
  std::span<const std::uint8_t> bytes(std::size_t used) const;  ///< the first of them, at most all

 private:
  void* address_ = nullptr;
  std::size_t first_ = 0, size_ = 0, mapped_ = 0;
};

}  // namespace foresight::libcam
