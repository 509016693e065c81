#include "session/live_frames.hpp"

#include <gmock/gmock.h>

#include <latch>
#include <semaphore>

namespace foresight::live_frames_test {
namespace {

using namespace std::chrono_literals;

StereoPair pair_at(Duration time) {
  StereoPair pair;
  pair.left.time = pair.right.time = RobotTime{} + time;
  pair.left.bgr = cv::Mat(2, 2, CV_8UC3, cv::Scalar::all(1));
  pair.right.bgr = cv::Mat(2, 2, CV_8UC3, cv::Scalar::all(2));
  return pair;
}

/// Says where cameras were: as far along x as seconds have passed.
class Scripted final : public PoseSource {
 public:
  bool is_ready(const StereoPair& pair) override { return pair.left.time <= known; }
  PairPoses poses_of(const StereoPair& pair) override {
    asked.push_back(pair.left.time);
    if (on_ask) on_ask();
    PairPoses out;
    out.quality = quality;
    out.predicted_px = predicted_px;
    if (quality == "lost" || quality == "none") return out;
    Pose T = Pose::Identity();
    T.translation().x() = to_seconds(pair.left.time - RobotTime{});
    out.T_world_camera = {T, T};
    return out;
  }

  RobotTime known{INT64_MAX};
  std::string quality = "tags";
  std::optional<double> predicted_px;
  std::function<void()> on_ask;
  std::vector<RobotTime> asked;
};

class LiveFramesTest : public testing::Test {
 protected:
  static std::vector<std::uint64_t> numbers(FrameQueue& queue) {
    std::vector<std::uint64_t> out;
    while (const auto frame = queue.take(0ns)) out.push_back((*frame)->number);
    return out;
  }
  void add_and_step(int pairs) {
    for (int i = 0; i < pairs; ++i) {
      clock_.sleep_until(clock_.now() + 33ms);
      frames_.add(pair_at(clock_.now() - RobotTime{}));
      frames_.step();
    }
  }

