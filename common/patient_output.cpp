#include "common/patient_output.hpp"

#include <fcntl.h>
#include <poll.h>
#include <unistd.h>

#include <cerrno>
#include <condition_variable>
#include <deque>
#include <mutex>
#include <optional>
#include <string_view>
#include <utility>

namespace foresight {
namespace {

constexpr Duration kFarewell = std::chrono::milliseconds(500);

/// For the program's life; the same one where there are no more.
int duplicate(int fd) {
  const int out = ::fcntl(fd, F_DUPFD_CLOEXEC, STDERR_FILENO + 1);
  return out < 0 ? fd : out;
}

/// What cannot be written (the terminal is gone, nobody reads the pipe) is nobody's any more.
void write_to(int fd, std::string_view text) noexcept {
  while (!text.empty()) {
    const ssize_t count = ::write(fd, text.data(), text.size());
    if (count >= 0) {
      text.remove_prefix(static_cast<std::size_t>(count));
    } else if (errno == EAGAIN) {  // somebody else made it non-blocking
      pollfd room{fd, POLLOUT, 0};
      ::poll(&room, 1, -1);
    } else if (errno != EINTR) {
      return;
    }
  }
}

}  // namespace

struct PatientOutput::Shared {
  const int fd;
  std::mutex mutex = {};  // all below
  std::condition_variable wanted = {}, written = {};
  std::deque<std::string> said = {};
  std::optional<std::string> picture = {};
  std::uint64_t lost = 0;  // lines
  bool writing = false, ended = false;

  bool idle() const { return said.empty() && !picture && !writing; }
  /// What is to be written next; "" where nothing is.
  std::string next() {
    std::string out;
    if (lost > 0) {
      out = "[" + std::to_string(std::exchange(lost, 0)) + " lines were not shown: nobody read them]\n";
    } else if (!said.empty()) {
      out = std::move(said.front());
      said.pop_front();
    } else if (picture) {
      out = std::move(*picture);
      picture.reset();
    }
    return out;
  }
};

PatientOutput::PatientOutput(int fd) : shared_(new Shared{fd}), writer_([shared = shared_] { write_all(shared); }) {}

PatientOutput::~PatientOutput() {
  const bool all = finish(kFarewell);
  {
    const std::lock_guard lock(shared_->mutex);
    shared_->ended = true;
  }
  shared_->wanted.notify_one();
  all ? writer_.join() : writer_.detach();
}

void PatientOutput::say(std::string text) noexcept {
  {
    const std::lock_guard lock(shared_->mutex);
    shared_->said.push_back(std::move(text));
    if (shared_->said.size() > kRoom) {
      shared_->said.pop_front();
      ++shared_->lost;
    }
  }
  shared_->wanted.notify_one();
}

void PatientOutput::show(std::string picture) noexcept {
  {
    const std::lock_guard lock(shared_->mutex);
    shared_->picture = std::move(picture);
  }
  shared_->wanted.notify_one();
}

bool PatientOutput::finish(Duration patience) noexcept {
  std::unique_lock lock(shared_->mutex);
  return shared_->written.wait_for(lock, patience, [this] { return shared_->idle(); });
}

void PatientOutput::write_all(const std::shared_ptr<Shared>& shared) noexcept {
  std::unique_lock lock(shared->mutex);
  for (;;) {
    shared->wanted.wait(lock, [&] { return shared->ended || !shared->idle(); });
    if (shared->ended) return;
    const std::string text = shared->next();
    shared->writing = true;
    lock.unlock();
    write_to(shared->fd, text);
    lock.lock();
    shared->writing = false;
    shared->written.notify_all();
  }
}

PatientOutput& patient_stdout() {
  static PatientOutput output(duplicate(STDOUT_FILENO));
  return output;
}

PatientOutput& patient_stderr() {
  static PatientOutput output(duplicate(STDERR_FILENO));
  return output;
}

WaitsForReaders::WaitsForReaders() {
  patient_stdout();
  patient_stderr();
}

WaitsForReaders::~WaitsForReaders() {
  for (PatientOutput* const output : {&patient_stdout(), &patient_stderr()}) output->finish(kFarewell);
}

}  // namespace foresight
