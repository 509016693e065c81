// How long tests wait for what may never come.
#pragma once

#include <cstdlib>

namespace foresight {

/// A test that runs longer hangs, and is ended. Not a judgement of how quick it is: typical ones take 0.1 s.
/// FORESIGHT_TEST_HANGS_AFTER_S gives machines that are busy, or programs that sanitizers slow down, more.
inline unsigned hangs_after_s() {
  const char* const given = std::getenv("FORESIGHT_TEST_HANGS_AFTER_S");
  return given ? static_cast<unsigned>(std::atoi(given)) : 600;
}

}  // namespace foresight
