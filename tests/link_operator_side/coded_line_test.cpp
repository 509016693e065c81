// The robot's coded stream and the operator's intake with a line between them, in stepped time: bytes as DDS carries
// them, nothing of DDS.
#include <algorithm>
#include <map>

#include "described.hpp"
#include "link/line/packet_line.hpp"
#include "link/messages/cdr.hpp"
#include "link/operator_side/pair_intake.hpp"
#include "link/robot_side/coded_stream.hpp"
#include "link/send_control/line_trial.hpp"
#include "scene/coding_loss.hpp"

namespace foresight::link::coded_line_test {
namespace {

using namespace std::chrono_literals;

constexpr Duration kStep = 1ms;
constexpr Duration kPeriod = 33ms;
const cv::Size kSize{160, 120};

LineSpec good_line() {
  LineSpec line;
  line.up.delay = line.down.delay = 20ms;
  line.up.bytes_per_s = 60'000;
  return line;
}

class CodedLine : public testing::Test {
 protected:
  void SetUp() override { listen_as(5); }
  /// Both ends for so long; a pair every kPeriod.
  void run(Duration time) {
    for (const RobotTime end = clock_.now() + time; clock_.now() < end; clock_.sleep_until(clock_.now() + kStep)) {
      robot_step();
      operator_step();
    }
  }
  void robot_step() {
    const RobotTime now = clock_.now();
    while (const auto packet = down_.receive(now))
      if (const auto report = from_cdr<StereoReport>(*packet)) {
        ASSERT_EQ(objection(*report), "");
        ++reports_;
        stream_->take(*report);
      }
    if (now >= due_) {
      due_ = now + kPeriod;
      const StereoPicture picture = moving_picture(now, kSize);
      sent_[++number_] = picture;
      stream_->offer(described(session_, number_, picture), picture);
    }
    send_pieces();
    if (!in_coder_)
      if (auto pair = stream_->begin()) {
        pair->code(clock_);
        in_coder_.emplace(now + coding_takes_, std::move(*pair));
      }
    if (!in_coder_ || now < in_coder_->first) return;
    stream_->finish(std::move(in_coder_->second));
    in_coder_.reset();
    send_pieces();
  }
  void send_pieces() {
    for (const StereoPiece& piece : stream_->packets()) {
      ASSERT_EQ(objection(piece), "");
      ++pieces_;
      while_coding_ += in_coder_.has_value();
      up_.send(clock_.now(), to_cdr(piece));
    }
  }
  void operator_step() {
    const RobotTime now = clock_.now();
    while (const auto packet = up_.receive(now)) {
      const auto piece = from_cdr<StereoPiece>(*packet);
      ASSERT_TRUE(piece);
      if (const LineFramePtr frame = intake_->take(*piece, RobotClockTracker())) came_.push_back(frame);
      if (!onlooker_) continue;
      for (const foresight::ReceivedPair& pair : onlooker_->take(piece->data, now)) seen_.push_back(pair.picture);
    }
    if (!listens_) return;
    if (const auto report = intake_->report()) down_.send(now, to_cdr(*report));
  }
  void restart_robot() {
    in_coder_.reset();
    stream_.emplace(++session_, clock_);
    number_ = 0;
    sent_.clear();
  }
  void listen_as(std::uint64_t reader) {
    intake_.emplace(reader, Expected{{}, {"elbow", "wrist", "finger"}, {{160, 120, 160, 120}}}, clock_);
    listens_ = true;
  }
  /// Each with exactly what was said of it, and a picture like that which was taken.
  void expect_true(double psnr_db) const {
    std::uint64_t last = 0;
    for (const LineFramePtr& frame : came_) {
      EXPECT_GT(frame->number, last) << "only newer ones";
      last = frame->number;
      const StereoPicture& picture = sent_.at(frame->number);
      const StereoFrame said = described(session_, frame->number, picture);
      EXPECT_EQ(frame->image[0].captured, picture.captured);
      for (const auto& [image, message] :
           {std::pair(&frame->image[0], &said.left), std::pair(&frame->image[1], &said.right)}) {
        ASSERT_TRUE(image->T_world_camera);
        const auto& p = message->t_world_camera.position;
        EXPECT_EQ(image->T_world_camera->translation(), Eigen::Vector3d(p.x, p.y, p.z));
        const auto& q = message->t_world_camera.orientation;
        EXPECT_TRUE(
            image->T_world_camera->linear().isApprox(Eigen::Quaterniond(q.w, q.x, q.y, q.z).toRotationMatrix(), 1e-14));
      }
      EXPECT_EQ(frame->joints.position("elbow"), said.joints[0].position);
      EXPECT_EQ(frame->joints.position("wrist"), said.joints[1].position);
      EXPECT_EQ(frame->joints.position("finger"), std::nullopt);
      EXPECT_EQ(frame->predicted_px, 0.25);
      EXPECT_EQ(frame->ages.registered, Duration(2ms));
      ASSERT_TRUE(frame->ages.coded);
      EXPECT_GT(luma_psnr_db({frame->image[0].bgr, frame->image[1].bgr, {}}, picture), psnr_db) << frame->number;
    }
  }

