// From frames to a drawn view: what is shown is drawn from what has arrived, the same on every run.
#include "display/view_session.hpp"

#include <atomic>
#include <deque>

#include "display/live_source.hpp"
#include "display/view_loop.hpp"
#include "tests/support/headless_test.hpp"
#include "tests/support/small_scene.hpp"

namespace foresight::view_session_test {
namespace {

using namespace std::chrono_literals;

constexpr Duration kInterval = 100ms;

/// A camera that moves round the scene, whose block moves.
PosedFrame moving_frame(const SceneModel& scene, int i) {
  const double t = 0.1 * i;
  PosedImage image = posed_photograph(scene, state_of(scene, 0.05 * t), small_lens("pinhole"),
                                      look_at({-0.9 + 0.1 * t, -0.9 - 0.1 * t, 0.7}, {0, 0, 0.1}));
  image.time = RobotTime{} + 1s + i * kInterval;
  return {image, std::nullopt};
}

/// Keeps what was shown.
class Witness final : public ViewObserver {
 public:
  void arrived(const PosedFrame& frame) override { frames.push_back(frame.left.time); }
  void stepped(const ViewStep& step, FrameSource& /*source*/, ViewSession& session) override {
    steps.push_back(step);
    if (!step.drawn) return;
    newest.push_back(session.textures()->newest_image);
    pictures.push_back(session.read());
  }
  void waiting(FrameSource& /*source*/, ViewSession& /*session*/) override { ++waits; }
  bool wants_more() const override { return steps.size() < enough; }

  std::vector<RobotTime> frames, newest;
  std::vector<ViewStep> steps;
  std::vector<cv::Mat> pictures;
  int waits = 0;
  std::size_t enough = 1000;
};

class ViewSessionTest : public HeadlessTest {
 protected:
  ViewSetup small_setup() const {
    ViewSetup setup{scene_, surface_for(*scene_, small_lens("pinhole"), {}), small_lens("pinhole"), std::nullopt, {},
                    {}};
    setup.textures.memory_bytes = 6 << 20;
    return setup;
  }
  std::unique_ptr<ViewSession> make_session(bool newest_image = true) {
    ViewSetup setup = small_setup();
    setup.newest_image = newest_image;
    return std::make_unique<ViewSession>(*context_, setup);
  }
  LiveFeed feed(int images) {
    images_.clear();
    for (int i = 0; i < images; ++i) images_.push_back({static_cast<std::uint64_t>(i), moving_frame(*scene_, i)});
    return {[this](Duration) -> std::optional<LiveImage> {
              if (images_.empty()) return std::nullopt;
              LiveImage image = std::move(images_.front());
              images_.pop_front();
              return image;
            },
            [this] { return images_.empty(); },
            {}};
  }
  Witness show(int images, Duration delay, std::size_t enough = 1000) {
    const auto session = make_session();
    LiveSource source(feed(images), clock_, {.delay = delay, .real_time = false});
    Witness witness;
    witness.enough = enough;
    ViewLoop(*session, source, {&witness}, [] { return false; }).run();
    return witness;
  }

