// A DDS domain for a trial that is to hear nobody else on this machine, and to be heard by nobody.
#pragma once

#include "common/unique_fd.hpp"

namespace foresight::link {

/// Holds one domain among all who ask this way in the same network namespace, until it or its process ends, however
/// that ends. Programs that name a domain themselves are not asked. Move-only; any thread.
class OwnDomain {
 public:
  static constexpr int kFirst = 100, kDomains = 100;

  /// The first that is free. Throws RuntimeFailure: none is, or the kernel gives no socket.
  OwnDomain();
  int number() const { return number_; }

 private:
  UniqueFd held_;
  int number_ = 0;
};

}  // namespace foresight::link
