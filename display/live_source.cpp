#include "display/live_source.hpp"

#include <fmt/core.h>

#include <cstdio>

namespace foresight {
namespace {

constexpr Duration kLook = std::chrono::milliseconds(50);

std::string file_name(std::uint64_t number) {
  std::string digits = std::to_string(number);
  return std::string(digits.size() < 6 ? 6 - digits.size() : 0, '0') + digits;
}

}  // namespace

LiveSource::LiveSource(LiveFeed feed, const Clock& clock, const LiveSourceOptions& options)
    : feed_(std::move(feed)), clock_(clock), options_(options), heard_(clock.now()), looked_(heard_) {}

void LiveSource::take_in(LiveImage image) {
  heard_ = clock_.now();
  posed_ = image.frame.has_value();
  unposed_ = posed_ ? cv::Mat() : std::move(image.left);
  lacks_ = std::move(image.lacks);
  if (!posed_) {
    ++counts_.unposed;
    return;
  }
  ++counts_.frames;
  instants_.push_back({image.number, image.frame->left});
  travelling_.push_back(std::move(*image.frame));
  if (travelling_.size() <= options_.most_frames) return;
  travelling_.pop_front();
  ++counts_.forgotten;
}

/// In real time it waits for the first where there is nothing else to show.
void LiveSource::take_all() {
  Duration wait = options_.real_time && instants_.empty() ? kLook : Duration{0};
  while (auto image = feed_.take(wait)) {
    take_in(std::move(*image));
    wait = Duration{0};
  }
  looked_ = clock_.now();
}

SourceState LiveSource::advance() {
  const bool closed = feed_.closed();  // asked first: what comes between the two is taken
  take_all();
  if (instants_.empty()) return closed ? SourceState::ended : SourceState::waiting;
  const std::uint64_t number = instants_.front().number;
  shown_ = std::move(instants_.front().image);
  instants_.pop_front();
  const bool blind = !handed_out_ && travelling_.front().left.time > shown_.time - options_.delay;
  instant_ = {file_name(number), shown_.time, options_.real_time && !instants_.empty(), blind};
  return SourceState::ready;
}

std::optional<PosedFrame> LiveSource::arrived() {
  std::optional<PosedFrame> out;
  while (!travelling_.empty() && travelling_.front().left.time <= shown_.time - options_.delay) {
    if (out) ++overtaken_;
    out = std::move(travelling_.front());
    travelling_.pop_front();
    handed_out_ = true;
    if (!options_.real_time) break;
  }
  return out;
}

std::string LiveSource::fault() const {
  if (silent()) {
    const std::string text = fmt::format("NO IMAGE for {:.1f} s", to_seconds(silence()));
    const std::string trouble = feed_.trouble ? feed_.trouble() : "";
    return trouble.empty() ? text : text + (": " + trouble);
  }
  if (posed_) return "";
  return "NO POSE for the newest image" + (lacks_.empty() ? "" : ": " + lacks_);
}

}  // namespace foresight
