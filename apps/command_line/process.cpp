#include "apps/command_line/process.hpp"

#include <fcntl.h>
#include <malloc.h>
#include <poll.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <iostream>
#include <new>
#include <string>
#include <system_error>

#include "apps/command_line/crash_report.hpp"
#include "common/atomic_file.hpp"
#include "common/error.hpp"
#include "common/stop_signal.hpp"

namespace foresight {
namespace {

constexpr const char* kNoMemory =
    "out of memory; close other programs, raise the limit (ulimit -v), or give a smaller run or model";
constexpr const char* kNoThread = "the system gives no more threads; raise the limits (ulimit -u, ulimit -v)";

int tell(const char* what, int code) noexcept {
  std::fprintf(stderr, "foresight: %s\n", what);
  return code;
}

/// Code and words of the exception that is being handled.
int tell_failure() noexcept {
  try {
    throw;
  } catch (const InputError& error) {
    return tell(error.what(), 2);
  } catch (const std::bad_alloc&) {
    return tell(kNoMemory, 1);
  } catch (const std::system_error& error) {
    return tell(error.code() == std::errc::resource_unavailable_try_again ? kNoThread : error.what(), 1);
  } catch (const std::exception& error) {
    return tell(error.what(), 1);
  } catch (...) {
    return tell("an unknown failure; report this", 1);
  }
}

/// Of a thread that nobody catches: only what the machine lacks; a mistake of ours shall leave its core.
[[noreturn]] void end_of_thread() {
  if (const std::exception_ptr failure = std::current_exception()) try {
      std::rethrow_exception(failure);
    } catch (const std::bad_alloc&) {
      ::_exit(tell(kNoMemory, 1));
    } catch (const std::system_error& error) {
      if (error.code() == std::errc::resource_unavailable_try_again) ::_exit(tell(kNoThread, 1));
    } catch (...) {
    }
  std::abort();
}

/// Descriptors 0 to 2 are taken, by the wrong kind of access where they were closed.
void hold_standard_streams() {
  for (int fd = STDIN_FILENO; fd <= STDERR_FILENO; ++fd)
    if (::fcntl(fd, F_GETFD) < 0 && errno == EBADF) {
      const int made = ::open("/dev/null", O_RDONLY);  // the lowest free one, which is fd
      if (made != fd && made >= 0) ::close(made);
    }
}

/// Memory of pictures and of what compiles shaders goes back to the system when it is free: the C library's own rule
/// grows with each large block, and each of its arenas, eight a processor, keeps what its threads have once needed.
/// With two of them it was chance whether what compiles shaders left its gaps in one or in both, 10 MB.
void return_free_memory() {
  constexpr int kLarge = 256 << 10;
  ::mallopt(M_MMAP_THRESHOLD, kLarge);
  ::mallopt(M_TRIM_THRESHOLD, kLarge);
  ::mallopt(M_ARENA_MAX, 1);
}

/// 0 or errno.
int flush_stdout() noexcept {
  errno = 0;
  std::cout.flush();
  std::fflush(stdout);
  if (std::cout && std::ferror(stdout) == 0) return 0;
  // A write that failed earlier has left no errno: a pipe without a reader tells by itself.
  pollfd out{STDOUT_FILENO, 0, 0};
  if (::poll(&out, 1, 0) == 1 && (out.revents & POLLERR) != 0) return EPIPE;
  return errno ? errno : EIO;
}

}  // namespace

void settle_process() {
  hold_standard_streams();
  return_free_memory();
  for (const int signal : {SIGPIPE, SIGXFSZ}) std::signal(signal, SIG_IGN);
  end_on_stop_signals();
  std::set_terminate(end_of_thread);
  report_crashes();
}

int exit_code_of(const std::function<int()>& work) noexcept {
  int code = 0;
  try {
    code = work();
  } catch (...) {
    code = tell_failure();
  }
  const int error = flush_stdout();
  // Its reader, such as `head`, has seen enough and went.
  if (error == EPIPE) return code;
  if (error == 0 || code == 2 || code == kStopped) return code;  // these have told of something worse
  return tell((std::string("stdout: not all could be written (") + std::strerror(error) + "); " +
               (error == ENOSPC || error == EFBIG ? cure_of_write_error(error) : "give it a reader or a file"))
                  .c_str(),
              1);
}

}  // namespace foresight
