#include "link/operator_side/pair_intake.hpp"

#include <zlib.h>

#include <random>

#include "described.hpp"
#include "link/messages/pair_notes.hpp"
#include "link/send_control/line_trial.hpp"
#include "link/send_control/packets.hpp"
#include "pictures/encode.hpp"
#include "scene/coding_loss.hpp"
#include "tests/link/random_message.hpp"

namespace foresight::link::pair_intake_test {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;

constexpr std::uint64_t kReader = 5;

class Intake : public testing::Test {
 protected:
  void SetUp() override { clock_.sleep_until(RobotTime{} + 10s); }

  StereoFrame jpeg(std::uint64_t number, std::uint64_t session = 77) const {
    const StereoPicture picture = moving_picture(clock_.now(), {160, 120});
    StereoFrame out = described(session, number, picture);
    out.coding = kJpegCoding;
    out.left.data = encode_jpeg(picture.left, 90);
    out.right.data = encode_jpeg(picture.right, 90);
    return out;
  }
  LineFramePtr take(const StereoFrame& frame) { return intake_.take(frame, 1000, robot_); }
  std::string refusal(const StereoFrame& frame) {
    EXPECT_FALSE(take(frame));
    return intake_.counts().refusal;
  }
  /// A coded pair of `picture` with those notes, piece by piece, in a stream of its own.
  LineFramePtr take_coded(const StereoFrame& notes, const StereoPicture& picture, const Bytes& left_lost = {},
                          const Bytes& loss_shares = {}) {
    const auto encoder = make_pair_encoder(Coding::h264);
    CodedPair pair = encoder->encode(picture, {.number = 1, .bytes = 8000});
    pair.notes = to_notes({notes, left_lost, loss_shares});
    const std::vector<std::uint8_t> bytes = to_bytes(pair);
    ++stream_;
    LineFramePtr out;
    Piece piece{.pair = 1, .count = static_cast<std::uint16_t>((bytes.size() + kPieceBytes - 1) / kPieceBytes)};
    piece.pair_bytes = static_cast<std::uint32_t>(bytes.size());
    for (; piece.index < piece.count; ++piece.index) {
      piece.sequence = piece.index + 1U;
      piece.data = std::span(bytes).subspan(piece.index * kPieceBytes);
      piece.data = piece.data.first(std::min(kPieceBytes, piece.data.size()));
      out = intake_.take(StereoPiece{77, kReader, stream_, to_packet(piece)}, robot_, whole_);
    }
    return out;
  }
  /// The clocks meet: the robot's is `ahead`, the round trip 40 ms.
  void meet(Duration ahead) {
    const OperatorTime sent{clock_.now().ns};
    const auto ping = robot_.ping(sent);
    clock_.sleep_until(clock_.now() + 40ms);
    const std::int64_t there = (sent + 20ms + ahead).ns;
    robot_.pong({ping->number, there, there}, OperatorTime{clock_.now().ns});
  }

