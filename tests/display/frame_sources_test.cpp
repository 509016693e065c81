// A recorded run and live cameras bring the same frames to the same instants.
#include <deque>

#include "display/live_source.hpp"
#include "display/recorded_source.hpp"
#include "tests/scene/test_run.hpp"

namespace foresight::frame_sources_test {
namespace {

using namespace std::chrono_literals;

bool same(const cv::Mat& a, const cv::Mat& b) {
  return a.size() == b.size() && a.type() == b.type() && cv::norm(a, b, cv::NORM_INF) == 0;
}

bool same(const PosedImage& a, const PosedImage& b) {
  return same(a.pixels, b.pixels) && a.time == b.time && a.T_world_camera.isApprox(b.T_world_camera, 0) &&
         a.scene.T_world_node.size() == b.scene.T_world_node.size() && a.margin_px == b.margin_px;
}

/// Cameras that a test plays.
struct Cameras {
  std::deque<LiveImage> images;
  bool closed = false;
  std::string trouble;

  LiveFeed feed() {
    return {[this](Duration) -> std::optional<LiveImage> {
              if (images.empty()) return std::nullopt;
              LiveImage image = std::move(images.front());
              images.pop_front();
              return image;
            },
            [this] { return closed; }, [this] { return trouble; }};
  }
  void bring(std::uint64_t number, std::optional<PosedFrame> frame) { images.push_back({number, std::move(frame)}); }
  void bring_unposed(std::uint64_t number, const cv::Mat& left, const std::string& lacks) {
    images.push_back({number, std::nullopt, left, lacks});
  }
};

class FrameSources : public testing::Test {
 protected:
  FrameSources() {
    // Five images, at uneven intervals.
    run_.write("rgb.txt",
               "1700000000.0 rgb/a.png\n1700000000.1 rgb/b.png\n1700000000.19 rgb/c.jpg\n1700000000.3 rgb/d.png\n"
               "1700000000.35 rgb/e.png\n");
    run_.write("rgb/d.png", encoded(".png", 200 - test_pixels()));
    run_.write("rgb/e.png", encoded(".png", test_pixels() / 2));
    run_.write("trajectory.txt",
               "1700000000.0 0 0 0 0 0 0 1\n1700000000.1 1 0 0 0 0 0 1\n1700000000.2 2 0 0 0 0 0 1\n"
               "1700000000.3 2 1 0 0 0 0 1\n1700000000.4 2 2 0 0 0 0 1\n");
    run_.write("registration.txt",
               "1700000000.0 tags 0.5\n1700000000.1 tags 1.5\n1700000000.19 held 2\n1700000000.3 tags 0.25\n"
               "1700000000.35 tags 0.75\n");
    folder_.emplace(RunFolder::open(run_.path(), {}));
  }
  PosedFrame frame(std::size_t i) const { return load_posed_frame(*folder_, i, 1.5); }

