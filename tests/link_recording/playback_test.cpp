// What is played of a recording, when, and with which stamps.
#include <gmock/gmock.h>

#include "link/control_wire/control_wire.hpp"
#include "link/dds/topics.hpp"
#include "link/messages/cdr.hpp"
#include "link/messages/message_types.hpp"
#include "link/recording/line_recorder.hpp"
#include "link/recording/playback.hpp"

namespace foresight::link::playback_test {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;

constexpr std::int64_t kSecond = 1'000'000'000;

// A robot's wall clock and monotonic clock as they were, and the recorder's, which is another host's.
constexpr std::int64_t kWall = 1'600'000'000 * kSecond, kMonotonic = 777 * kSecond, kLog = kWall + 5 * kSecond;
constexpr std::int64_t kNow = 1'700'000'000 * kSecond;
constexpr RobotTime kStart{50 * kSecond};

class Recorded {
 public:
  explicit Recorded(const Topic& topic) {
    channel_.topic = topic_in_ros(topic.name);
    channel_.message_encoding = "cdr";
    channel_.schema = std::make_shared<const McapSchema>(McapSchema{ros_name(topic.type), "ros2msg", ""});
  }
  /// Written `written` ns after the recording's begin, and 30 ms on its way.
  template <detail::Message T>
  std::vector<Playback::Message> play(Playback& playback, const T& message, std::int64_t written) {
    const Bytes cdr = to_cdr(message);
    return playback.take({channel_, 1, kLog + written + 30'000'000, kWall + written, cdr});
  }
  std::vector<Playback::Message> play_bytes(Playback& playback, const Bytes& cdr, std::int64_t log_ns,
                                            std::int64_t publish_ns) {
    return playback.take({channel_, 1, log_ns, publish_ns, cdr});
  }

