#include "drivers/camera/libcamera_mapping.hpp"

#include <sys/mman.h>

#include <algorithm>

#include "common/error.hpp"

namespace foresight::libcam {

Mapping::Mapping(const libcamera::FrameBuffer& buffer, const std::string& where) {
  const auto& planes = buffer.planes();
  first_ = planes.front().offset;
  for (const auto& plane : planes) {
    if (plane.fd.get() != planes.front().fd.get() || plane.offset != first_ + size_)
      throw RuntimeFailure(where + ": its planes do not lie side by side", "choose another format");
    size_ += plane.length;
  }
  // mmap wants whole pages.
  mapped_ = first_ + size_;
  address_ = mmap(nullptr, mapped_, PROT_READ, MAP_SHARED, planes.front().fd.get(), 0);
  if (address_ == MAP_FAILED) throw RuntimeFailure(where + ": mmap failed", "see how much memory is left");
}

Mapping::~Mapping() {
  munmap(address_, mapped_);
}

std::span<const std::uint8_t> Mapping::bytes(std::size_t used) const {
  return {static_cast<const std::uint8_t*>(address_) + first_, std::min(used, size_)};
}

}  // namespace foresight::libcam
