#include "apps/replay_report/progress_bar.hpp"

#include <fmt/core.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>

namespace foresight {
namespace {

constexpr const char* kClearLine = "\r\x1b[K";
constexpr int kMaxBar = 40, kMinBar = 8;

std::string format_rate(double rate) {
  return fmt::format("{:.{}f}", rate, rate < 10 ? 1 : 0);
}

}  // namespace

ProgressBar::Options ProgressBar::for_stderr() {
  Options options;
  options.terminal = ::isatty(STDERR_FILENO) == 1;
  winsize size{};
  if (options.terminal && ::ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 0)
    options.columns = size.ws_col;
  return options;
}

ProgressBar::ProgressBar(std::string label, std::string unit, std::size_t total, Instant start, const Options& options)
    : label_(std::move(label)), unit_(std::move(unit)), total_(total), start_(start), last_(start), options_(options) {}

std::string ProgressBar::update(std::size_t done, Instant now) {
  const auto pause = options_.terminal ? options_.redraw_every : options_.line_every;
  // A terminal shows at once that something happens; a log is spared short runs.
  if (now - last_ < pause && (printed_ || !options_.terminal)) return {};
  last_ = now;
  printed_ = true;
  return options_.terminal ? kClearLine + line(done, now) : line(done, now) + "\n";
}

std::string ProgressBar::finish(std::size_t done, Instant now) {
  const std::chrono::duration<double> took = now - start_;
  std::string text = label_ + ": " + std::to_string(done);
  if (total_ && done != total_) text += " of " + std::to_string(total_);
  text += " " + unit_ + " in " + readable_duration(took);
  if (done && took.count() > 0) text += ", " + format_rate(static_cast<double>(done) / took.count()) + "/s";
  return (options_.terminal ? kClearLine : "") + text + "\n";
}

std::string ProgressBar::line(std::size_t done, Instant now) const {
  const double elapsed = std::chrono::duration<double>(now - start_).count();
  const double rate = elapsed > 0 ? static_cast<double>(done) / elapsed : 0;
  const double share = total_ ? std::min(1.0, static_cast<double>(done) / static_cast<double>(total_)) : 0;
  std::string tail = std::to_string(done);
  if (total_) tail += "/" + std::to_string(total_);
  tail += " " + unit_;
  if (done && rate > 0) {
    tail += "  " + format_rate(rate) + "/s";
    if (total_ > done)
      tail += "  " + readable_duration(std::chrono::duration<double>((total_ - done) / rate)) + " left";
  }
  std::string text = label_ + "  ";
  // Never as wide as the terminal: a full last column wraps, and the bar would crawl downwards.
  const int room = options_.columns - static_cast<int>(text.size() + tail.size()) - 5;
  if (options_.terminal && total_ && room >= kMinBar) {
    const auto width = static_cast<std::size_t>(std::min(room, kMaxBar));
    const auto filled = static_cast<std::size_t>(std::lround(share * static_cast<double>(width)));
    text += "[" + std::string(filled, '#') + std::string(width - filled, '.') + "]  ";
  }
  text += tail;
  if (options_.terminal)
    text.resize(std::min(text.size(), static_cast<std::size_t>(std::max(1, options_.columns - 1))));
  return text;
}

std::string readable_duration(std::chrono::duration<double> duration) {
  const auto s = static_cast<long>(std::ceil(std::clamp(duration.count(), 0.0, 3.6e8) - 1e-6));
  if (s < 60) return fmt::format("{} s", s);
  if (s < 3600) return fmt::format("{} min {:02} s", s / 60, s % 60);
  return fmt::format("{} h {:02} min", s / 3600, s / 60 % 60);
}

}  // namespace foresight
