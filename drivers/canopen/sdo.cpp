#include "drivers/canopen/sdo.hpp"

#include <algorithm>

#include "drivers/canopen/wire.hpp"

namespace foresight::canopen {
namespace {

// The command specifiers are the upper three bits of the first byte (CiA 301, figures 26 to 33).
constexpr std::uint8_t kDownloadRequest = 0x20, kUploadRequest = 0x40, kUploadSegmentRequest = 0x60, kAbort = 0x80;
constexpr std::uint8_t kDownloadSegmentAnswer = 0x20, kUploadAnswer = 0x40, kDownloadAnswer = 0x60;
constexpr std::uint8_t kSegmentAnswer = 0x00;
constexpr std::uint8_t kSpecifier = 0xe0, kToggle = 0x10, kExpedited = 0x02, kSizeGiven = 0x01, kLast = 0x01;

}  // namespace

SdoClient::SdoClient(int node, Duration timeout, std::size_t capacity)
    : node_(node), timeout_(timeout), buffer_(std::max<std::size_t>(capacity, 4)) {}

void SdoClient::begin(std::uint16_t index, std::uint8_t sub, Step step) noexcept {
  index_ = index;
  sub_ = sub;
  step_ = step;
  status_ = SdoStatus::busy;
  abort_code_ = 0;
  count_ = sent_ = announced_ = 0;
  toggle_ = false;
}

CanFrame SdoClient::request(std::uint8_t command) const noexcept {
  CanFrame frame = data_frame(kSdoRequestId + static_cast<std::uint32_t>(node_), 8);
  frame.data[0] = command;
  frame.data[1] = static_cast<std::uint8_t>(index_);
  frame.data[2] = static_cast<std::uint8_t>(index_ >> 8);
  frame.data[3] = sub_;
  return frame;
}

void SdoClient::send(const CanFrame& frame, CanBus& bus, RobotTime now) noexcept {
  bus.send(frame);  // a frame that was not sent is one that is not answered in time
  deadline_ = now + timeout_;
}

void SdoClient::give_up(SdoStatus status, std::uint32_t code, CanBus& bus) noexcept {
  CanFrame frame = request(kAbort);
  store({frame.data.data() + 4, 4}, code);
  bus.send(frame);
  status_ = status;
  abort_code_ = code;
  count_ = 0;
}

void SdoClient::upload(std::uint16_t index, std::uint8_t sub, CanBus& bus, RobotTime now) noexcept {
  begin(index, sub, Step::upload_start);
  send(request(kUploadRequest), bus, now);
}

bool SdoClient::download(std::uint16_t index, std::uint8_t sub, std::span<const std::uint8_t> data, CanBus& bus,
                         RobotTime now) noexcept {
  begin(index, sub, Step::download_start);
  if (data.size() > buffer_.size()) {
    status_ = SdoStatus::failed;
    abort_code_ = kAbortMemory;
    return false;
  }
  std::copy(data.begin(), data.end(), buffer_.begin());
  count_ = data.size();
  CanFrame frame = request(kDownloadRequest | kSizeGiven);
  if (count_ >= 1 && count_ <= 4) {
    frame.data[0] |= static_cast<std::uint8_t>(kExpedited | (4 - count_) << 2);
    std::copy(data.begin(), data.end(), frame.data.begin() + 4);
    sent_ = count_;
  } else {
    store({frame.data.data() + 4, 4}, count_);
  }
  send(frame, bus, now);
  return true;
}

void SdoClient::receive(const CanFrame& frame, CanBus& bus, RobotTime now) noexcept {
  if (!busy() || !is_canopen(frame) || frame.id != kSdoAnswerId + static_cast<std::uint32_t>(node_) || frame.size != 8)
    return;
  const bool same_object = load(frame.payload().subspan(1), 2) == index_ && frame.data[3] == sub_;
  const std::uint8_t specifier = frame.data[0] & kSpecifier;
  const bool starting = step_ == Step::upload_start || step_ == Step::download_start;
  if (specifier == kAbort) {
    if (!same_object) return;
    status_ = SdoStatus::aborted;
    abort_code_ = static_cast<std::uint32_t>(load(frame.payload().subspan(4), 4));
    count_ = 0;
    return;
  }
  if (starting && !same_object) return;
  constexpr std::uint8_t kExpected[] = {kUploadAnswer, kSegmentAnswer, kDownloadAnswer, kDownloadSegmentAnswer};
  if (specifier != kExpected[static_cast<int>(step_)]) return give_up(SdoStatus::failed, kAbortCommand, bus);
  if (!starting && ((frame.data[0] & kToggle) != 0) != toggle_) return give_up(SdoStatus::failed, kAbortToggle, bus);
  switch (step_) {
    case Step::upload_start: return upload_started(frame, bus, now);
    case Step::upload_segment: return upload_segment(frame, bus, now);
    case Step::download_segment: toggle_ = !toggle_; break;
    case Step::download_start: break;
  }
  // An object of no bytes still takes one (empty, last) segment.
  const bool complete = sent_ == count_ && (step_ == Step::download_segment || count_ > 0);
  if (complete) {
    status_ = SdoStatus::done;
  } else {
    send_segment(bus, now);
  }
}

void SdoClient::upload_started(const CanFrame& answer, CanBus& bus, RobotTime now) noexcept {
  const std::uint8_t command = answer.data[0];
  if (command & kExpedited) {
    // The bytes behind the valid ones are whatever the device had in its memory.
    count_ = command & kSizeGiven ? 4u - (command >> 2 & 3u) : 4u;
    std::copy_n(answer.data.begin() + 4, count_, buffer_.begin());
    status_ = SdoStatus::done;
    return;
  }
  if (command & kSizeGiven) announced_ = load(answer.payload().subspan(4), 4);
  if (announced_ > buffer_.size()) return give_up(SdoStatus::failed, kAbortMemory, bus);
  step_ = Step::upload_segment;
  ask_segment(bus, now);
}

void SdoClient::ask_segment(CanBus& bus, RobotTime now) noexcept {
  CanFrame frame = data_frame(kSdoRequestId + static_cast<std::uint32_t>(node_), 8);
  frame.data[0] = static_cast<std::uint8_t>(kUploadSegmentRequest | (toggle_ ? kToggle : 0));
  send(frame, bus, now);
}

void SdoClient::upload_segment(const CanFrame& answer, CanBus& bus, RobotTime now) noexcept {
  const std::size_t size = 7u - (answer.data[0] >> 1 & 7u);
  if (count_ + size > buffer_.size()) return give_up(SdoStatus::failed, kAbortMemory, bus);
  std::copy_n(answer.data.begin() + 1, size, buffer_.begin() + static_cast<std::ptrdiff_t>(count_));
  count_ += size;
  if (answer.data[0] & kLast) {
    if (announced_ != 0 && announced_ != count_) return give_up(SdoStatus::failed, kAbortLength, bus);
    status_ = SdoStatus::done;
    return;
  }
  if (size == 0) return give_up(SdoStatus::failed, kAbortLength, bus);  // would never end
  toggle_ = !toggle_;
  ask_segment(bus, now);
}

void SdoClient::send_segment(CanBus& bus, RobotTime now) noexcept {
  step_ = Step::download_segment;
  const std::size_t size = std::min<std::size_t>(7, count_ - sent_);
  CanFrame frame = data_frame(kSdoRequestId + static_cast<std::uint32_t>(node_), 8);
  frame.data[0] = static_cast<std::uint8_t>((toggle_ ? kToggle : 0) | (7 - size) << 1);
  if (sent_ + size == count_) frame.data[0] |= kLast;
  std::copy_n(buffer_.begin() + static_cast<std::ptrdiff_t>(sent_), size, frame.data.begin() + 1);
  sent_ += size;
  send(frame, bus, now);
}

void SdoClient::check(CanBus& bus, RobotTime now) noexcept {
  if (busy() && now >= deadline_) give_up(SdoStatus::timed_out, kAbortTimeout, bus);
}

}  // namespace foresight::canopen
