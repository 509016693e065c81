#include "uvc_stream.hpp"

#include <algorithm>
#include <utility>

namespace foresight::usb {
namespace {

// bmHeaderInfo: the frame's parity, end of frame, time stamp, source clock, error, end of header.
constexpr std::uint8_t kEndOfFrame = 0x02, kTimeStamp = 0x04, kSourceClock = 0x08, kError = 0x40, kEndOfHeader = 0x80;

Duration period_of(const StreamSettings& settings) {
  return Duration{std::int64_t{settings.interval} * 100};
}

}  // namespace

void UvcStream::start(const StreamSettings& settings) {
  stop();
  settings_ = settings;
  streams_ = true;
  hangs_ = false;
  due_ = {};
}

void UvcStream::stop() {
  streams_ = false;
  payload_.clear();
}

void UvcStream::queue(Request transfer) {
  waiting_.push_back(std::move(transfer));
}

void UvcStream::take_back(const Request& request) {
  const auto found =
      std::find_if(waiting_.begin(), waiting_.end(), [&](const Request& r) { return r.number == *request.takes_back; });
  const bool waited = found != waiting_.end();
  if (waited) waiting_.erase(found);
  port_.answer_taken_back(request, waited);
  if (waiting_.empty()) payload_.clear();
}

bool UvcStream::disturb(std::string_view what) {
  if (what == "error")
    error_ = true;
  else if (what == "short")
    short_ = true;
  else if (what == "hang")
    hangs_ = true;
  else if (what == "freeze")
    frozen_ = true;
  else if (what == "resume")
    frozen_ = false;
  else
    return false;
  return true;
}

std::optional<RobotTime> UvcStream::serve(RobotTime now) {
  if (!streams_) return std::nullopt;
  const Duration period = period_of(settings_);
  if (payload_.empty() && now >= due_) {
    const RobotTime present{now.ns - now.ns % period.count()};
    const bool first = due_.ns == 0;
    due_ = present + period;
    // A camera's frame begins when it is due. What finds the host without a transfer at that time is lost.
    if (!first && !waiting_.empty() && !hangs_ && !frozen_) begin_frame(present);
  }
  send();
  if (!payload_.empty()) return std::nullopt;  // goes on with the host's next transfer
  return due_;
}

void UvcStream::begin_frame(RobotTime now) {
  const auto count = static_cast<std::uint64_t>(now.ns / period_of(settings_).count());
  const Picture& picture = pictures_.pictures[count % pictures_.pictures.size()];
  const Bytes& data = settings_.format == kMjpegFormat ? picture.jpeg : picture.yuyv;
  const auto ticks = static_cast<std::uint32_t>(now.ns / 1000 * (kClockHz / 1'000'000));  // wraps
  payload_ = {kPayloadHeader, static_cast<std::uint8_t>(kEndOfHeader | kEndOfFrame | kTimeStamp | kSourceClock)};
  frame_id_ = !frame_id_;
  payload_[1] |= static_cast<std::uint8_t>((frame_id_ ? 1 : 0) | (std::exchange(error_, false) ? kError : 0));
  append(payload_, ticks, 4);
  append(payload_, ticks, 4);
  append(payload_, static_cast<std::uint32_t>(now.ns / 1'000'000 % 2048), 2);  // the bus counts its frames so
  const std::size_t size = std::exchange(short_, false) ? data.size() / 2 : data.size();
  payload_.insert(payload_.end(), data.begin(), data.begin() + static_cast<std::ptrdiff_t>(size));
  sent_ = 0;
}

// A transfer that is not filled ends the payload: where the last one happens to be full, an empty one follows.
void UvcStream::send() {
  while (!payload_.empty() && !waiting_.empty()) {
    const Request transfer = std::move(waiting_.front());
    waiting_.pop_front();
    const std::size_t size = std::min<std::size_t>(payload_.size() - sent_, transfer.length);
    port_.answer(transfer, std::span(payload_).subspan(sent_, size));
    sent_ += size;
    if (size < transfer.length) payload_.clear();
  }
}

}  // namespace foresight::usb