 private:
  McapChannel channel_;
};

StereoFrame frame_at(std::int64_t captured) {
  StereoFrame out;
  out.header.stamp = ros_time(kWall + captured);
  out.session = 11;
  out.number = 1;
  out.left.capture_ns = out.right.capture_ns = kMonotonic + captured;
  out.left.uncertainty_ns = 123;
  out.stamps.coded_ns = kMonotonic + captured + 20'000'000;
  out.left.data = out.right.data = {1};
  return out;
}

TFMessage transform_at(std::int64_t time) {
  TFMessage out;
  out.transforms.resize(1);
  out.transforms[0].header.stamp = ros_time(kWall + time);
  out.transforms[0].child_frame_id = "left_camera";
  return out;
}

// One instant stays one instant on all topics and both clocks; what was sent 40 ms after its capture is so again.
TEST(Playback, MovesAllStampsByTheSame) {
  Playback playback(kStart, kNow, {});
  Recorded frames(topics::frames()), transforms(topics::transforms());
  const auto first = frames.play(playback, frame_at(-40'000'000), 0);
  ASSERT_EQ(first.size(), 1u);
  EXPECT_EQ(first[0].topic->name, "rt/foresight/frames");
  EXPECT_EQ(first[0].due, kStart);
  const auto frame = from_cdr<StereoFrame>(first[0].cdr);
  ASSERT_TRUE(frame);
  EXPECT_EQ(unix_ns(frame->header.stamp), kNow - 40'000'000);
  EXPECT_EQ(frame->left.capture_ns, kStart.ns - 40'000'000);
  EXPECT_EQ(frame->right.capture_ns, kStart.ns - 40'000'000);
  EXPECT_EQ(frame->stamps.coded_ns, kStart.ns - 20'000'000);
  EXPECT_EQ(frame->stamps.paired_ns, 0) << "was never stamped";
  EXPECT_EQ(frame->left.uncertainty_ns, 123) << "is no instant";
  const auto later = transforms.play(playback, transform_at(-40'000'000), 3 * kSecond);
  ASSERT_EQ(later.size(), 1u);
  EXPECT_EQ(later[0].due, kStart + 3s);
  EXPECT_EQ(unix_ns(from_cdr<TFMessage>(later[0].cdr)->transforms[0].header.stamp), kNow - 40'000'000);
}

TEST(Playback, IsAnotherStartOfTheRobotsProgram) {
  PlaybackOptions options;
  options.session = 0xabc;
  Playback playback(kStart, kNow, options);
  Recorded frames(topics::frames()), states(topics::robot_state());
  const auto frame = from_cdr<StereoFrame>(frames.play(playback, frame_at(0), 0).at(0).cdr);
  RobotState state;
  state.header.stamp = ros_time(kWall + 1000);
  state.time_ns = kMonotonic + 1000;
  state.session = 11;
  const auto played = from_cdr<RobotState>(states.play(playback, state, 2000).at(0).cdr);
  EXPECT_EQ(frame->session, 11u ^ 0xabcu);
  EXPECT_EQ(played->session, frame->session);
  EXPECT_EQ(played->time_ns, kStart.ns + 1000);
}

TEST(Playback, AtTwiceTheRateEverythingLiesHalfAsFarApart) {
  PlaybackOptions options;
  options.rate = 2;
  Playback playback(kStart, kNow, options);
  Recorded frames(topics::frames());
  frames.play(playback, frame_at(0), 0);
  const auto later = frames.play(playback, frame_at(4 * kSecond - 50'000'000), 4 * kSecond);
  EXPECT_EQ(later.at(0).due, kStart + 2s);
  EXPECT_EQ(from_cdr<StereoFrame>(later[0].cdr)->left.capture_ns, kStart.ns + 2 * kSecond - 25'000'000);
}

// What robots are told, who commands, and set-points are in a recording, and stay there.
TEST(Playback, NothingThatCouldCommandIsPlayed) {
  Playback playback(kStart, kNow, {});
  const FromOperator set_point{1, 2, SetPoint{}};
  Recorded commands({"rt/foresight/control/operator/messages", kFromOperatorType}),
      answers({"rt/foresight/control/robot/messages", kFromRobotType}), set_points(topics::set_points()),
      reports(topics::reports()), strange({"rt/cmd_vel", Twist::kType}),
      disguised({"rt/foresight/frames", kFromOperatorType});
  EXPECT_TRUE(commands.play_bytes(playback, to_bytes(set_point), kLog, kWall).empty());
  EXPECT_TRUE(answers.play_bytes(playback, to_bytes(FromRobot{}), kLog, kWall).empty());
  EXPECT_TRUE(set_points.play(playback, JointTrajectory{}, 0).empty());
  EXPECT_TRUE(reports.play(playback, StereoReport{}, 0).empty());
  EXPECT_TRUE(strange.play(playback, Twist{}, 0).empty());
  EXPECT_TRUE(disguised.play_bytes(playback, to_bytes(set_point), kLog, kWall).empty());
  EXPECT_EQ(playback.left_out().size(), 6u);
  for (const Topic& topic : played_topics()) {
    EXPECT_THAT(topic.name, testing::Not(HasSubstr("control")));
    EXPECT_NE(topic.type, kFromOperatorType);
    EXPECT_NE(topic.type, JointTrajectory::kType);
  }
}

// Who comes late to a played line gets what who came late to the robot got, wherever it begins.
TEST(Playback, FromLaterOnBeginsWithTheLastOfWhatIsKept) {
  PlaybackOptions options;
  options.from = 5s;
  Playback playback(kStart, kNow, options);
  Recorded frames(topics::frames()), fixed(topics::static_transforms());
  const Bytes old = to_cdr(transform_at(-600 * kSecond));  // written long before it came
  EXPECT_TRUE(fixed.play_bytes(playback, old, kLog, kWall - 600 * kSecond).empty());
  EXPECT_TRUE(frames.play(playback, frame_at(0), 0).empty());
  EXPECT_TRUE(fixed.play(playback, transform_at(kSecond), kSecond).empty());
  const auto begin = frames.play(playback, frame_at(6 * kSecond), 6 * kSecond);
  ASSERT_EQ(begin.size(), 2u);
  EXPECT_EQ(begin[0].topic->name, "rt/tf_static");
  EXPECT_EQ(unix_ns(from_cdr<TFMessage>(begin[0].cdr)->transforms[0].header.stamp), kNow - 5 * kSecond);
  EXPECT_EQ(begin[0].due, kStart);
  EXPECT_EQ(begin[1].due, kStart);
}

// An outage of the line while it was recorded is none when it is played; a clock that was set costs nothing either.
TEST(PlayedTime, GoesByTheWritersClockAsLongAsThatGoesOn) {
  PlayedTime time(kStart, kNow, 1);
  EXPECT_EQ(time.due(kLog, kWall, false), kStart);
  EXPECT_EQ(time.due(kLog + 20 * kSecond, kWall + kSecond, false), kStart + 1s);  // held up for 19 s
  EXPECT_EQ(time.due(kLog + 20 * kSecond, kWall + 2 * kSecond, false), kStart + 2s);
  EXPECT_EQ(time.due(kLog + 20 * kSecond, kWall + kSecond, false), kStart + 2s) << "never back";
  EXPECT_EQ(time.due(kLog + 21 * kSecond, kWall - 600 * kSecond, true), kStart + 2s) << "kept: it was written long ago";
  constexpr std::int64_t kYears = 100'000'000 * kSecond;
  EXPECT_EQ(time.due(kLog + 24 * kSecond, kWall + kYears, false), kStart + 6s) << "the clock was set";
  EXPECT_EQ(time.unix_ns(kWall + kYears), kNow + 6 * kSecond);
  EXPECT_EQ(time.due(kLog + 25 * kSecond, kWall + kYears + kSecond, false), kStart + 7s);
}

// A file may say anything.
TEST(PlayedTime, TakesAnyNumbers) {
  std::vector<std::int64_t> numbers{INT64_MIN, INT64_MIN + 1, -1, 0, 1, kWall, INT64_MAX - 1, INT64_MAX};
  for (const double rate : {0.01, 1.0, 100.0})
    for (const std::int64_t a : numbers)
      for (const std::int64_t b : numbers) {
        PlayedTime time(kStart, kNow, rate);
        RobotTime last = time.due(a, b, false);
        time.learn(a, b, true);
        for (const std::int64_t c : numbers) {
          const RobotTime due = time.due(c, a, c % 2 == 0);
          EXPECT_GE(due, last);
          last = due;
          (void)time.unix_ns(c);
          (void)time.monotonic_ns(c);
        }
      }
}

}  // namespace
}  // namespace foresight::link::playback_test
