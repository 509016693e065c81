// The scene in a head display: each eye sees what a camera in its place would.
#include "display/head/scene_painter.hpp"

#include "display/eye_pair.hpp"
#include "display/head/head_thread.hpp"
#include "display/head/view_share.hpp"
#include "gl/read_texture.hpp"
#include "tests/head_display/xr_test.hpp"
#include "tests/support/small_scene.hpp"

namespace foresight::scene_painter_test {
namespace {

using namespace std::chrono_literals;
using openxr_runtime::looking;
using openxr_runtime::runtime;
using openxr_runtime::World;

class SceneInAHead : public HeadDisplayTest {
 protected:
  void SetUp() override {
    HeadDisplayTest::SetUp();
    if (IsSkipped()) return;
    const Lens lens = small_lens("pinhole");
    ViewSetup setup{scene_, surface_for(*scene_, lens, {}), lens, std::nullopt, {}, {}};
    setup.textures.memory_bytes = 6 << 20;
    session_.emplace(*context_, setup);
    session_->process({posed_photograph(*scene_, state_of(*scene_), lens, usual_view()), std::nullopt});
    drawer_.emplace(*session_, real_);
    painter_in_scene_.emplace(*drawer_, *held_, real_, nullptr, &image_.emplace(32, 24, "image"));
    settings_.shown = [this](const openxr_runtime::ShownFrame& frame) {
      panels_ = frame.panels.size();
      for (std::size_t i = 0; i < 2; ++i)
        if (frame.eyes[i]) seen_[i] = gl::read_texture(frame.eyes[i]);
    };
    runtime().reset(settings_);
  }
  void TearDown() override {
    display_.reset();
    if (painter_in_scene_) painter_in_scene_->release();
    painter_in_scene_.reset();
    if (drawer_) drawer_->release();
    drawer_.reset();
    session_.reset();
    image_.reset();
    HeadDisplayTest::TearDown();
  }
  // Views are drawn between frames, by turns in one context, unless they are not to be.
  void turn(int rounds) {
    for (int i = 0; i < rounds; ++i) {
      display_->step(*painter_in_scene_);
      if (draws_) drawer_->draw();
    }
  }
  void begin() {
    painter_in_scene_->show({{usual_view(), state_of(*scene_)}, true});
    for (int i = 0; i < 20 && !display_->status().focused; ++i) turn(1);
    turn(2);
    ASSERT_TRUE(display_->status().focused) << display_->status().trouble;
  }
  // What the eye sees from there, first row at the bottom.
  cv::Mat expected(std::size_t eye, const Pose& T_world_eye) {
    const auto& f = settings_.fov;
    const head::EyeFov fov = eye == 0 ? head::EyeFov{f[0], f[1], f[2], f[3]} : head::EyeFov{-f[1], -f[0], f[2], f[3]};
    PredictedView view = session_->make_view(head::eye_lens(fov, 64, 64));
    session_->draw(view, T_world_eye * head::T_body_camera(), state_of(*scene_));
    cv::Mat out = gl::read_texture(view.picture());
    cv::flip(out, out, 0);
    return out;
  }
  void expect_same(std::size_t eye, const Pose& T_world_eye, double most = 2) {
    const cv::Mat wanted = expected(eye, T_world_eye);
    cv::Mat apart;
    cv::absdiff(wanted, seen_[eye], apart);
    // Between the pixels of a view that is wider: edges are as sharp as linear interpolation leaves them.
    EXPECT_LT(cv::mean(apart.reshape(1))[0], most) << "eye " << eye;
    cv::Mat mean, deviation;
    cv::meanStdDev(wanted.reshape(1), mean, deviation);
    EXPECT_GT(deviation.at<double>(0), 10) << "there is something to see";
  }

