// Work in processes that are forked.
#pragma once

#include <sys/types.h>

#include <functional>
#include <optional>
#include <string>

namespace foresight {

/// The child does `job`, says what it throws, and ends, at the latest with this process. To be called before anything
/// here has made an OpenGL context or a thread: neither is sure to work behind a fork. Throws RuntimeFailure: no
/// process.
pid_t start_child(const std::function<void()>& job);

/// Until it has ended. False: it threw, or was killed.
bool wait_for_child(pid_t child);

/// Nothing while it runs; else how it ended, in words. Nobody is to wait for it after that.
std::optional<std::string> end_of_child(pid_t child);

}  // namespace foresight
