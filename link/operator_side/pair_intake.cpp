#include "link/operator_side/pair_intake.hpp"

#include "link/coding/jpeg_coder.hpp"
#include "link/messages/pair_notes.hpp"
#include "scene/coding_loss.hpp"

namespace foresight::link {
namespace {

/// PairReceiver's clock has an epoch of its own.
RobotTime receiver_time(OperatorTime time) {
  return RobotTime{time.ns};
}

cv::Size size_of(const CodedImage& image) {
  return {static_cast<int>(image.width), static_cast<int>(image.height)};
}

}  // namespace

PairIntake::PairIntake(std::uint64_t reader, Expected expected, const Clock& clock)
    : reader_(reader), expected_(std::move(expected)), clock_(clock) {}

bool PairIntake::believes(std::uint64_t session) {
  if (session != session_) {
    if (session_ != 0 && now() - heard_ < kBelieves) return false;
    session_ = session;
    newest_ = 0;
    begin_stream(0);
  }
  heard_ = now();
  return true;
}

void PairIntake::begin_stream(std::uint32_t stream) {
  stream_ = stream;
  expected_before_ = counts_.expected;
  first_packet_.reset();
  receiver_.reset();
  if (stream > 0) receiver_.emplace(make_pair_decoder());
}

std::string PairIntake::wrong_with(const StereoFrame& message, const RobotClockTracker& robot) const {
  Expected expected = expected_;
  expected.writer_now_ns.reset();
  if (const auto there = robot.to_there(now())) expected.writer_now_ns = there->latest().ns;
  return objection(message, expected);
}

LineFramePtr PairIntake::refuse(std::string why) {
  ++counts_.refused;
  counts_.refusal = std::move(why);
  counts_.refuses = true;
  return nullptr;
}

std::shared_ptr<LineFrame> PairIntake::hand_out(const StereoFrame& message, StereoPicture picture, std::size_t bytes,
                                                OperatorTime arrived, const RobotClockTracker& robot) {
  auto out = std::make_shared<LineFrame>(line_frame(message, robot, arrived, now()));
  out->image[0].bgr = std::move(picture.left);
  out->image[1].bgr = std::move(picture.right);
  out->bytes = bytes;
  newest_ = message.number;
  ++counts_.pairs;
  counts_.refuses = false;
  return out;
}

LineFramePtr PairIntake::take(const StereoFrame& message, std::size_t bytes, const RobotClockTracker& robot) {
  const OperatorTime arrived = now();
  if (std::string wrong = wrong_with(message, robot); !wrong.empty()) return refuse(std::move(wrong));
  if (message.coding != kJpegCoding) return refuse("coding is not jpeg in a message of its own");
  if (!believes(message.session)) return refuse("it is of another start of the robot's program");
  counts_.bytes += bytes;
  if (message.number <= newest_) {
    ++counts_.late;
    return nullptr;
  }
  const auto left = decode_jpeg(message.left.data, size_of(message.left), true);
  const auto right = decode_jpeg(message.right.data, size_of(message.right), true);
  if (!left || !right)
    return refuse(std::string(left ? "right" : "left") + ".data is no JPEG in colour of the image's size");
  return hand_out(message, {*left, *right, RobotTime{message.left.capture_ns}}, bytes, arrived, robot);
}

void PairIntake::count_packet(std::span<const std::uint8_t> packet) {
  const auto parsed = parse_packet(packet);
  std::uint32_t sequence = 0;
  if (const auto* piece = std::get_if<Piece>(&parsed)) sequence = piece->sequence;
  if (const auto* question = std::get_if<Question>(&parsed)) sequence = question->sequence;
  if (sequence == 0) return;
  ++counts_.packets;
  if (!first_packet_) first_packet_ = sequence;
  if (sequence >= *first_packet_)
    counts_.expected = std::max(counts_.expected, expected_before_ + (sequence - *first_packet_) + 1);
}

LineFramePtr PairIntake::frame_of(const foresight::ReceivedPair& pair, OperatorTime arrived,
                                  const RobotClockTracker& robot) {
  const auto notes = from_notes(pair.notes);
  if (!notes) return refuse("a coded pair has no notes");
  const StereoFrame& message = notes->frame;
  if (message.coding != kH264Coding) return refuse("coding is not h264 in a coded pair");
  if (std::string wrong = wrong_with(message, robot); !wrong.empty()) return refuse(std::move(wrong));
  const StereoPicture& picture = pair.picture;
  if (picture.left.size() != size_of(message.left) || picture.right.size() != size_of(message.right) ||
      picture.left.type() != CV_8UC3)
    return refuse("a coded pair's pictures are not in colour and of the size that its notes say");
  if (message.left.capture_ns != picture.captured.ns) return refuse("a coded pair has two capture instants");
  if (message.session != session_) return refuse("it is of another start of the robot's program");
  if (message.number <= newest_) {
    ++counts_.late;
    return nullptr;
  }
  auto lost = loss_of(notes->left_lost);
  if (!lost) return refuse("what coding took away from a pair is not told in steps of its tiles");
  const auto shares = loss_shares_of(notes->loss_shares);
  if (!shares) return refuse("what coding took away from a pair is not told by contrast");
  auto out = hand_out(message, picture, pair.bytes, arrived, robot);
  out->image[0].lost = std::move(*lost);
  out->image[0].loss_shares = *shares;
  return out;
}

LineFramePtr PairIntake::take(const StereoPiece& piece, const RobotClockTracker& robot,
                              const std::function<void()>& whole) {
  if (piece.reader != reader_) {
    ++counts_.others;
    return nullptr;
  }
  if (std::string wrong = objection(piece); !wrong.empty()) return refuse(std::move(wrong));
  if (!believes(piece.session) || piece.stream < stream_) return nullptr;  // of what is over
  if (piece.stream > stream_) begin_stream(piece.stream);
  counts_.bytes += piece.data.size();
  count_packet(piece.data);
  const OperatorTime arrived = now();
  LineFramePtr newest;
  if (!receiver_->receive(piece.data, receiver_time(arrived))) return newest;
  if (whole) whole();
  for (const foresight::ReceivedPair& pair : receiver_->decode()) {
    if (!pair.newest) {
      ++counts_.late;
    } else if (LineFramePtr frame = frame_of(pair, arrived, robot)) {
      newest = std::move(frame);
    }
  }
  return newest;
}

OperatorTime PairIntake::report_due() const {
  OperatorTime due = reported_ ? *reported_ + kReportEvery : OperatorTime{INT64_MIN};
  if (const auto acknowledgement = receiver_ ? receiver_->acknowledgement_due() : std::nullopt)
    due = std::min(due, OperatorTime{acknowledgement->ns});
  return due;
}

std::optional<StereoReport> PairIntake::report() {
  const OperatorTime time = now();
  if (time < report_due()) return std::nullopt;
  reported_ = time;
  StereoReport out{session_, reader_, stream_, time.ns, newest_, {}};
  if (receiver_) out.acknowledgement = receiver_->acknowledge(receiver_time(time));
  return out;
}

}  // namespace foresight::link
