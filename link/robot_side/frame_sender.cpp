#include "link/robot_side/frame_sender.hpp"

#include "link/dds/topics.hpp"

namespace foresight::link {
namespace {

using namespace std::chrono_literals;

// Cameras' periods jitter: a pair that comes by so much of a period too early still is the next one.
constexpr double kEarly = 0.25;

}  // namespace

FrameSender::FrameSender(Participant& participant, SenderName name, const StereoLenses* lenses,
                         std::shared_ptr<FrameQueue> frames, PairCoder coder, double rate_hz, WallClock& wall,
                         const Clock& clock)
    : name_(std::move(name)),
      lenses_(lenses ? std::optional(*lenses) : std::nullopt),
      revision_(lenses ? lenses_revision(*lenses) : ""),
      frames_(std::move(frames)),
      coder_(std::move(coder)),
      period_(seconds((1 - kEarly) / rate_hz)),
      wall_(wall),
      clock_(clock),
      pairs_(participant, topics::frames()),
      transforms_(participant, topics::transforms()),
      images_{Writer(participant, topics::compressed_images("left")),
              Writer(participant, topics::compressed_images("right"))},
      infos_{Writer(participant, topics::camera_info("left")), Writer(participant, topics::camera_info("right"))} {}

void FrameSender::start() {
  thread_ = std::jthread([this](const std::stop_token& stop) {
    while (!stop.stop_requested() && !frames_->closed()) step(100ms);
  });
}

void FrameSender::stop() noexcept {
  thread_.request_stop();
  if (thread_.joinable()) thread_.join();
}

void FrameSender::step(Duration timeout) noexcept {
  const auto frame = frames_->take_newest(timeout);
  if (!frame) return;
  if (last_.ns != INT64_MIN && (*frame)->pair.left.time - last_ < period_) return;
  try {
    send(**frame);
    last_ = (*frame)->pair.left.time;
  } catch (const std::exception&) {  // OpenCV's coder, or no memory: the next pair is another one
    const std::lock_guard lock(mutex_);
    ++counts_.failed;
  }
}

void FrameSender::send(const LiveFrame& frame) {
  StereoFrame message = stereo_frame(frame, name_.joints);
  message.session = name_.session;
  message.lenses_revision = revision_;
  message.header.stamp = ros_time(wall_.unix_ns(frame.pair.left.time));
  message.stamps.taken_ns = clock_.now().ns;
  if (!coder_(frame, message)) {
    const std::lock_guard lock(mutex_);
    ++counts_.failed;
    return;
  }
  message.stamps.coded_ns = clock_.now().ns;
  Bytes cdr = to_cdr(message);
  {
    const std::lock_guard lock(mutex_);
    ++counts_.sent;
    counts_.bytes += cdr.size();
  }
  pairs_.write(std::move(cdr));
  send_copies(frame, message, ros_time(wall_.unix_ns(frame.pair.right.time)));
}

void FrameSender::send_copies(const LiveFrame& frame, const StereoFrame& message, RosTime right) {
  const std::array<RosTime, 2> stamps{message.header.stamp, right};
  for (const Side side : {Side::left, Side::right}) {
    const auto i = static_cast<std::size_t>(side);
    const Header header{stamps[i], camera_frame(side)};
    const CodedImage& image = side == Side::left ? message.left : message.right;
    if (message.coding == kJpeg && images_[i].readers() > 0)
      images_[i].write(CompressedImage{header, "bgr8; jpeg compressed bgr8", image.data});
    if (lenses_ && infos_[i].readers() > 0)
      infos_[i].write(camera_info(side == Side::left ? lenses_->left : lenses_->right, header.frame_id, header.stamp));
  }
  const TFMessage transforms = camera_transforms(frame, stamps[0], stamps[1]);
  if (!transforms.transforms.empty()) transforms_.write(transforms);
}

FrameCounts FrameSender::counts() const noexcept {
  const std::lock_guard lock(mutex_);
  FrameCounts out = counts_;
  out.replaced = frames_->dropped();
  return out;
}

}  // namespace foresight::link