  std::shared_ptr<const SceneModel> scene_ = small_scene();
  std::deque<LiveImage> images_;
  SteppedClock clock_;
};

TEST_F(ViewSessionTest, TexturesAreAsOldAsTheDelay) {
  const Witness seen = show(6, 2 * kInterval);
  ASSERT_EQ(seen.steps.size(), 6u);
  EXPECT_EQ(seen.frames.size(), 4u);
  ASSERT_EQ(seen.newest.size(), 4u);
  for (std::size_t i = 0; i < 6; ++i) EXPECT_EQ(seen.steps[i].instant.blind, i < 2);
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_EQ(seen.newest[i], seen.steps[i + 2].instant.time - 2 * kInterval);
    EXPECT_EQ(seen.steps[i + 2].reports.size(), 1u);
  }
}

TEST_F(ViewSessionTest, RepeatsBitForBit) {
  const Witness first = show(4, kInterval), second = show(4, kInterval);
  ASSERT_EQ(first.pictures.size(), 3u);
  ASSERT_EQ(second.pictures.size(), 3u);
  for (std::size_t i = 0; i < 3; ++i) EXPECT_EQ(cv::norm(first.pictures[i], second.pictures[i], cv::NORM_INF), 0);
  EXPECT_GT(cv::norm(first.pictures[0], first.pictures[2], cv::NORM_INF), 0) << "and the scene moves";
}

TEST_F(ViewSessionTest, EndsWhenSomebodyWantsNoMore) {
  EXPECT_EQ(show(4, 0ms, 2).steps.size(), 2u);
}

// Whoever draws and then waits must not keep old textures from the core.
TEST_F(ViewSessionTest, DrawingWithoutReadingHoldsNothingUp) {
  const auto session = make_session();
  const SceneState state = state_of(*scene_);
  EXPECT_FALSE(session->draw(usual_view(), state)) << "nothing was published";
  for (int i = 0; i < 8; ++i) {
    const ExtractionReport report = session->process(moving_frame(*scene_, i));
    EXPECT_TRUE(report.published);
    for (int eye = 0; eye < 4; ++eye) EXPECT_TRUE(session->draw(usual_view(), state));
  }
}

// The frame is in the view before its textures are made.
TEST_F(ViewSessionTest, ShowsAFrameBeforeItsTextures) {
  const auto session = make_session();
  const PosedFrame first = moving_frame(*scene_, 0), second = moving_frame(*scene_, 5);
  session->show(first);
  EXPECT_EQ(session->textures()->newest_image, first.left.time) << "beside nothing else it cannot be shown";
  EXPECT_TRUE(session->follow());
  session->show(second);
  EXPECT_EQ(session->textures()->newest_image, first.left.time);
  ASSERT_TRUE(session->draw(second.left.T_world_camera, second.left.scene));
  const cv::Mat picture = session->read();
  int seen = 0;
  double sum = 0;
  for (int y = 0; y < picture.rows; ++y)
    for (int x = 0; x < picture.cols; ++x) {
      const cv::Vec4b got = picture.at<cv::Vec4b>(y, x);
      const cv::Vec3b true_colour = second.left.pixels.at<cv::Vec3b>(y, x);
      seen += got[3] == 255;
      for (int c = 0; c < 3 && got[3] == 255; ++c) sum += std::abs(got[c] - true_colour[c]) / 3.0;
    }
  EXPECT_GT(seen, 8000);
  EXPECT_LT(sum / seen, 0.7) << "no filter lies between, at the same place";
  const auto report = session->follow();
  ASSERT_TRUE(report);
  EXPECT_EQ(report->newest_image, second.left.time);
  EXPECT_EQ(session->textures()->newest_image, second.left.time);
  EXPECT_FALSE(session->follow()) << "there is nothing left";
}

TEST_F(ViewSessionTest, ShowsTexturesAloneWhereAsked) {
  const auto session = make_session(false);
  session->show(moving_frame(*scene_, 0));
  session->show(moving_frame(*scene_, 5));
  EXPECT_EQ(session->textures()->newest_image, moving_frame(*scene_, 5).left.time);
  EXPECT_TRUE(session->follow());
}

// Each through its own lens, from its own place, with one set of textures.
TEST_F(ViewSessionTest, HasAViewForEachEye) {
  const auto session = make_session();
  session->process(moving_frame(*scene_, 0));
  PredictedView left = session->make_view(small_lens("pinhole")), right = session->make_view(small_lens("fisheye"));
  const Pose T_world_left = moving_frame(*scene_, 0).left.T_world_camera;
  const Pose T_world_right = T_world_left * Eigen::Translation3d(0.06, 0, 0);
  ASSERT_TRUE(session->draw(left, T_world_left, state_of(*scene_)));
  ASSERT_TRUE(session->draw(right, T_world_right, state_of(*scene_)));
  ASSERT_TRUE(session->draw(T_world_left, state_of(*scene_)));
  EXPECT_EQ(cv::norm(left.read(), session->read(), cv::NORM_INF), 0) << "the same lens and place";
  const gl::Texture display(GL_RGBA8, 320, 120, 0, 1, "a head display");
  const TextureTarget target(display.name(), 320, 120);
  const PictureCopy copy;
  copy(left.picture(), column(target.whole(), 0, 2, 0));
  copy(right.picture(), column(target.whole(), 1, 2, 0));
  cv::Mat both(120, 320, CV_8UC4);
  glGetTextureImage(display.name(), 0, GL_BGRA, GL_UNSIGNED_BYTE, static_cast<GLsizei>(both.total() * 4), both.data);
  EXPECT_EQ(cv::norm(both.colRange(0, 160), left.read(), cv::NORM_INF), 0);
  EXPECT_EQ(cv::norm(both.colRange(160, 320), right.read(), cv::NORM_INF), 0);
}

/// Programs that are linked while it lives, by all threads.
class LinkCount {
 public:
  LinkCount() {
    g_link = epoxy_glLinkProgram;
    g_links = 0;
    epoxy_glLinkProgram = [](GLuint program) {
      ++g_links;
      g_link(program);
    };
  }
  ~LinkCount() { epoxy_glLinkProgram = g_link; }
  LinkCount(const LinkCount&) = delete;
  static int count() { return g_links; }