  SteppedClock clock_;
  PairIntake intake_{kReader, {{}, {"elbow", "wrist", "finger"}, {{160, 120, 160, 120}}}, clock_};
  RobotClockTracker robot_;
  std::uint32_t stream_ = 0;
  std::function<void()> whole_;
};

TEST_F(Intake, AJpegPairComesOutAsItWentIn) {
  const StereoFrame sent = jpeg(3);
  const LineFramePtr frame = take(sent);
  ASSERT_TRUE(frame) << intake_.counts().refusal;
  EXPECT_EQ(frame->number, 3u);
  EXPECT_EQ(frame->image[1].T_world_camera->translation().z(), 0.065);
  EXPECT_EQ(frame->image[0].uncertainty, 500ns);
  EXPECT_FALSE(frame->captured) << "the clocks have not met";
  EXPECT_GT(luma_psnr_db({frame->image[0].bgr, frame->image[1].bgr, {}}, moving_picture(clock_.now(), {160, 120})), 30);
  EXPECT_FALSE(take(sent)) << "it has come before";
  EXPECT_EQ(intake_.counts().late, 1u);
  EXPECT_TRUE(take(jpeg(4)));
}

TEST_F(Intake, StampsAreConvertedByTheClocksWithTheirBound) {
  meet(3600s);
  StereoFrame sent = jpeg(1);
  sent.left.capture_ns = (clock_.now() + 3600s - 100ms).ns;  // 100 ms ago
  sent.right.capture_ns = sent.left.capture_ns;
  sent.stamps.coded_ns = sent.left.capture_ns + 30'000'000;
  const LineFramePtr frame = take(sent);
  ASSERT_TRUE(frame && frame->captured) << intake_.counts().refusal;
  const Duration off = frame->captured->time - OperatorTime{(clock_.now() - 100ms).ns};
  EXPECT_LE(std::abs(off.count()), frame->captured->uncertainty.count());
  EXPECT_LE(frame->captured->uncertainty, Duration(21ms));
  EXPECT_EQ(frame->ages.coded, Duration(30ms));
  ASSERT_TRUE(frame->ages.arrived);
  EXPECT_NEAR(to_seconds(frame->ages.arrived->delay), 0.1, to_seconds(frame->ages.arrived->uncertainty));
  sent.number = 2;
  sent.right.capture_ns += Duration(200ms).count();
  EXPECT_THAT(refusal(sent), HasSubstr("right lies 0."));
  EXPECT_THAT(refusal(sent), HasSubstr("in the future"));
}

TEST_F(Intake, WhatIsNotAsItShouldBeIsRefusedInWords) {
  const auto with = [&](auto&& change) {
    StereoFrame frame = jpeg(1);
    change(frame);
    return refusal(frame);
  };
  EXPECT_EQ(with([](StereoFrame& f) { f.joints[0].position = NAN; }), "joints[0].position is nan");
  EXPECT_THAT(with([](StereoFrame& f) { f.joints[0].name = "elbov"; }), HasSubstr("did you mean 'elbow'?"));
  EXPECT_THAT(with([](StereoFrame& f) { f.left.width = 320; }), HasSubstr("its lens was calibrated at 160 x 120"));
  EXPECT_THAT(with([](StereoFrame& f) { f.right.data.resize(f.right.data.size() / 2); }),
              HasSubstr("right.data is no JPEG"));
  EXPECT_THAT(with([](StereoFrame& f) { f.left.data = encode_jpeg(cv::Mat(60, 80, CV_8UC3), 90); }),
              HasSubstr("left.data is no JPEG"));
  EXPECT_THAT(with([](StereoFrame& f) { f.coding = "gif"; }), HasSubstr("coding is 'gif'"));
  EXPECT_EQ(intake_.counts().pairs, 0u);
  EXPECT_TRUE(take(jpeg(1)));
}

TEST_F(Intake, ACodedPairsNotesAreHeldAgainstItsPictures) {
  const StereoPicture picture = moving_picture(clock_.now(), {160, 120});
  const auto notes = [&](std::uint64_t number) {
    StereoFrame out = described(77, number, picture);
    out.coding = kH264Coding;
    return out;
  };
  EXPECT_TRUE(take_coded(notes(1), picture)) << intake_.counts().refusal;
  const auto refused = [&](const StereoFrame& wrong, const StereoPicture& with, const char* words) {
    EXPECT_FALSE(take_coded(wrong, with));
    EXPECT_THAT(intake_.counts().refusal, HasSubstr(words));
  };
  StereoFrame wrong = notes(2);
  wrong.left.capture_ns += 1;
  refused(wrong, picture, "two capture instants");
  wrong = notes(2);
  wrong.session = 78;
  refused(wrong, picture, "another start");
  wrong = notes(2);
  wrong.left.t_world_camera.position.x = INFINITY;
  refused(wrong, picture, "position.x is inf");
  refused(notes(2), moving_picture(clock_.now(), {96, 64}), "of the size that its notes say");
  refused(notes(2), moving_picture(clock_.now(), {160, 120}, /*colour=*/false), "not in colour");
  EXPECT_FALSE(take_coded(notes(2), picture, {1, 2, 3}));
  EXPECT_THAT(intake_.counts().refusal, HasSubstr("what coding took away"));
  EXPECT_FALSE(take_coded(notes(2), picture, {}, {1, 2, 3}));
  EXPECT_THAT(intake_.counts().refusal, HasSubstr("not told by contrast"));
  LossShares shares;
  shares.fill({0, 0.04, 0.16, 0.36, 1});
  const LineFramePtr frame = take_coded(notes(2), picture, Bytes(kLossRows * kLossColumns, 3), to_bytes(shares));
  ASSERT_TRUE(frame) << intake_.counts().refusal;
  EXPECT_EQ(cv::countNonZero(frame->image[0].lost == 3), kLossRows * kLossColumns);
  EXPECT_EQ(frame->image[0].loss_shares, loss_shares_of(to_bytes(shares)));
  EXPECT_TRUE(take_coded(notes(3), picture)->image[0].lost.empty());
}

TEST_F(Intake, AnotherStartOfTheRobotIsBelievedOnceThisOneIsSilent) {
  EXPECT_TRUE(take(jpeg(9, 77)));
  EXPECT_FALSE(take(jpeg(1, 78))) << "a recording, or a second robot";
  clock_.sleep_until(clock_.now() + PairIntake::kBelieves + 1ms);
  EXPECT_TRUE(take(jpeg(1, 78)));
  EXPECT_FALSE(take(jpeg(10, 77)));
}

TEST_F(Intake, ReportsComeAtTheirRate) {
  int reports = 0;
  for (int i = 0; i < 1000; ++i, clock_.sleep_until(clock_.now() + 1ms)) reports += intake_.report().has_value();
  EXPECT_EQ(reports, 4);
}

// Decoding takes milliseconds, which must not look like the line's: what came is told before, what was decoded after.
TEST_F(Intake, PiecesAreAcknowledgedBeforeTheirPairIsDecoded) {
  std::optional<StereoReport> before;
  std::uint64_t pairs_before = 99;
  whole_ = [&] {
    before = intake_.report();
    pairs_before = intake_.counts().pairs;
  };
  const StereoPicture picture = moving_picture(clock_.now(), {160, 120});
  StereoFrame notes = described(77, 1, picture);
  notes.coding = kH264Coding;
  ASSERT_TRUE(take_coded(notes, picture)) << intake_.counts().refusal;
  EXPECT_EQ(pairs_before, 0u);
  const auto after = intake_.report();
  ASSERT_TRUE(before && after);
  const auto told = [](const StereoReport& report) {
    return std::get<Acknowledgement>(parse_packet(report.acknowledgement));
  };
  EXPECT_EQ(told(*before).newest, intake_.counts().packets);
  EXPECT_TRUE(told(*before).decoded.empty());
  EXPECT_EQ(told(*after).decoded, std::vector<std::uint32_t>{1});
  EXPECT_EQ(after->newest_shown, 1u);
}

TEST_F(Intake, PiecesOfOthersAreNotTouched) {
  EXPECT_FALSE(intake_.take(StereoPiece{77, kReader + 1, 1, to_packet(Question{1})}, robot_));
  EXPECT_EQ(intake_.counts().others, 1u);
  EXPECT_EQ(intake_.counts().packets, 0u);
}

TEST(PairNotes, ComeBackAndRefuseAnythingElse) {
  std::mt19937 random(7);
  StereoFrame frame = random_message<StereoFrame>(random);
  frame.left.data.clear();
  frame.right.data.clear();
  const Bytes notes = to_notes({frame, {0, 3, 6}, {7, 255}});
  const auto back = from_notes(notes);
  ASSERT_TRUE(back);
  EXPECT_EQ(to_cdr(back->frame), to_cdr(frame));
  EXPECT_EQ(back->left_lost, (Bytes{0, 3, 6}));
  EXPECT_EQ(back->loss_shares, (Bytes{7, 255}));
  for (std::size_t size = 0; size < notes.size(); ++size) EXPECT_FALSE(from_notes(std::span(notes).first(size)));
  StereoFrame large;
  large.left.data.resize(kMostNotesInflated);
  EXPECT_THROW(to_notes({large, {}, {}}), std::exception);
}

/// As older programs wrote them.
Bytes deflated(const Bytes& cdr) {
  uLongf size = compressBound(cdr.size());
  Bytes out(size);
  EXPECT_EQ(compress(out.data(), &size, cdr.data(), cdr.size()), Z_OK);
  out.resize(size);
  return out;
}

TEST(PairNotes, OfOlderRecordingsTellLess) {
  std::mt19937 random(7);
  const StereoFrame frame = random_message<StereoFrame>(random);
  const Bytes alone = to_cdr(frame);
  auto back = from_notes(deflated(alone));
  ASSERT_TRUE(back);
  EXPECT_EQ(to_cdr(back->frame), alone);
  EXPECT_TRUE(back->left_lost.empty() && back->loss_shares.empty());

  Bytes with_steps = to_cdr(PairNotes{frame, {0, 3, 6, 1}, {}});
  with_steps.resize(with_steps.size() - sizeof(std::uint32_t));  // the number of shares
  back = from_notes(deflated(with_steps));
  ASSERT_TRUE(back);
  EXPECT_EQ(to_cdr(back->frame), alone);
  EXPECT_EQ(back->left_lost, (Bytes{0, 3, 6, 1}));
  EXPECT_TRUE(back->loss_shares.empty());
}

// They share a thin line with pictures of some 5,000 bytes.
TEST(PairNotes, AreSmall) {
  std::mt19937 random(8);
  const auto any = [&] { return std::uniform_real_distribution<double>(-1, 1)(random); };
  StereoFrame frame = described(0x1234567890abcdef, 100'000, moving_picture(RobotTime{3'600'123'456'789}));
  frame.lenses_revision = "0123456789abcdef";
  frame.joints.clear();
  for (const char* name : {"shoulder_yaw", "shoulder_pitch", "upper_arm_roll", "elbow", "forearm_roll", "wrist_pitch",
                           "wrist_roll", "finger", "pan", "tilt"})
    frame.joints.push_back({name, JointSample::kKnown, any()});
  for (CodedImage* image : {&frame.left, &frame.right})
    for (double* value : {&image->t_world_camera.position.x, &image->t_world_camera.position.y,
                          &image->t_world_camera.position.z, &image->t_world_camera.orientation.x})
      *value = any();
  EXPECT_LT(to_notes({frame, {}, {}}).size(), 500u);
}

// Bytes that anybody may send: nothing crashes, and nothing is shown.
TEST_F(Intake, AnyBytesDoNoHarm) {
  std::mt19937 random(9);
  const StereoFrame good = jpeg(1);
  const Bytes frame = to_cdr(good);
  const StereoPicture picture = moving_picture(clock_.now(), {160, 120});
  for (int i = 0; i < 600; ++i) {
    Bytes bytes = frame;
    for (int k = 0; k < 3; ++k)
      bytes[random() % std::min<std::size_t>(bytes.size(), i % 2 ? 700 : bytes.size())] =
          static_cast<std::uint8_t>(random());
    if (const auto message = from_cdr<StereoFrame>(bytes)) take(*message);
    StereoPiece piece{77, kReader, static_cast<std::uint32_t>(random() % 3), {}};
    piece.data.resize(random() % 1300);
    for (std::uint8_t& byte : piece.data) byte = static_cast<std::uint8_t>(random());
    if (!piece.data.empty()) piece.data[0] = "pqax"[random() % 4];
    EXPECT_FALSE(intake_.take(piece, robot_));
    intake_.report();
  }
}

}  // namespace
}  // namespace foresight::link::pair_intake_test
