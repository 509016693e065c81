#include "session/live_frames.hpp"

#include <exception>

#include "session/stop_latency.hpp"

namespace foresight {
namespace {

using namespace std::chrono_literals;

constexpr Duration kAskAgain = 2ms;  // for encoders that have not come yet

/// The same everywhere: a margin follows the left camera's error, from which the right one's pose follows too.
PosedFrame posed_frame(const StereoPair& pair, const PairPoses& poses, double margin_px) {
  const auto posed = [&](const ColourImage& image, std::size_t side) {
    PosedImage out{image.bgr, image.time, (*poses.T_world_camera)[side], poses.scene[side]};
    if (poses.predicted_px) out.margin_px = margin_for(margin_px, *poses.predicted_px);
    return out;
  };
  return {posed(pair.left, 0), posed(pair.right, 1)};
}

}  // namespace

LiveFrames::LiveFrames(std::shared_ptr<PoseSource> poses, const Clock& clock, const LiveFrameOptions& options)
    : poses_(std::move(poses)), clock_(clock), options_(options) {}

std::shared_ptr<FrameQueue> LiveFrames::subscribe(std::size_t room, bool waits) {
  auto queue = std::make_shared<FrameQueue>(room, waits);
  const std::lock_guard lock(mutex_);
  if (stopped_) queue->close();
  subscribers_.push_back(queue);
  return queue;
}

void LiveFrames::add(const StereoPair& pair) noexcept {
  std::optional<Waiting> oldest;  // goes without the lock
  {
    const std::lock_guard lock(mutex_);
    ++number_;
    if (stopped_) return;
    if (waiting_.size() >= options_.waiting) {
      oldest = std::move(waiting_.front());
      waiting_.pop_front();
      ++dropped_;
    }
    waiting_.push_back({number_, pair, clock_.now()});
  }
  arrived_.notify_one();
}

void LiveFrames::start() {
  thread_ = std::jthread([this](const std::stop_token& stop) { run(stop); });
}

void LiveFrames::run(const std::stop_token& stop) noexcept {
  while (!stop.stop_requested()) {
    if (process(false)) continue;
    std::unique_lock lock(mutex_);
    arrived_.wait_for(lock, stop, current_ ? kAskAgain : kStopLatency,
                      [this] { return !current_ && !waiting_.empty(); });
  }
}

void LiveFrames::step() noexcept {
  while (process(false)) {
  }
}

void LiveFrames::stop() noexcept {
  thread_.request_stop();
  if (thread_.joinable()) thread_.join();
  while (process(true)) {
  }
  std::vector<std::weak_ptr<FrameQueue>> subscribers;
  {
    const std::lock_guard lock(mutex_);
    stopped_ = true;
    subscribers.swap(subscribers_);
  }
  for (const auto& subscriber : subscribers)
    if (const auto queue = subscriber.lock()) queue->close();
}

void LiveFrames::take_next() noexcept {
  const std::lock_guard lock(mutex_);
  if (current_ || waiting_.empty()) return;
  current_ = std::move(waiting_.front());
  waiting_.pop_front();
}

bool LiveFrames::is_due() noexcept {
  return poses_->is_ready(current_->pair) || clock_.now() - current_->came >= options_.patience;
}

bool LiveFrames::process(bool all) noexcept {
  take_next();
  if (!current_ || (!all && !is_due())) return false;
  hand_out(registered(*current_));
  current_.reset();
  return true;
}

LiveFramePtr LiveFrames::registered(const Waiting& waiting) noexcept {
  auto frame = std::make_shared<LiveFrame>();
  frame->number = waiting.number;
  frame->pair = waiting.pair;
  frame->came = waiting.came;
  std::string fault, missing;
  try {
    PairPoses poses = poses_->poses_of(waiting.pair);
    if (poses.T_world_camera) frame->posed = posed_frame(waiting.pair, poses, options_.margin_px);
    frame->scene = std::move(poses.scene);
    frame->joints = std::move(poses.joints);
    frame->quality = std::move(poses.quality);
    frame->predicted_px = poses.predicted_px;
    missing = std::move(poses.missing);
  } catch (const std::exception& error) {
    fault = error.what();
    frame->quality = "lost";
  }
  frame->registered = clock_.now();
  const std::lock_guard lock(mutex_);
  fault_ = std::move(fault);
  missing_ = std::move(missing);
  return frame;
}

void LiveFrames::hand_out(const LiveFramePtr& frame) noexcept {
  std::vector<std::shared_ptr<FrameQueue>> queues;
  {
    const std::lock_guard lock(mutex_);
    std::erase_if(subscribers_, [](const auto& subscriber) { return subscriber.expired(); });
    for (const auto& subscriber : subscribers_)
      if (auto queue = subscriber.lock()) queues.push_back(std::move(queue));
  }
  for (const auto& queue : queues) queue->put(frame);
}

std::uint64_t LiveFrames::dropped() const noexcept {
  const std::lock_guard lock(mutex_);
  return dropped_;
}

std::string LiveFrames::fault() const {
  const std::lock_guard lock(mutex_);
  return fault_;
}

std::string LiveFrames::missing() const {
  const std::lock_guard lock(mutex_);
  return missing_;
}

}  // namespace foresight
