#include "apps/command_line/crash_report.hpp"

#include <dlfcn.h>
#include <execinfo.h>
#include <pthread.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <csignal>
#include <cstdint>
#include <cstring>
#include <string_view>

namespace foresight {
namespace {

constexpr std::array kSignals{SIGSEGV, SIGBUS, SIGILL, SIGFPE, SIGABRT};
constexpr int kMostFrames = 40;
constexpr int kOwnFrames = 2;  // the handler, and what the kernel calls it through
constexpr std::size_t kStack = 64 << 10;

alignas(16) std::array<std::byte, kStack> other_stack;  // for who has none left

/// A line of bounded length, as nothing may be allocated where the heap may be what broke.
class Line {
 public:
  void add(std::string_view text) {
    const std::size_t fits = std::min(text.size(), text_.size() - size_);
    std::copy_n(text.data(), fits, text_.data() + size_);
    size_ += fits;
  }
  void add_hex(std::uintptr_t number) {
    std::array<char, 2 * sizeof number> digits;
    auto first = digits.end();
    do *--first = "0123456789abcdef"[number % 16];
    while (number /= 16);
    add("0x");
    add({first, static_cast<std::size_t>(digits.end() - first)});
  }
  void write() const {
    if (::write(STDERR_FILENO, text_.data(), size_) < 0) return;  // nobody is left to be told
  }

 private:
  std::array<char, 4096> text_;
  std::size_t size_ = 0;
};

void add_place(Line& line, void* address) {
  Dl_info module{};
  if (!::dladdr(address, &module) || !module.dli_fname) return line.add_hex(reinterpret_cast<std::uintptr_t>(address));
  const std::string_view file = module.dli_fname;
  line.add(file.substr(file.rfind('/') + 1));
  line.add("+");
  line.add_hex(reinterpret_cast<std::uintptr_t>(address) - reinterpret_cast<std::uintptr_t>(module.dli_fbase));
}

void report(int signal) {
  // A signal of its own kind meanwhile, as where the stack cannot be read, ends the program at once (SA_RESETHAND).
  Line line;
  line.add("foresight: crashed (");
  line.add(::sigdescr_np(signal));
  line.add(") in thread '");
  std::array<char, 16> name{};
  ::pthread_getname_np(::pthread_self(), name.data(), name.size());
  line.add(name.data());
  line.add("'; please report: ");
  std::array<void*, kMostFrames> frames;
  const int count = ::backtrace(frames.data(), kMostFrames);
  for (int i = kOwnFrames; i < count; ++i) {
    if (i > kOwnFrames) line.add(" < ");
    add_place(line, frames[static_cast<std::size_t>(i)]);
  }
  line.add("\n");
  line.write();
  std::raise(signal);  // blocked until this returns; then it does what it did before
}

}  // namespace

void report_crashes() {
  void* first = nullptr;
  ::backtrace(&first, 1);  // loads what it needs now, while that can be done
  const stack_t other{.ss_sp = other_stack.data(), .ss_flags = 0, .ss_size = other_stack.size()};
  ::sigaltstack(&other, nullptr);
  struct sigaction action {};
  action.sa_handler = report;
  action.sa_flags = static_cast<int>(SA_ONSTACK | SA_RESETHAND);
  for (const int signal : kSignals) {
    struct sigaction before {};
    ::sigaction(signal, nullptr, &before);
    if (before.sa_handler == SIG_DFL) ::sigaction(signal, &action, nullptr);  // a sanitizer tells more
  }
}

}  // namespace foresight