 private:
  inline static PFNGLLINKPROGRAMPROC g_link = nullptr;
  inline static std::atomic<int> g_links = 0;
};

/// Views of some frames, how far they can be trusted, and how many programs that took.
struct Shown {
  std::vector<cv::Mat> pictures;
  int programs = 0;
};

Shown show_some(ViewSession& session, const SceneModel& scene) {
  const LinkCount links;
  Shown out;
  TrustPass trust = session.make_trust_pass();
  for (int i = 0; i < 4; ++i) {
    const PosedFrame frame = moving_frame(scene, i);
    trust.saw(frame.left);
    session.show(frame);
    const SceneState later = state_of(scene, 0.02 * i + 0.03);
    if (session.draw(frame.left.T_world_camera, later)) {
      trust(session.view(), frame.left.T_world_camera, later, std::vector<double>(later.T_world_node.size(), 0.0), {});
      out.pictures.push_back(session.read());
    }
    session.follow();
  }
  out.programs = links.count();
  return out;
}

// All that is done with images has been done once, and nothing of it is left but the programs.
TEST_F(ViewSessionTest, ARehearsalLeavesProgramsAndNothingElse) {
  const auto unprepared = make_session();
  ViewSetup setup = small_setup();
  setup.rehearses = true;
  std::size_t asked = 0;
  setup.goes_on = [&](std::size_t seen, std::size_t of) {
    EXPECT_EQ(seen, asked++);
    EXPECT_GT(of, seen);
    return true;
  };
  ViewSession rehearsed(*context_, setup);
  EXPECT_GT(asked, 2u);
  EXPECT_FALSE(rehearsed.textures());
  EXPECT_FALSE(rehearsed.images());
  EXPECT_FALSE(rehearsed.draw(usual_view(), state_of(*scene_))) << "nothing was published";
  const Shown first = show_some(*unprepared, *scene_), second = show_some(rehearsed, *scene_);
  EXPECT_GT(first.programs, 2) << "views make some when they need them";
  EXPECT_EQ(second.programs, 0);
  ASSERT_EQ(first.pictures.size(), 4u);
  ASSERT_EQ(second.pictures.size(), 4u);
  for (std::size_t i = 0; i < 4; ++i)
    EXPECT_EQ(cv::norm(first.pictures[i], second.pictures[i], cv::NORM_INF), 0) << "picture " << i;
}

TEST_F(ViewSessionTest, ARehearsalEndsWhenItIsAskedTo) {
  ViewSetup setup = small_setup();
  setup.rehearses = true;
  int asked = 0;
  setup.goes_on = [&](std::size_t, std::size_t) { return ++asked < 2; };
  ViewSession session(*context_, setup);
  EXPECT_EQ(asked, 2);
  EXPECT_TRUE(session.process(moving_frame(*scene_, 0)).published);
}

}  // namespace
}  // namespace foresight::view_session_test