  MonotonicClock real_;
  std::shared_ptr<const SceneModel> scene_ = small_scene();
  std::optional<ViewSession> session_;
  std::optional<head::SceneDrawer> drawer_;
  bool draws_ = true;
  std::optional<head::SharedPicture> image_;
  std::optional<head::ScenePainter> painter_in_scene_;
  std::array<cv::Mat, 2> seen_;
  std::size_t panels_ = 0;
};

TEST_F(SceneInAHead, EachEyeSeesWhatACameraInItsPlaceWould) {
  const Pose T_head = *head::checked_pose({0.3, 1.1, 0.2}, Eigen::Quaterniond(1, 0, 0, 0));
  World world;
  world.head = looking({0.3f, 1.1f, 0.2f}, 0);
  settings_.world = [&world](double) { return world; };
  runtime().reset(settings_);
  begin();
  ASSERT_TRUE(painter_in_scene_->T_world_space());
  const Pose T_world_space = head::T_world_space_for(usual_view(), T_head);
  EXPECT_TRUE(painter_in_scene_->T_world_space()->isApprox(T_world_space, 1e-6));
  EXPECT_LT(((T_world_space * T_head).translation() - usual_view().translation()).norm(), 1e-9);
  const auto eye_at = [&](const Pose& T_space_head, std::size_t eye) {
    return T_world_space * T_space_head * Eigen::Translation3d(0, eye == 0 ? 0.0315 : -0.0315, 0);
  };
  // The head leans forward and looks down, to where the scene is.
  world.head = looking({0.35f, 1.05f, 0.1f}, 0.1, -0.5);
  turn(2);
  const auto& q = world.head.orientation;
  const Pose T_leaning =
      *head::checked_pose({0.35, 1.05, 0.1}, Eigen::Quaternionf(q[3], q[0], q[1], q[2]).cast<double>());
  for (std::size_t eye = 0; eye < 2; ++eye) expect_same(eye, eye_at(T_leaning, eye), 2.5);
  cv::Mat apart;
  cv::absdiff(seen_[0], seen_[1], apart);
  EXPECT_GT(cv::mean(apart.reshape(1))[0], 5) << "from two places";
  EXPECT_EQ(complaints(), "");
}

// The views are drawn now and then, and each frame is warped from them.
TEST_F(SceneInAHead, FramesAreWarpedFromViewsThatWereDrawnBefore) {
  head::SceneDrawer& drawer = *drawer_;
  draws_ = false;
  World world;
  settings_.world = [&world](double) { return world; };
  runtime().reset(settings_);
  EXPECT_FALSE(drawer.draw()) << "nobody has aimed";
  begin();
  EXPECT_EQ(seen_[0].at<cv::Vec4b>(10, 10), seen_[0].at<cv::Vec4b>(50, 50)) << "nothing is drawn yet";
  ASSERT_TRUE(drawer.draw());
  EXPECT_FALSE(drawer.draw()) << "once for an aim";
  const Pose T_world_space = *painter_in_scene_->T_world_space();
  for (const double turned : {0.0, 0.02, 0.05}) {  // rad
    world.head = looking({0.005f, 1, 0}, static_cast<float>(turned));
    turn(2);
    const auto& q = world.head.orientation;
    const Pose T_head = *head::checked_pose({0.005, 1, 0}, Eigen::Quaternionf(q[3], q[0], q[1], q[2]).cast<double>());
    for (std::size_t eye = 0; eye < 2; ++eye) {
      const Pose T_eye = T_world_space * T_head * Eigen::Translation3d(0, eye == 0 ? 0.0315 : -0.0315, 0);
      SCOPED_TRACE(turned);
      expect_same(eye, T_eye);
      EXPECT_GT(cv::norm(expected(eye, T_eye), seen_[eye], cv::NORM_INF), 0) << "not drawn anew";
    }
  }
  EXPECT_EQ(drawer.drawn(), 1u);
  EXPECT_EQ(complaints(), "");
}

TEST_F(SceneInAHead, ARightEyeIsMadeOfTheLeftOnesFrame) {
  head::SceneDrawer& drawer = *drawer_;
  head::EyeWarper warper(drawer, real_, head::SecondEyeFrom::first_eye);
  const head::EyeFov fov{-0.5, 0.5, 0.4, -0.4};
  const auto frame = [&](double apart, double turned) {
    std::array<const gl::Texture*, 2> out{};
    warper.begin(state_of(*scene_));
    for (std::size_t eye = 0; eye < 2; ++eye) {
      Pose T_eye = usual_view() * Eigen::Translation3d(eye == 0 ? 0 : apart, 0, 0);
      if (eye == 1) T_eye.linear() = T_eye.linear() * Eigen::AngleAxisd(turned, Eigen::Vector3d::UnitY());
      out[eye] = warper(eye, {T_eye, fov, 64, 52});
    }
    warper.end();
    return out;
  };
  EXPECT_FALSE(frame(0.065, 0)[0]);
  ASSERT_TRUE(drawer.draw());
  glFinish();
  const auto eyes = frame(0.065, 0);
  ASSERT_TRUE(eyes[0] && eyes[1]);
  EXPECT_EQ(warper.counts().of_first, 1u);
  PredictedView direct = session_->make_view(head::eye_lens(fov, 64, 52));
  session_->draw(direct, usual_view() * Eigen::Translation3d(0.065, 0, 0), state_of(*scene_));
  cv::Mat apart;
  cv::absdiff(gl::read_texture(direct.picture()), gl::read_texture(*eyes[1]), apart);
  EXPECT_LT(cv::mean(apart.reshape(1))[0], 4);
  // An eye that looks elsewhere has no such rows: it gets a view of its own.
  frame(0.065, 0.1);
  EXPECT_EQ(warper.counts().torn, 1u);
  ASSERT_TRUE(drawer.draw());
  glFinish();
  EXPECT_TRUE(frame(0.065, 0.1)[1]);
  EXPECT_EQ(warper.counts().of_first, 1u);
}

// Views that another process has drawn are warped as those of a thread: here both sides are in one.
TEST_F(SceneInAHead, ViewsGoOverToAnotherProcess) {
  head::ViewShare share({120 * 120, scene_->nodes().size()});
  head::SharedViews views(share, *scene_);
  head::EyeWarper there(views, real_), here(*drawer_, real_);
  const head::EyeFov fov{-0.5, 0.5, 0.4, -0.4};
  const auto frame = [&](head::EyeWarper& warper, const Pose& T_world_head) {
    std::array<cv::Mat, 2> out;
    warper.begin(state_of(*scene_, 0.01));
    for (std::size_t eye = 0; eye < 2; ++eye)
      if (const auto* const picture = warper(eye, {T_world_head * Eigen::Translation3d(0.06 * eye, 0, 0), fov, 64, 52}))
        out[eye] = gl::read_texture(*picture);
    warper.end();
    return out;
  };
  EXPECT_TRUE(frame(there, usual_view())[0].empty());
  auto aim = share.take_aim();
  ASSERT_TRUE(aim);
  EXPECT_FALSE(share.take_aim()) << "once";
  EXPECT_TRUE(aim->eyes[1].T_world_eye.isApprox(usual_view() * Eigen::Translation3d(0.06, 0, 0)));
  EXPECT_EQ(aim->eyes[1].width, 64);
  EXPECT_EQ(aim->state.T_world_node.size(), scene_->nodes().size());
  drawer_->aim(*aim);
  ASSERT_TRUE(drawer_->draw());
  glFinish();
  ASSERT_TRUE(share.put(*drawer_->newest()));
  EXPECT_EQ(share.drawn(), 1u);
  const Pose moved = usual_view() * Eigen::Translation3d(0.02, 0, 0);
  const auto over_there = frame(there, moved), over_here = frame(here, moved);
  for (std::size_t eye = 0; eye < 2; ++eye) {
    ASSERT_FALSE(over_there[eye].empty());
    EXPECT_EQ(cv::norm(over_there[eye], over_here[eye], cv::NORM_INF), 0) << eye;
  }
  EXPECT_FALSE(share.ended());
  share.end();
  EXPECT_TRUE(share.ended());
  // What does not fit is not told, nor what would be misunderstood.
  head::ViewShare small({10, scene_->nodes().size()});
  EXPECT_FALSE(small.put(*drawer_->newest()));
  aim->state.T_world_node.pop_back();
  EXPECT_THROW(share.aim(*aim), std::invalid_argument);
}

// A panel behind a strong lens, with nobody who does away with its distortion: the same pass does.
TEST_F(SceneInAHead, FramesAreMadeForAPanelBehindALens) {
  head::EyeWarper warper(*drawer_, real_);
  const auto panel = std::make_shared<const Lens>(small_lens("plumb_bob"));
  const head::EyeFov fov = head::fov_of(*panel);
  const auto frame = [&](const Pose& T_world_eye) {
    warper.begin(state_of(*scene_));
    const gl::Texture* out = nullptr;
    for (std::size_t eye = 0; eye < 2; ++eye)
      out = warper(eye, {T_world_eye, fov, panel->width(), panel->height(), panel});
    warper.end();
    return out;
  };
  EXPECT_FALSE(frame(usual_view()));
  ASSERT_TRUE(drawer_->draw());
  glFinish();
  const Pose moved = usual_view() * Eigen::Translation3d(0.01, 0, 0);
  const gl::Texture* const shown = frame(moved);
  ASSERT_TRUE(shown);
  PredictedView direct = session_->make_view(*panel);
  session_->draw(direct, moved, state_of(*scene_));
  cv::Mat apart;
  cv::absdiff(gl::read_texture(direct.picture()), gl::read_texture(*shown), apart);
  EXPECT_LT(cv::mean(apart.reshape(1))[0], 3);
}

TEST_F(SceneInAHead, CentredAnewTheHeadIsWhereTheCameraIs) {
  World world;
  settings_.world = [&world](double) { return world; };
  runtime().reset(settings_);
  begin();
  world.head = looking({0.5f, 1, 0}, 0.7);
  turn(2);
  const Pose before = *painter_in_scene_->T_world_space();
  world.hands[0].stick_pressed = true;
  turn(2);
  const Pose after = *painter_in_scene_->T_world_space();
  EXPECT_FALSE(after.isApprox(before, 1e-3));
  const auto& q = world.head.orientation;
  const Pose T_head = *head::checked_pose({0.5, 1, 0}, Eigen::Quaternionf(q[3], q[0], q[1], q[2]).cast<double>());
  EXPECT_LT(((after * T_head).translation() - usual_view().translation()).norm(), 1e-6);
  world.head = looking({0.1f, 1, 0}, 0.2);
  turn(3);
  EXPECT_TRUE(painter_in_scene_->T_world_space()->isApprox(after)) << "once for a press";
  runtime().recentre(looking({0.2f, 0, 0}, 0.1));
  turn(8);
  EXPECT_FALSE(painter_in_scene_->T_world_space()->isApprox(after, 1e-3)) << "the runtime's own way of centring";
  EXPECT_EQ(complaints(), "");
}

TEST_F(SceneInAHead, WhatCannotBeTrustedIsNotShown) {
  image_->write([](const ViewTarget& target) { fill(target, 0, 0, 1); });
  begin();
  turn(2);
  const double before = cv::mean(seen_[0])[0];
  painter_in_scene_->show({{usual_view(), state_of(*scene_)}, false});
  turn(2);
  EXPECT_EQ(panels_, 1u) << "the newest image stands in its place";
  EXPECT_NE(cv::mean(seen_[0])[0], before);
  EXPECT_EQ(seen_[0].at<cv::Vec4b>(10, 10), seen_[0].at<cv::Vec4b>(50, 50)) << "one colour";
  EXPECT_EQ(complaints(), "");
}

// They say why the image stands there.
TEST_F(SceneInAHead, WordsAreOverTheImageThatStandsInForTheScene) {
  head::SharedPicture words(16, 8, "words");
  head::ScenePainter painter(*drawer_, *held_, real_, &words, &*image_);
  painter.show({{usual_view(), state_of(*scene_)}, false});
  head::HeadFrame frame;
  frame.T_space_head = Pose::Identity();
  painter.look(frame);
  const auto panels = painter.panels();
  ASSERT_EQ(panels.size(), 2u);
  EXPECT_TRUE(panels[1].shown && panels[1].head_fixed) << "what comes last is over what came before";
  EXPECT_TRUE(panels[0].shown && !panels[0].head_fixed);
  EXPECT_LT(panels[1].T_frame_panel.translation().norm(), panels[0].T_frame_panel.translation().norm())
      << "and is no farther away";
  painter.release();
}

TEST_F(SceneInAHead, BeforeTheFirstStateNothingIsDrawnOfIt) {
  turn(20);
  EXPECT_TRUE(display_->status().focused);
  EXPECT_FALSE(painter_in_scene_->T_world_space());
  EXPECT_EQ(seen_[0].at<cv::Vec4b>(10, 10), seen_[0].at<cv::Vec4b>(50, 50));
}

TEST_F(SceneInAHead, APictureOfAnotherContextIsShownWhole) {
  head::SharedPicture picture(16, 8, "shared");
  const auto reader = context_->create_shared();
  const auto shown = [&] {
    reader->make_current();
    gl::Texture texture(GL_RGBA8, 16, 8, 0, 1, "target");
    cv::Mat out;
    {
      const PictureCopy copy;
      const TextureTarget target(texture.name(), 16, 8);
      glFinish();
      if (picture.show(copy, target.whole())) out = gl::read_texture(texture);
    }
    context_->make_current();
    return out;
  };
  EXPECT_FALSE(picture.fresh());
  EXPECT_TRUE(shown().empty());
  for (int i = 1; i <= 10; ++i) {
    picture.write([&](const ViewTarget& target) { fill(target, static_cast<float>(i) / 255, 0, 0); });
    glFinish();
    if (i % 3 == 0) continue;  // some are overtaken
    EXPECT_TRUE(picture.fresh());
    const cv::Mat out = shown();
    ASSERT_FALSE(out.empty());
    EXPECT_EQ(out.at<cv::Vec4b>(4, 8)[0], i);
    EXPECT_FALSE(picture.fresh());
  }
}

TEST_F(SceneInAHead, SideBySideEyesAreApart) {
  const std::array lenses{small_lens("pinhole"), small_lens("pinhole")};
  EyePair none(*session_, lenses, 0), eyes(*session_, lenses, 0.065);
  ASSERT_TRUE(none.draw(usual_view(), state_of(*scene_)));
  ASSERT_TRUE(eyes.draw(usual_view(), state_of(*scene_)));
  const auto read = [](const gl::Texture& picture) { return gl::read_texture(picture); };
  EXPECT_EQ(cv::norm(read(none.picture(0)), read(none.picture(1)), cv::NORM_INF), 0);
  EXPECT_GT(cv::norm(read(eyes.picture(0)), read(eyes.picture(1)), cv::NORM_INF), 0);
  ASSERT_TRUE(session_->draw(usual_view() * Eigen::Translation3d(-0.0325, 0, 0), state_of(*scene_)));
  EXPECT_EQ(cv::norm(read(session_->picture()), read(eyes.picture(0)), cv::NORM_INF), 0) << "the left one is left";
}

// In a thread of its own: a runtime that stands still holds up nobody, and is not waited for for ever.
TEST_F(SceneInAHead, AThreadEndsOrSaysThatItCannot) {
  settings_.tick = {};
  settings_.shown = {};
  settings_.real_time = true;
  runtime().reset(settings_);
  MonotonicClock clock;
  painter_in_scene_->show({{usual_view(), state_of(*scene_)}, true});
  std::atomic<bool> released{false};
  head::HeadThread thread(context_->create_shared(), {}, clock, held_, *painter_in_scene_, [&] {
    painter_in_scene_->release();
    released = true;
  });
  for (int i = 0; i < 1000 && thread.status().frames < 5; ++i) clock.sleep_until(clock.now() + 10ms);
  ASSERT_GE(thread.status().frames, 5u) << thread.status().trouble;
  runtime().stop_frames(1.0);
  for (int i = 0; i < 100 && !head::stands_still(thread.status(), {clock.now().ns}, 200ms); ++i)
    clock.sleep_until(clock.now() + 10ms);
  EXPECT_TRUE(head::stands_still(thread.status(), {clock.now().ns}, 200ms));
  EXPECT_FALSE(thread.stop(1ms));
  EXPECT_TRUE(thread.stop(20s));
  EXPECT_TRUE(released);
  EXPECT_TRUE(thread.status().ended);
  EXPECT_EQ(complaints(), "");
}

}  // namespace
}  // namespace foresight::scene_painter_test