  SteppedClock clock_;
  std::shared_ptr<Scripted> poses_ = std::make_shared<Scripted>();
  LiveFrames frames_{poses_, clock_};
};

TEST_F(LiveFramesTest, RegistersOnceAndHandsTheSameToAll) {
  const auto one = frames_.subscribe(10), other = frames_.subscribe(10);
  add_and_step(3);
  EXPECT_EQ(poses_->asked.size(), 3u);
  for (int i = 1; i <= 3; ++i) {
    const auto a = one->take(0ns), b = other->take(0ns);
    ASSERT_TRUE(a && b);
    EXPECT_EQ(*a, *b) << "no copy";
    EXPECT_EQ((*a)->number, static_cast<std::uint64_t>(i));
    const PosedFrame& posed = (*a)->posed.value();
    EXPECT_EQ(posed.left.time, (*a)->pair.left.time);
    EXPECT_EQ(posed.left.pixels.data, (*a)->pair.left.bgr.data);
    EXPECT_EQ(posed.right.value().pixels.data, (*a)->pair.right.bgr.data);
    EXPECT_DOUBLE_EQ(posed.left.T_world_camera.translation().x(), 0.033 * i);
    EXPECT_FALSE(posed.left.margin_px) << "exact poses need no wider one";
  }
}

TEST_F(LiveFramesTest, ASlowSubscriberLosesItsOldestAndHoldsUpNobody) {
  const auto slow = frames_.subscribe(2), quick = frames_.subscribe(10);
  add_and_step(6);
  EXPECT_THAT(numbers(*quick), testing::ElementsAre(1, 2, 3, 4, 5, 6));
  EXPECT_EQ(quick->dropped(), 0u);
  EXPECT_EQ(slow->dropped(), 4u);
  EXPECT_THAT(numbers(*slow), testing::ElementsAre(5, 6));
  add_and_step(3);
  EXPECT_EQ((*slow->take_newest(0ns))->number, 9u);
  EXPECT_EQ(slow->dropped(), 6u);
}

TEST_F(LiveFramesTest, WhoGoesIsForgotten) {
  frames_.subscribe(1);
  const auto stays = frames_.subscribe(1);
  add_and_step(1);
  EXPECT_THAT(numbers(*stays), testing::ElementsAre(1));
}

TEST_F(LiveFramesTest, APairWaitsForTheEncodersOfItsInstant) {
  const auto queue = frames_.subscribe(10);
  poses_->known = RobotTime{};
  add_and_step(1);
  EXPECT_FALSE(queue->take(0ns)) << "not known yet";
  poses_->known = clock_.now();
  frames_.step();
  EXPECT_TRUE(queue->take(0ns));
}

TEST_F(LiveFramesTest, ButNotForEver) {
  const auto queue = frames_.subscribe(10);
  poses_->known = RobotTime{};
  poses_->quality = "lost";
  add_and_step(1);
  clock_.sleep_until(clock_.now() + LiveFrameOptions{}.patience - 1ms);
  frames_.step();
  EXPECT_FALSE(queue->take(0ns));
  clock_.sleep_until(clock_.now() + 1ms);
  frames_.step();
  const auto frame = queue->take(0ns);
  ASSERT_TRUE(frame);
  EXPECT_FALSE((*frame)->posed) << "and says that it has no pose";
  EXPECT_EQ((*frame)->quality, "lost");
}

TEST_F(LiveFramesTest, WithoutAPoseTheImagesComeAllTheSame) {
  const auto queue = frames_.subscribe(10);
  poses_->quality = "none";
  add_and_step(1);
  const auto frame = queue->take(0ns);
  ASSERT_TRUE(frame);
  EXPECT_FALSE((*frame)->posed);
  EXPECT_EQ((*frame)->quality, "none");
  EXPECT_EQ((*frame)->pair.right.bgr.at<cv::Vec3b>(0, 0)[0], 2);
}

TEST_F(LiveFramesTest, TheMarginFollowsTheExpectedError) {
  const auto queue = frames_.subscribe(10);
  for (const double px : {0.0, 1.0, 100.0}) {
    poses_->predicted_px = px;
    add_and_step(1);
    const auto frame = queue->take(0ns);
    EXPECT_DOUBLE_EQ((*frame)->posed->left.margin_px.value(), margin_for(LiveFrameOptions{}.margin_px, px));
    EXPECT_EQ((*frame)->posed->left.margin_px, (*frame)->posed->right->margin_px);
  }
}

TEST_F(LiveFramesTest, ARegistrationThatThrowsIsSaidAndGoesOn) {
  const auto queue = frames_.subscribe(10);
  poses_->on_ask = [] { throw std::runtime_error("no such tag"); };
  add_and_step(1);
  EXPECT_EQ(frames_.fault(), "no such tag");
  EXPECT_EQ((*queue->take(0ns))->quality, "lost");
  poses_->on_ask = {};
  add_and_step(1);
  EXPECT_EQ(frames_.fault(), "");
  EXPECT_TRUE((*queue->take(0ns))->posed);
}

TEST_F(LiveFramesTest, StoppedItHandsOutTheRestAndClosesAllQueues) {
  const auto queue = frames_.subscribe(10);
  poses_->known = RobotTime{};
  add_and_step(2);
  frames_.stop();
  EXPECT_THAT(numbers(*queue), testing::ElementsAre(1, 2));
  EXPECT_TRUE(queue->closed());
  EXPECT_TRUE(frames_.subscribe(1)->closed());
  frames_.add(pair_at(9s));
  EXPECT_FALSE(queue->take(1s)) << "does not wait for what will not come";
}

TEST_F(LiveFramesTest, ASlowRegistrationHoldsUpNoCamera) {
  MonotonicClock clock;
  std::latch begun(1);
  std::binary_semaphore go_on(0);
  poses_->on_ask = [&] {
    if (poses_->asked.size() > 1) return;
    begun.count_down();
    go_on.acquire();
  };
  LiveFrames frames(poses_, clock);
  const auto queue = frames.subscribe(20);
  frames.start();
  frames.add(pair_at(1ms));
  begun.wait();
  for (int i = 2; i <= 10; ++i) frames.add(pair_at(i * 1ms));  // comes back each time
  EXPECT_EQ(frames.dropped(), 9 - LiveFrameOptions{}.waiting);
  go_on.release();
  std::vector<std::uint64_t> got;
  while (got.size() < 5) {
    const auto frame = queue->take(10s);
    ASSERT_TRUE(frame);
    got.push_back((*frame)->number);
  }
  EXPECT_THAT(got, testing::ElementsAre(1, 7, 8, 9, 10)) << "the oldest that waited went";
  frames.stop();
}

}  // namespace
}  // namespace foresight::live_frames_test
