#include "common/held_stderr.hpp"

#include <sys/mman.h>
#include <unistd.h>

#include <iostream>

namespace foresight {
namespace {

std::mutex& one_at_a_time() {
  static std::mutex mutex;
  return mutex;
}

}  // namespace

HeldStderr::HeldStderr() : lock_(one_at_a_time()) {
  std::cerr.flush();
  kept_ = memfd_create("stderr", MFD_CLOEXEC);
  if (kept_ < 0) return;
  terminal_ = dup(STDERR_FILENO);
  if (terminal_ >= 0) dup2(kept_, STDERR_FILENO);
}

HeldStderr::~HeldStderr() {
  std::cerr.flush();
  if (terminal_ >= 0) {
    dup2(terminal_, STDERR_FILENO);
    close(terminal_);
  }
  if (kept_ >= 0) close(kept_);
}

std::string HeldStderr::text() const {
  std::string out(4096, '\0');
  const ssize_t size = kept_ < 0 ? 0 : pread(kept_, out.data(), out.size(), 0);
  out.resize(size > 0 ? static_cast<std::size_t>(size) : 0);
  return out;
}

}  // namespace foresight
