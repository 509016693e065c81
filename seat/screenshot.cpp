#include "seat/screenshot.hpp"

#include <fcntl.h>
#include <fmt/core.h>
#include <unistd.h>

#include <cerrno>
#include <exception>
#include <utility>

#include "pictures/picture_file.hpp"

namespace foresight {
namespace {

namespace fs = std::filesystem;

/// An empty file of ours in the first place that is free: from now on nobody else's. Where none can be made there is
/// none; writing tells why.
class Place {
 public:
  explicit Place(const fs::path& folder) {
    for (int number = 1; !is_ours_; ++number) {
      file_ = folder / fmt::format("foresight-{:03}.png", number);
      const int fd = ::open(file_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
      if (fd < 0 && errno != EEXIST) return;
      if (fd < 0) continue;
      ::close(fd);
      is_ours_ = true;
    }
  }
  ~Place() {
    if (is_ours_) ::unlink(file_.c_str());
  }
  Place(const Place&) = delete;
  Place& operator=(const Place&) = delete;

  const fs::path& file() const { return file_; }
  void keep() { is_ours_ = false; }

 private:
  fs::path file_;
  bool is_ours_ = false;
};

}  // namespace

Screenshot save_screenshot(const fs::path& folder, const cv::Mat& picture) noexcept {
  Screenshot out;
  try {
    Place place(folder);
    out.file = place.file();
    write_png(out.file, picture);
    place.keep();
  } catch (const std::exception& error) {
    out.trouble = error.what();
  }
  return out;
}

namespace {

Screenshot save_upright(const fs::path& folder, const cv::Mat& rows_from_below) noexcept {
  try {
    cv::Mat picture;
    cv::flip(rows_from_below, picture, 0);
    return save_screenshot(folder, picture);
  } catch (const std::exception& error) {  // no memory
    return {{}, error.what()};
  }
}

}  // namespace

ScreenshotWriter::ScreenshotWriter(fs::path folder)
    : folder_(std::move(folder)), thread_([this](const std::stop_token& stop) { write(stop); }) {}

ScreenshotWriter::~ScreenshotWriter() {
  finish();
}

bool ScreenshotWriter::take(cv::Mat rows_from_below) {
  {
    const std::lock_guard lock(mutex_);
    if (waiting_.size() >= kRoom) return false;
    waiting_.push_back(std::move(rows_from_below));
  }
  wanted_.notify_one();
  return true;
}

std::optional<Screenshot> ScreenshotWriter::done() {
  const std::lock_guard lock(mutex_);
  if (done_.empty()) return std::nullopt;
  Screenshot out = std::move(done_.front());
  done_.pop_front();
  return out;
}

void ScreenshotWriter::finish() {
  std::unique_lock lock(mutex_);
  written_.wait(lock, [this] { return waiting_.empty() && !writing_; });
}

void ScreenshotWriter::write(const std::stop_token& stop) {
  std::unique_lock lock(mutex_);
  while (wanted_.wait(lock, stop, [this] { return !waiting_.empty(); })) {
    const cv::Mat rows_from_below = std::move(waiting_.front());
    waiting_.pop_front();
    writing_ = true;
    lock.unlock();
    Screenshot saved = save_upright(folder_, rows_from_below);
    lock.lock();
    done_.push_back(std::move(saved));
    writing_ = false;
    written_.notify_all();
  }
}

}  // namespace foresight