  TestRun run_;
  std::optional<RunFolder> folder_;
  SteppedClock clock_;
  Cameras cameras_;
};

class Delays : public FrameSources, public testing::WithParamInterface<int> {};

TEST_P(Delays, BothBringTheSameFramesToTheSameInstants) {
  const Duration delay = std::chrono::milliseconds(GetParam());
  RecordedSource recorded(*folder_, arrivals_after(*folder_, delay), 1.5, false);
  LiveSource live(cameras_.feed(), clock_, {.delay = delay, .real_time = false});
  std::size_t frames = 0;
  for (std::size_t i = 0; i < folder_->frames().size(); ++i) {
    SCOPED_TRACE(i);
    EXPECT_EQ(live.advance(), SourceState::waiting) << "the image has not come yet";
    cameras_.bring(i, frame(i));
    ASSERT_EQ(recorded.advance(), SourceState::ready);
    ASSERT_EQ(live.advance(), SourceState::ready);
    EXPECT_EQ(live.instant().time, recorded.instant().time);
    EXPECT_EQ(live.instant().blind, recorded.instant().blind);
    EXPECT_FALSE(live.instant().late || recorded.instant().late);
    while (const auto expected = recorded.arrived()) {
      const auto got = live.arrived();
      ASSERT_TRUE(got);
      EXPECT_TRUE(same(got->left, expected->left));
      EXPECT_LE(got->left.time, live.instant().time - delay) << "nothing younger than the delay";
      ++frames;
    }
    EXPECT_FALSE(live.arrived());
    EXPECT_TRUE(live.place().T_world_camera.isApprox(recorded.place().T_world_camera, 0));
    EXPECT_TRUE(same(live.actual(), recorded.actual()));
  }
  cameras_.closed = true;
  EXPECT_EQ(recorded.advance(), SourceState::ended);
  EXPECT_EQ(live.advance(), SourceState::ended);
  EXPECT_EQ(live.overtaken() + recorded.overtaken(), 0u);
  EXPECT_EQ(frames, GetParam() == 0 ? 5u : GetParam() == 100 ? 3u : GetParam() == 170 ? 2u : 0u);
}

INSTANTIATE_TEST_SUITE_P(Milliseconds, Delays, testing::Values(0, 100, 170, 1000));

TEST_F(FrameSources, InRealTimeTheNewestFrameAndInstantCount) {
  LiveSource live(cameras_.feed(), clock_, {.delay = 100ms, .real_time = true});
  for (std::size_t i = 0; i < 5; ++i) cameras_.bring(i, frame(i));
  for (int late = 0; late < 4; ++late) {
    ASSERT_EQ(live.advance(), SourceState::ready);
    EXPECT_TRUE(live.instant().late);
  }
  ASSERT_EQ(live.advance(), SourceState::ready);
  EXPECT_FALSE(live.instant().late);
  EXPECT_EQ(live.instant().name, "000004");
  const auto newest = live.arrived();
  ASSERT_TRUE(newest);
  EXPECT_TRUE(same(newest->left, frame(2).left));
  EXPECT_FALSE(live.arrived());
  EXPECT_EQ(live.overtaken(), 2u);
}

TEST_F(FrameSources, ImagesWithoutAPoseAreNeitherShownNorUsed) {
  LiveSource live(cameras_.feed(), clock_, {.real_time = false});
  cameras_.bring(0, frame(0));
  cameras_.bring(1, std::nullopt);
  ASSERT_EQ(live.advance(), SourceState::ready);
  EXPECT_TRUE(live.arrived());
  EXPECT_EQ(live.advance(), SourceState::waiting);
  EXPECT_FALSE(live.arrived());
  EXPECT_THAT(live.fault(), testing::HasSubstr("NO POSE"));
  EXPECT_EQ(live.counts().unposed, 1u);
  cameras_.bring(2, frame(2));
  ASSERT_EQ(live.advance(), SourceState::ready);
  EXPECT_EQ(live.fault(), "");
}

// As before joints are homed: whoever waits for a view sees that the cameras work, and what is missing.
TEST_F(FrameSources, AnImageWithoutAPoseCanBeLookedAt) {
  LiveSource live(cameras_.feed(), clock_, {.real_time = false, .silent_after = 500ms});
  cameras_.bring_unposed(0, frame(0).left.pixels, "nobody is at home");
  EXPECT_EQ(live.advance(), SourceState::waiting);
  EXPECT_TRUE(same(live.unposed(), frame(0).left.pixels));
  EXPECT_EQ(live.fault(), "NO POSE for the newest image: nobody is at home");
  clock_.sleep_until(clock_.now() + 600ms);
  EXPECT_EQ(live.advance(), SourceState::waiting);
  EXPECT_TRUE(live.unposed().empty()) << "an old image";
  cameras_.bring(1, frame(1));
  ASSERT_EQ(live.advance(), SourceState::ready);
  EXPECT_TRUE(live.unposed().empty());
  EXPECT_EQ(live.fault(), "");
}

TEST_F(FrameSources, ASilentSourceSaysSo) {
  cameras_.trouble = "the left camera is lost";
  LiveSource live(cameras_.feed(), clock_, {.real_time = false, .silent_after = 500ms});
  cameras_.bring(0, frame(0));
  ASSERT_EQ(live.advance(), SourceState::ready);
  clock_.sleep_until(clock_.now() + 400ms);
  EXPECT_EQ(live.advance(), SourceState::waiting);
  EXPECT_EQ(live.fault(), "");
  clock_.sleep_until(clock_.now() + 900ms);
  EXPECT_EQ(live.fault(), "") << "nobody has looked: a picture takes long";
  EXPECT_EQ(live.advance(), SourceState::waiting);
  EXPECT_EQ(live.fault(), "NO IMAGE for 1.3 s: the left camera is lost");
  cameras_.bring(1, frame(1));
  ASSERT_EQ(live.advance(), SourceState::ready);
  EXPECT_EQ(live.fault(), "") << "it is back";
}

TEST_F(FrameSources, ADelayLongerThanThereIsRoomForIsCounted) {
  LiveSource live(cameras_.feed(), clock_, {.delay = 1h, .real_time = false, .most_frames = 2});
  for (std::size_t i = 0; i < 5; ++i) {
    cameras_.bring(i, frame(i));
    ASSERT_EQ(live.advance(), SourceState::ready);
    EXPECT_TRUE(live.instant().blind);
  }
  EXPECT_EQ(live.counts().forgotten, 3u);
}

}  // namespace
}  // namespace foresight::frame_sources_test
