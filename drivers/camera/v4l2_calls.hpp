// The system calls of a V4L2 camera, so that tests can let them fail.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "common/time.hpp"
#include "common/unique_fd.hpp"

namespace foresight::v4l2 {

/// Like the calls of those names: -1 and errno where they fail. EINTR is handled inside.
class Calls {
 public:
  virtual ~Calls() = default;
  virtual std::vector<std::string> devices() = 0;             ///< "/dev/video0", ... in order of their numbers
  virtual std::string serial(const std::string& device) = 0;  ///< of the USB device behind it; "" where there is none
  virtual UniqueFd open(const std::string& device) = 0;       ///< for reading and writing, not blocking
  virtual int ioctl(int fd, unsigned long request, void* argument) = 0;
  virtual void* map(std::size_t bytes, int fd, std::int64_t offset) = 0;  ///< readable, shared; null where it fails
  virtual void unmap(void* address, std::size_t bytes) = 0;
  /// poll() for input: -1, 0 (timeout) or 1; `broken` is set where the device reports an error or is gone.
  virtual int wait(int fd, Duration timeout, bool& broken) = 0;
};

/// The kernel's. Stateless; lives for ever.
Calls& system_calls();

}  // namespace foresight::v4l2
