#include "link/robot_side/frame_sender.hpp"

#include <utility>

#include "link/dds/topics.hpp"
#include "pictures/encode.hpp"

namespace foresight::link {
namespace {

using namespace std::chrono_literals;

// Cameras' periods jitter: a pair that comes by so much of a period too early still is the next one.
constexpr double kEarly = 0.25;
constexpr Duration kLook = 4ms;  // while somebody reports: for reports, and for pieces that the line wants again

}  // namespace

FrameSender::Thin::Thin(Participant& participant, std::uint64_t session, const Clock& clock)
    : reports(participant, topics::reports()), stream(session, clock), pieces(participant, topics::pieces()) {}

FrameSender::FrameSender(Participant& participant, SenderName name, const StereoLenses* lenses,
                         std::shared_ptr<FrameQueue> frames, const FrameSenderOptions& options, WallClock& wall,
                         const Clock& clock)
    : name_(std::move(name)),
      lenses_(lenses ? std::optional(*lenses) : std::nullopt),
      revision_(lenses ? lenses_revision(*lenses) : ""),
      frames_(std::move(frames)),
      quality_(options.jpeg_quality),
      capacity_(options.capacity),
      period_(seconds((1 - kEarly) / options.rate_hz)),
      wall_(wall),
      clock_(clock),
      transforms_(participant, topics::transforms()),
      images_{Writer(participant, topics::compressed_images("left")),
              Writer(participant, topics::compressed_images("right"))},
      infos_{Writer(participant, topics::camera_info("left")), Writer(participant, topics::camera_info("right"))} {
  if (options.coding == LinkCoding::jpeg)
    pairs_.emplace(participant, topics::frames());
  else
    thin_.emplace(participant, name_.session, clock);
  counts_.watched = !thin_;
}

void FrameSender::start() {
  if (thin_)
    thin_->coder = std::jthread([this](const std::stop_token& stop) {
      while (!stop.stop_requested())
        if (auto pair = thin_->to_code.take(100ms)) code(std::move(*pair));
    });
  thread_ = std::jthread([this](const std::stop_token& stop) {
    while (!stop.stop_requested() && !frames_->closed()) step(100ms);
  });
}

void FrameSender::stop() noexcept {
  for (std::jthread* thread : {&thread_, thin_ ? &thin_->coder : nullptr}) {
    if (!thread) continue;
    thread->request_stop();
    if (thread->joinable()) thread->join();
  }
}

/// The next pair to go, if it is time for one.
std::optional<LiveFramePtr> FrameSender::next(Duration timeout) noexcept {
  auto frame = frames_->take_newest(thin_ && counts().watched ? std::min(timeout, kLook) : timeout);
  if (frame && last_.ns != INT64_MIN && (*frame)->pair.left.time - last_ < period_) frame.reset();
  return frame;
}

void FrameSender::step(Duration timeout) noexcept {
  try {
    if (const auto frame = next(timeout)) {
      send(**frame);
      last_ = (*frame)->pair.left.time;
    }
  } catch (const std::exception&) {  // OpenCV's coder, or no memory: the next pair is another one
    count_failure();
  }
  if (thin_) serve_line();
}

void FrameSender::send(const LiveFrame& frame) {
  StereoFrame message = stereo_frame(frame, name_.joints);
  message.session = name_.session;
  message.lenses_revision = revision_;
  message.header.stamp = ros_time(wall_.unix_ns(frame.pair.left.time));
  if (pairs_) {
    send_jpeg(message, frame);
  } else {
    {
      const std::lock_guard lock(thin_->mutex);
      thin_->stream.offer(message, {frame.pair.left.bgr, frame.pair.right.bgr, frame.pair.left.time});
    }
    serve_line();  // before copies are made, which takes milliseconds
  }
  send_copies(frame, message);
}

void FrameSender::send_jpeg(StereoFrame& message, const LiveFrame& frame) {
  message.coding = kJpegCoding;
  message.stamps.taken_ns = clock_.now().ns;
  message.left.data = encode_jpeg(frame.pair.left.bgr, quality_);
  message.right.data = encode_jpeg(frame.pair.right.bgr, quality_);
  message.stamps.coded_ns = clock_.now().ns;
  Bytes cdr = to_cdr(message);
  {
    const std::lock_guard lock(mutex_);
    ++counts_.sent;
    counts_.bytes += cdr.size();
  }
  pairs_->write(std::move(cdr));
}

void FrameSender::serve_line() {
  std::optional<PairToCode> pair;
  try {
    const std::lock_guard lock(thin_->mutex);
    thin_->reports.take<StereoReport>({}, [this](StereoReport&& report, const Sample&) { thin_->stream.take(report); });
    thin_->stream.watched_by(thin_->pieces.readers());
    send_pieces();
    pair = thin_->stream.begin();
  } catch (const std::exception&) {
    count_failure();
  }
  if (!pair) return;
  if (thin_->coder.joinable())
    thin_->to_code.put(std::move(*pair));
  else
    code(std::move(*pair));
}

/// This pair, and what the line wants when it is done.
void FrameSender::code(PairToCode pair) noexcept {
  for (std::optional<PairToCode> next(std::move(pair)); next;) {
    PairToCode now = std::move(*std::exchange(next, std::nullopt));
    try {
      now.code(clock_);
    } catch (const std::exception&) {  // the library, or no memory: the next pair is another one
      count_failure();
    }
    try {
      const std::lock_guard lock(thin_->mutex);
      thin_->stream.finish(std::move(now));
      send_pieces();
      next = thin_->stream.begin();
    } catch (const std::exception&) {
      count_failure();
    }
  }
}

/// Thin's mutex is held.
void FrameSender::send_pieces() {
  for (const StereoPiece& piece : thin_->stream.packets()) thin_->pieces.write(piece);
  const CodedStream::Counts now = thin_->stream.counts();
  const std::lock_guard lock(mutex_);
  counts_.sent = now.coded;
  counts_.replaced = now.replaced;
  counts_.bytes = now.bytes;
  counts_.watched = thin_->stream.has_reader();
  counts_.bytes_per_s = now.bytes_per_s;
  if (capacity_) capacity_->bytes_per_s = now.bytes_per_s;
}

void FrameSender::count_failure() noexcept {
  const std::lock_guard lock(mutex_);
  ++counts_.failed;
}

void FrameSender::send_copies(const LiveFrame& frame, const StereoFrame& message) {
  const RosTime right = ros_time(wall_.unix_ns(frame.pair.right.time));
  const std::array<RosTime, 2> stamps{message.header.stamp, right};
  for (const Side side : {Side::left, Side::right}) {
    const auto i = static_cast<std::size_t>(side);
    const Header header{stamps[i], camera_frame(side)};
    const CodedImage& image = side == Side::left ? message.left : message.right;
    const ColourImage& picture = side == Side::left ? frame.pair.left : frame.pair.right;
    if (images_[i].readers() > 0)
      images_[i].write(CompressedImage{header, "bgr8; jpeg compressed bgr8",
                                       image.data.empty() ? encode_jpeg(picture.bgr, quality_) : image.data});
    if (lenses_ && infos_[i].readers() > 0)
      infos_[i].write(camera_info(side == Side::left ? lenses_->left : lenses_->right, header.frame_id, header.stamp));
  }
  const TFMessage transforms = camera_transforms(frame, stamps[0], stamps[1]);
  if (!transforms.transforms.empty()) transforms_.write(transforms);
}

FrameCounts FrameSender::counts() const noexcept {
  const std::lock_guard lock(mutex_);
  FrameCounts out = counts_;
  out.replaced += frames_->dropped();
  return out;
}

}  // namespace foresight::link