  SteppedClock clock_;
  PacketLine up_{good_line().up, RobotTime{}, 1}, down_{good_line().down, RobotTime{}, 2};
  std::uint64_t session_ = 77, number_ = 0;
  std::optional<CodedStream> stream_{std::in_place, session_, clock_};
  std::optional<PairIntake> intake_;
  bool listens_ = false;
  RobotTime due_;
  std::map<std::uint64_t, StereoPicture> sent_;
  std::vector<LineFramePtr> came_;
  std::size_t pieces_ = 0, reports_ = 0;
  Duration coding_takes_{0};
  std::optional<std::pair<RobotTime, PairToCode>> in_coder_;  // until then
  std::size_t while_coding_ = 0;                              // pieces
  std::optional<PairReceiver> onlooker_;                      // hears what the reader hears, and reports nothing
  std::vector<StereoPicture> seen_;
};

TEST_F(CodedLine, EveryPairKnowsItsInstantItsPosesAndItsJoints) {
  run(4s);
  EXPECT_GT(came_.size(), 60u);
  EXPECT_EQ(intake_->counts().refused, 0u) << intake_->counts().refusal;
  expect_true(28);
  for (const LineFramePtr& frame : came_)
    EXPECT_LT(frame->arrived.ns - frame->image[0].captured.ns, Duration(300ms).count());
}

// Only the robot's side has the images themselves.
TEST_F(CodedLine, EveryPairTellsWhatCodingTookAway) {
  DirectionSpec thin = good_line().up;
  thin.bytes_per_s = 6'000;
  up_ = PacketLine(thin, RobotTime{}, 3);
  run(4s);
  ASSERT_GT(came_.size(), 10u);
  int lossy = 0;
  for (const LineFramePtr& frame : came_) {
    const LineImage& left = frame->image[0];
    const cv::Mat lost = coding_loss(sent_.at(frame->number).left, left.bgr);
    ASSERT_EQ(left.lost.size(), lost.size());
    EXPECT_EQ(cv::countNonZero(left.lost != lost), 0) << frame->number;
    lossy += cv::countNonZero(lost) > 30;
  }
  EXPECT_GT(lossy, 3) << "the line was to be too thin for these pictures";
}

TEST_F(CodedLine, LossDelaysPairsAndDamagesNone) {
  LineSpec line = good_line();
  line.up.loss = line.down.loss = 0.05;
  line.up.burst = 3;
  line.up.duplicates = 0.02;
  line.up.jitter = 10ms;
  line.up.reorder = true;
  up_ = PacketLine(line.up, RobotTime{}, 3);
  down_ = PacketLine(line.down, RobotTime{}, 4);
  run(6s);
  EXPECT_GT(came_.size(), 40u);
  EXPECT_EQ(intake_->counts().refused, 0u) << intake_->counts().refusal;
  EXPECT_LT(intake_->counts().packets, intake_->counts().expected) << "losses are seen";
  expect_true(26);
}

TEST_F(CodedLine, NothingGoesWhereNobodyReports) {
  listens_ = false;
  run(1s);
  EXPECT_EQ(pieces_, 0u);
  listens_ = true;
  run(1s);
  EXPECT_GT(came_.size(), 10u);
  listens_ = false;  // it was killed: what is on the way is asked for, at growing distances, and then no more
  run(1s);
  const std::size_t pairs = came_.size();
  run(CodedStream::kForgets);
  EXPECT_EQ(came_.size(), pairs);
  EXPECT_FALSE(stream_->has_reader());
  const std::size_t asked = pieces_;
  run(2s);
  EXPECT_EQ(pieces_, asked);
  listens_ = true;  // it was only away
  run(1s);
  EXPECT_GT(came_.size(), pairs + 10);
  expect_true(28);
}

TEST_F(CodedLine, AnotherReaderIsServedOnceTheFirstIsSilent) {
  run(1s);
  const auto second = [&](std::uint64_t session, std::uint32_t stream) {
    stream_->take({session, 6, stream, 0, 0, {}});
  };
  second(session_, 1);
  EXPECT_EQ(stream_->counts().refused, 1u);
  const std::size_t before = came_.size();
  run(500ms);
  EXPECT_GT(came_.size(), before) << "the first is served on";
  listens_ = false;
  run(CodedStream::kYields + 200ms);
  came_.clear();
  listen_as(6);
  run(1s);
  EXPECT_GT(came_.size(), 10u);
  expect_true(28);
}

TEST_F(CodedLine, TheOperatorFollowsARobotThatWasStartedAnew) {
  run(1s);
  restart_robot();
  run(3s);
  std::erase_if(came_, [&](const LineFramePtr& frame) { return frame->session != session_; });  // on the way then
  EXPECT_GT(came_.size(), 15u);
  expect_true(28);
}

TEST_F(CodedLine, AnOutageIsGotOverWithinItsLine) {
  run(1s);
  for (int i = 0; i < 3000; ++i) {  // nothing crosses, and what was sent is lost
    robot_step();
    while (up_.receive(clock_.now())) {
    }
    while (down_.receive(clock_.now())) {
    }
    clock_.sleep_until(clock_.now() + kStep);
  }
  came_.clear();
  const RobotTime end = clock_.now();
  run(1500ms);
  ASSERT_FALSE(came_.empty());
  EXPECT_GT(came_.back()->image[0].captured, end) << "pairs of after the outage";
  expect_true(28);
}

// Reports are taken and what was lost is sent again while a pair is with the coder for five periods of the camera; what
// is said of pairs meanwhile reaches it.
TEST_F(CodedLine, ACoderThatTakesLongHoldsUpNothingButPairs) {
  LineSpec line = good_line();
  line.up.loss = 0.1;
  up_ = PacketLine(line.up, RobotTime{}, 5);
  coding_takes_ = 160ms;
  run(8s);
  EXPECT_GT(came_.size(), 35u) << "of 50 that the coder has time for";
  EXPECT_EQ(intake_->counts().refused, 0u) << intake_->counts().refusal;
  EXPECT_GT(while_coding_, 10u) << "what was lost, again, and questions";
  std::vector<double> ages_ms;
  for (const LineFramePtr& frame : came_)
    ages_ms.push_back(1e-6 * static_cast<double>(frame->arrived.ns - frame->image[0].captured.ns));
  std::ranges::sort(ages_ms);
  EXPECT_LT(ages_ms[ages_ms.size() * 9 / 10], 500) << "coding, two ways and a copy";
  expect_true(26);
}

TEST_F(CodedLine, WhoLooksOnLaterHasPairsToo) {
  run(2s);
  const auto look_on = [this] {
    onlooker_.emplace(make_pair_decoder());
    seen_.clear();
    came_.clear();
  };
  const auto expect_the_same = [this] {
    for (const StereoPicture& picture : seen_) {
      const auto there = std::ranges::find(came_, picture.captured,
                                           [](const LineFramePtr& frame) { return frame->image[0].captured; });
      ASSERT_NE(there, came_.end());
      EXPECT_EQ(cv::norm((*there)->image[0].bgr, picture.left, cv::NORM_INF), 0);
    }
  };
  stream_->watched_by(1);
  look_on();
  run(1s);
  EXPECT_EQ(seen_.size(), 0u) << "or nothing is shown here: pairs build on earlier ones";
  look_on();
  stream_->watched_by(2);
  run(1s);
  EXPECT_GT(seen_.size() + 3, came_.size());
  expect_the_same();
  look_on();  // it alone lost some
  run(CodedStream::kAnewEvery + 1s);
  EXPECT_GT(seen_.size(), 0u);
  expect_the_same();
  onlooker_.reset();
  expect_true(28);
}

}  // namespace
}  // namespace foresight::link::coded_line_test
