// What keys and mouse make of the operator's window, and that they never reach the robot by it.
#include "seat/seat_views.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <span>

#include "display/doubt_kinds.hpp"
#include "display/view_session.hpp"
#include "seat/shown_fidelity.hpp"
#include "tests/support/headless_test.hpp"
#include "tests/support/small_scene.hpp"

namespace foresight::seat_views_test {
namespace {

constexpr ViewTarget kWindow{.width = 800, .height = 600};

gl::WindowInput mouse(double x, bool left, bool pressed = false, double moved = 0) {
  gl::WindowInput out;
  out.x = x;
  out.left = left;
  out.pressed = pressed;
  out.moved_x = moved;
  return out;
}

class SeatViewsTest : public HeadlessTest {
 protected:
  void SetUp() override {
    HeadlessTest::SetUp();
    if (context_) views_.emplace(SeatViewsSetup{.left = small_lens("pinhole")});
  }
  /// Is the left button, as the hand gets it, held?
  bool hand_gets(gl::WindowInput input) {
    views_->take_mouse(input, kWindow);
    if (!input.left) {
      EXPECT_EQ(input.moved_x, 0);
    }
    return input.left;
  }
  void TearDown() override {
    views_.reset();
    HeadlessTest::TearDown();
  }
  std::optional<SeatViews> views_;
};

TEST_F(SeatViewsTest, KeysGoRound) {
  std::vector<ViewMode> seen;
  for (int i = 0; i < 4; ++i) views_->next_main(), seen.push_back(views_->mode());
  EXPECT_THAT(seen, testing::ElementsAre(ViewMode::newest, ViewMode::both, ViewMode::split, ViewMode::predicted));
  seen.clear();
  for (int i = 0; i < 5; ++i) views_->next_stereo(), seen.push_back(views_->mode());
  EXPECT_THAT(seen, testing::ElementsAre(ViewMode::two_eyes, ViewMode::interlaced, ViewMode::anaglyph,
                                         ViewMode::anaglyph_colours, ViewMode::predicted));
  views_->toggle_observer();
  views_->next_main();
  EXPECT_EQ(views_->mode(), ViewMode::predicted) << "Tab leads back from everywhere";
  std::vector<std::string> words;
  for (int i = 0; i < kViewPaints; ++i) words.push_back(views_->words(true)), views_->next_paint();
  EXPECT_EQ(views_->paint(), ViewPaint::colours);
  EXPECT_THAT(words, testing::Contains(testing::HasSubstr("never seen")));
}

TEST_F(SeatViewsTest, TheHandHasTheMouseUnlessAViewTakesIt) {
  EXPECT_TRUE(hand_gets(mouse(400, true, true)));
  EXPECT_TRUE(hand_gets(mouse(450, true, false, 50)));
  views_->set_mode(ViewMode::split);
  EXPECT_FALSE(hand_gets(mouse(402, true, true))) << "the border is pressed";
  EXPECT_FALSE(hand_gets(mouse(500, true, false, 98)));
  EXPECT_FALSE(hand_gets(mouse(500, false)));
  EXPECT_TRUE(hand_gets(mouse(100, true, true))) << "elsewhere, it is the hand's";
}

// A button that was pressed for a view does not become the switch when the view changes.
TEST_F(SeatViewsTest, AButtonIsLetGoOfFirst) {
  for (const ViewMode mode : {ViewMode::observer, ViewMode::split}) {
    views_->set_mode(mode);
    const double border = 400;
    EXPECT_FALSE(hand_gets(mouse(border, true, true)));
    views_->set_mode(ViewMode::predicted);
    EXPECT_FALSE(hand_gets(mouse(border, true, false, 10)));
    EXPECT_FALSE(hand_gets(mouse(border, true, false, 10)));
    EXPECT_FALSE(hand_gets(mouse(border, false)));
    EXPECT_TRUE(hand_gets(mouse(border, true, true)));
    EXPECT_FALSE(hand_gets(mouse(border, false)));
  }
  EXPECT_TRUE(hand_gets(mouse(300, true, true)));
  views_->toggle_observer();
  EXPECT_FALSE(hand_gets(mouse(300, true, false, 10))) << "a held switch is let go of, too";
}

/// The small scene, seen by a session; the newest images are plain colours, to be told apart.
class SeatViewsPictures : public HeadlessTest {
 protected:
  static constexpr int kWidth = 320, kHeight = 240;
  void SetUp() override {
    HeadlessTest::SetUp();
    if (!context_) return;
    ViewSetup setup{scene_, surface_for(*scene_, lens_, {}), lens_, std::nullopt, {}, {}};
    setup.textures.memory_bytes = 6 << 20;
    session_.emplace(*context_, setup);
    window_ = gl::Texture(GL_RGBA8, kWidth, kHeight, 0, 1, "window");
    target_.emplace(window_.name(), kWidth, kHeight, -1, false);
    views_.emplace(SeatViewsSetup{.left = lens_, .eyes_apart = 0.1});
    PosedFrame frame{posed_photograph(*scene_, place_.scene, lens_, place_.T_world_camera), std::nullopt};
    frame.left.time = RobotTime{} + std::chrono::seconds(1);
    session_->process(frame);
    frame.left.pixels.setTo(cv::Scalar(255, 0, 255));
    views_->arrived(frame);
    views_->upload_newest(cv::Mat(120, 160, CV_8UC3, cv::Scalar(255, 0, 255)),
                          cv::Mat(120, 160, CV_8UC3, cv::Scalar(0, 255, 0)));
    hand_.lines.line({-0.3, 0, 0.3}, {0.3, 0, 0.3}, {.colour = {1, 1, 0}, .width_px = 6});
    hand_.labels.push_back({{0, 0, 0.3}, "here"});
  }
  void TearDown() override {
    views_.reset();
    target_.reset();
    session_.reset();
    window_ = {};
    doubt_ = {};
    HeadlessTest::TearDown();
  }

  /// The window in that mode, BGR, on a white ground; parts_ are told.
  cv::Mat shown(ViewMode mode, bool trusted = true, double drawing_ms = 0) {
    views_->set_mode(mode);
    session_->draw(place_.T_world_camera, place_.scene);
    views_->draw(*session_, place_, target_->whole(), drawing_ms);
    fill(target_->whole(), 1, 1, 1);
    parts_ = views_->show(*session_, target_->whole(),
                          {.trusted = trusted, .doubt = doubt_ ? &doubt_ : nullptr, .risks = &risks_, .hand = &hand_});
    cv::Mat out = read_window();
    if (const char* folder = std::getenv("FORESIGHT_PICTURES"))
      cv::imwrite(std::string(folder) + "/" + to_string(mode) + (trusted ? "" : "_untrusted") + ".png", out);
    return out;
  }
  cv::Mat read_window() const {
    cv::Mat out(kHeight, kWidth, CV_8UC4);
    glGetTextureImage(window_.name(), 0, GL_BGRA, GL_UNSIGNED_BYTE, static_cast<GLsizei>(out.total() * 4), out.data);
    cv::flip(out, out, 0);
    cv::cvtColor(out, out, cv::COLOR_BGRA2BGR);
    return out;
  }
  static std::string to_string(ViewMode mode) { return "mode_" + std::to_string(static_cast<int>(mode)); }
  static double share(const cv::Mat& picture, const cv::Scalar& colour) {
    cv::Mat in;
    cv::inRange(picture, colour - cv::Scalar::all(12), colour + cv::Scalar::all(12), in);
    return cv::countNonZero(in) / static_cast<double>(in.total());
  }
  static double late(const cv::Mat& picture) { return share(picture, {255, 0, 255}); }  // the left newest image
  static double late_right(const cv::Mat& picture) { return share(picture, {0, 255, 0}); }
  static double line(const cv::Mat& picture) { return share(picture, {0, 255, 255}); }

  Lens lens_ = small_lens("pinhole");
  std::shared_ptr<const SceneModel> scene_ = small_scene();
  ViewPlace place_{usual_view(), state_of(*scene_)};
  HandPicture hand_;
  gl::Texture window_, doubt_;
  KindRisks risks_{};
  std::optional<TextureTarget> target_;
  std::optional<ViewSession> session_;
  std::optional<SeatViews> views_;
  std::vector<SeatViews::Part> parts_;
};

const cv::Rect kLeft(2, 60, 150, 120), kRight(170, 60, 150, 120);

TEST_F(SeatViewsPictures, OneEyeSeesPredictionAndImageWhereTheModeSaysSo) {
  cv::Mat picture = shown(ViewMode::predicted);
  EXPECT_NEAR(late(picture), 1.0 / 16, 0.01) << "in its corner";
  EXPECT_GT(line(picture), 0.005);
  EXPECT_EQ(parts_.at(0).labels.size(), 1u);
  picture = shown(ViewMode::newest);
  EXPECT_GT(late(picture), 0.9);
  EXPECT_EQ(line(picture), 0) << "an image is shown as it is";
  picture = shown(ViewMode::both);
  EXPECT_GT(late(picture(kLeft)), 0.85);
  EXPECT_EQ(late(picture(kRight)), 0);
  EXPECT_GT(line(picture(kRight)), 0.003);
  ASSERT_TRUE(parts_.at(0).compared);
  const auto [top, bottom] = *parts_.at(0).compared;
  EXPECT_EQ(late(picture(cv::Rect(80, static_cast<int>(top), 1, static_cast<int>(bottom - top)))), 1);
  EXPECT_EQ(late(picture.rowRange(0, static_cast<int>(top))), 0);
  EXPECT_EQ(late(picture.rowRange(static_cast<int>(bottom), kHeight)), 0);
  picture = shown(ViewMode::split);
  EXPECT_FALSE(parts_.at(0).compared);
  EXPECT_GT(late(picture(kLeft)), 0.95);
  EXPECT_EQ(line(picture(kLeft)), 0);
  EXPECT_EQ(late(picture(kRight)), 0);
  EXPECT_GT(line(picture(kRight)), 0.003);
}

// Where drawing takes too long: the same picture, of fewer pixels, for one eye and for two.
TEST_F(SeatViewsPictures, SlowRenderersDrawFewerPixels) {
  for (const ViewMode mode : {ViewMode::predicted, ViewMode::two_eyes}) {
    views_.emplace(SeatViewsSetup{.left = lens_, .eyes_apart = 0.1, .few_pixels = 0});
    session_->set_lens(lens_);
    const cv::Mat whole = shown(mode);
    EXPECT_EQ(session_->view().lens().width(), lens_.width());
    EXPECT_EQ(views_->scale(), 1);
    cv::Mat small;
    for (int i = 0; i < 30; ++i) {
      small = shown(mode, true, 40);  // twice of what is allowed
      EXPECT_LT(cv::norm(whole, small, cv::NORM_L1) / (3.0 * static_cast<double>(whole.total())), 6)
          << i << ": none is empty because the next one is smaller";
      EXPECT_GT(line(small), 0.003);
    }
    EXPECT_NEAR(views_->scale(), std::sqrt(0.5), 0.01);
    EXPECT_NEAR(session_->view().lens().width(), 160 * views_->scale(), 1);
    EXPECT_GT(cv::norm(whole, small, cv::NORM_L1), 0);
    ASSERT_EQ(parts_.at(0).labels.size(), 1u);
  }
}

TEST_F(SeatViewsPictures, TheBorderGoesWhereItIsDragged) {
  shown(ViewMode::split);
  gl::WindowInput press = mouse(160, true, true), drag = mouse(80, true);
  views_->take_mouse(press, target_->whole());
  views_->take_mouse(drag, target_->whole());
  const cv::Mat picture = shown(ViewMode::split);
  EXPECT_GT(late(picture.colRange(0, 76)), 0.95);
  EXPECT_EQ(late(picture.colRange(84, kWidth)), 0);
}

TEST_F(SeatViewsPictures, EachEyeSeesItsOwn) {
  const cv::Mat eyes = shown(ViewMode::two_eyes);
  EXPECT_EQ(parts_.size(), 2u) << "each eye has the words";
  const cv::Rect left(0, 60, 160, 120), right(160, 60, 160, 120), middle(40, 30, 60, 60);
  EXPECT_GT(cv::norm(eyes(left)(middle), eyes(right)(middle), cv::NORM_L1) / middle.area(), 3);
  views_->swap_eyes();
  const cv::Mat swapped = shown(ViewMode::two_eyes);
  EXPECT_EQ(cv::norm(eyes(left), swapped(right), cv::NORM_L1), 0);
  EXPECT_EQ(cv::norm(eyes(right), swapped(left), cv::NORM_L1), 0);
  views_->swap_eyes();
  for (const ViewMode mode : {ViewMode::interlaced, ViewMode::anaglyph, ViewMode::anaglyph_colours}) {
    const cv::Mat mixed = shown(mode);
    EXPECT_EQ(parts_.size(), 1u);
    EXPECT_LT(late(mixed), 0.08) << "the image is in its corner only";
    EXPECT_EQ(parts_[0].labels.size(), 1u);
  }
  // Every other row of the interlaced picture is an eye's own.
  const cv::Mat rows = shown(ViewMode::interlaced, false);
  for (int y = 20; y < kHeight - 20; ++y) {
    EXPECT_GT(late(rows.row(y)) + late_right(rows.row(y)), 0.9) << "the newest pair, an image for each eye";
    EXPECT_NE(late(rows.row(y)) > 0.5, late(rows.row(y + 1)) > 0.5) << y;
  }
}

// Words lie in the screen: what is as far away as they are shown to be is there, too, whoever sees which picture.
TEST_F(SeatViewsPictures, WhatIsOneMetreAwayIsInTheScreen) {
  hand_.labels.clear();
  hand_.lines = {};
  const auto dot_at = [&](double away) {
    const Eigen::Vector3d p = place_.T_world_camera * Eigen::Vector3d(0, 0.1 * away, away);
    HandPicture out;
    out.lines.line(p, p + Eigen::Vector3d(0, 0, 0.02 * away), {.colour = {1, 1, 1}, .width_px = 5});
    return out;
  };
  const auto columns = [&](double away) {  // of the dot, as the left and the right eye see it
    hand_ = {};
    const cv::Mat without = shown(ViewMode::anaglyph);
    hand_ = dot_at(away);
    const cv::Mat with = shown(ViewMode::anaglyph);
    std::array<double, 2> out{};
    for (int eye = 0; eye < 2; ++eye) {
      cv::Mat a, b, off;
      cv::extractChannel(without, a, eye == 0 ? 2 : 1);
      cv::extractChannel(with, b, eye == 0 ? 2 : 1);
      cv::absdiff(a, b, off);
      const cv::Moments m = cv::moments(off);
      EXPECT_GT(m.m00, 500) << away;
      out[static_cast<std::size_t>(eye)] = m.m10 / m.m00;
    }
    return out;
  };
  const double focal = lens_.parameters().fx * kWidth / lens_.width(), apart = 0.1;
  for (const double away : {0.5, 1.0}) {
    const auto at = columns(away);
    EXPECT_NEAR(at[0] - at[1], focal * apart * (1 / away - 1), 1.5) << away << " m";
    views_->swap_eyes();
    const auto swapped = columns(away);
    views_->swap_eyes();
    EXPECT_NEAR(swapped[1] - swapped[0], at[0] - at[1], 0.1);
  }
}

// A panel's picture is bent such that its lens straightens it: each of its pixels is what a straight view has in the
// direction in which that pixel is seen.
TEST_F(SeatViewsPictures, EyesAreDrawnForTheirPanels) {
  const Lens left = small_lens("rational");
  Lens::Parameters p = left.parameters();
  p.cx += 9;
  const Lens right(p);
  views_.emplace(SeatViewsSetup{.left = lens_, .eyes_apart = 0.1, .panels = std::array{left, right}});
  shown(ViewMode::two_eyes);
  const cv::Mat panels = shown(ViewMode::two_eyes);
  EXPECT_EQ(parts_.at(0).labels.size(), 1u);
  for (std::size_t eye = 0; eye < 2; ++eye) {
    const ViewTarget half = column(target_->whole(), static_cast<int>(eye), 2, 0);
    const Lens panel = fitted_lens(eye == 0 ? left : right, half.width, half.height);
    PredictedView expected = session_->make_view(panel);
    const double aside = eye == 0 ? -0.05 : 0.05;
    ASSERT_TRUE(session_->draw(expected, place_.T_world_camera * Eigen::Translation3d(aside, 0, 0), place_.scene));
    cv::Mat picture;
    cv::cvtColor(expected.read(), picture, cv::COLOR_BGRA2BGR);
    const ViewTarget part = fitted(half, panel.width(), panel.height());
    const cv::Mat seen = panels(cv::Rect(part.x, kHeight - part.y - part.height, part.width, part.height));
    ASSERT_EQ(seen.size(), picture.size());
    cv::Mat off;
    cv::absdiff(seen, picture, off);
    // The hand's line, the image in its corner and its words are over it.
    EXPECT_LT(cv::countNonZero(off.reshape(1) > 3), 0.2 * static_cast<double>(off.total() * 3)) << eye;
  }
  EXPECT_GT(line(panels), 0.001);
}

// What stands in for the prediction is bent, too: each panel has what its camera saw in the directions of its pixels.
TEST_F(SeatViewsPictures, NewestImagesAreBentForTheirPanels) {
  const Lens left = small_lens("rational");
  Lens::Parameters p = left.parameters();
  p.cx += 9;
  const std::array panels{left, Lens(p)};
  views_.emplace(SeatViewsSetup{.left = lens_, .eyes_apart = 0.1, .panels = panels});
  cv::Mat image(lens_.height(), lens_.width(), CV_8UC3, cv::Scalar(0, 0, 0));
  const Eigen::Vector2d spot(120, 40);  // px of both cameras: infinitely far away
  cv::circle(image, cv::Point(120, 40), 3, cv::Scalar(0, 255, 0), cv::FILLED);
  views_->upload_newest(image, image);
  const cv::Mat picture = shown(ViewMode::two_eyes, false);
  for (std::size_t eye = 0; eye < 2; ++eye) {
    const ViewTarget half =
        column(column(target_->whole(), 0, 1, 4), static_cast<int>(eye), 2, 0);  // within the frame of what is late
    const ViewTarget part = fitted(half, panels[eye].width(), panels[eye].height());
    const Eigen::Vector2d seen = *panels[eye].project(*lens_.unproject(spot));
    const double scale = part.width / static_cast<double>(panels[eye].width());
    const cv::Point at(part.x + static_cast<int>(scale * (seen.x() + 0.5)),
                       kHeight - part.y - part.height + static_cast<int>(scale * (seen.y() + 0.5)));
    EXPECT_GT(picture.at<cv::Vec3b>(at)[1], 100) << eye;
    EXPECT_LT(picture.at<cv::Vec3b>(at + cv::Point(7, 0))[1], 50) << eye;
  }
}

TEST_F(SeatViewsPictures, WarmingUpChangesNothing) {
  EXPECT_FALSE(views_->warm_up(*session_, target_->whole())) << "nothing is drawn yet";
  for (const ViewMode mode : {ViewMode::predicted, ViewMode::observer, ViewMode::two_eyes}) {
    views_.emplace(SeatViewsSetup{.left = lens_, .eyes_apart = 0.1});
    const cv::Mat before = shown(mode);
    const std::string words = views_->words(true);
    int looks = 0;
    while (views_->warm_up(*session_, target_->whole())) {
      ASSERT_LT(++looks, 100);
      EXPECT_EQ(views_->mode(), mode);
      EXPECT_EQ(views_->words(true), words);
    }
    EXPECT_GE(looks, 8);
    EXPECT_EQ(cv::norm(before, shown(mode), cv::NORM_L1), 0) << "mode " << static_cast<int>(mode);
    if (mode == ViewMode::predicted) {
      views_->toggle_observer();
      EXPECT_TRUE(views_->looks_from(place_.T_world_camera).isApprox(place_.T_world_camera))
          << "who looks on stands nowhere yet";
    }
  }
}

TEST_F(SeatViewsPictures, WhatIsNotTrustedGivesWayInAFrame) {
  for (int i = 0; i <= static_cast<int>(ViewMode::observer); ++i) {
    const auto mode = static_cast<ViewMode>(i);
    shown(mode);
    const cv::Mat picture = shown(mode, false);
    EXPECT_EQ(line(picture), 0) << i << ": what the hand does is predicted, too";
    EXPECT_EQ(share(picture.colRange(0, 3), cv::Scalar::all(255)), 1) << i << ": the ground is to be seen";
    EXPECT_NE(views_->words(false).find("cannot be trusted") == std::string::npos, mode != ViewMode::newest) << i;
    if (mode == ViewMode::anaglyph || mode == ViewMode::anaglyph_colours) continue;  // of other colours
    const bool shows_both = mode == ViewMode::both || mode == ViewMode::split;
    EXPECT_GT(late(picture) + late_right(picture), shows_both ? 0.2 : mode == ViewMode::two_eyes ? 0.4 : 0.8) << i;
  }
}

TEST_F(SeatViewsPictures, FromBesideThePanelAndTheHandAreInTheScene) {
  const cv::Mat picture = shown(ViewMode::observer);
  EXPECT_GT(late(picture), 0.005) << "the panel";
  EXPECT_LT(late(picture), 0.3);
  EXPECT_GT(line(picture), 0.0005);
  ASSERT_EQ(parts_.at(0).labels.size(), 1u);
  const auto& label = parts_[0].labels[0];
  const cv::Rect around =
      cv::Rect(static_cast<int>(label.x) - 8, static_cast<int>(label.y) - 8, 16, 16) & cv::Rect(0, 0, kWidth, kHeight);
  EXPECT_GT(line(picture(around)), 0.1) << "words stand where their place is seen";
  EXPECT_FALSE(views_->looks_from(place_.T_world_camera).isApprox(place_.T_world_camera))
      << "keys mean what is seen from there";
  views_->toggle_observer();
  EXPECT_TRUE(views_->looks_from(place_.T_world_camera).isApprox(place_.T_world_camera));
}

// Paint and size are the window's: the session's own view, which images are compared with, stays as it is.
TEST_F(SeatViewsPictures, TheSessionsViewIsLeftAlone) {
  const cv::Mat plain = shown(ViewMode::predicted), own = session_->read();
  for (int i = 0; i < 80; ++i) shown(ViewMode::predicted, true, 0.1);  // a renderer that has time
  EXPECT_EQ(cv::norm(own, session_->read(), cv::NORM_L1), 0);
  const cv::Mat larger = shown(ViewMode::predicted, true, 0.1);
  EXPECT_GT(cv::norm(plain, larger, cv::NORM_L1), 0) << "it has more pixels";
  EXPECT_LT(cv::norm(plain, larger, cv::NORM_L1) / static_cast<double>(plain.total() * 3), 8) << "of the same";
  views_->next_paint();
  EXPECT_GT(cv::norm(larger, shown(ViewMode::predicted), cv::NORM_L1), 1e5);
  EXPECT_EQ(cv::norm(own, session_->read(), cv::NORM_L1), 0);
}

/// Which class of classes.glsl a picture is painted in: hatching and what was shown make it darker, not of another hue.
int class_seen(const cv::Mat& picture) {
  const cv::Scalar kClasses[] = {{0.95, 0.75, 0.35}, {0.35, 0.85, 0.95}, {0.20, 0.40, 0.90}, {0.75, 0.35, 0.75}};
  const cv::Scalar mean = cv::mean(picture);
  const auto alike = [&](const cv::Scalar& c) { return mean.ddot(c) / std::sqrt(mean.ddot(mean) * c.ddot(c)); };
  return static_cast<int>(std::ranges::max_element(kClasses, {}, alike) - std::begin(kClasses));
}

/// What is learnt of pictures in which that share of the pixels of each kind is wrong, column by column of a kind.
ShownFidelity learnt_of(std::span<const std::pair<int, double>> wrong_of_doubt) {
  constexpr int kSide = 100;
  ShownFidelity out;
  const int columns = kSide * static_cast<int>(wrong_of_doubt.size());
  for (int round = 0; round < 60; ++round) {
    const RobotTime time = RobotTime{} + round * std::chrono::milliseconds(100);
    RememberedView shown{time, cv::Mat(kSide, columns, CV_8UC4, cv::Scalar(120, 120, 120, 255)),
                         cv::Mat(kSide, columns, CV_8UC1)};
    cv::Mat truth(kSide, columns, CV_8UC3, cv::Scalar(120, 120, 120));
    int left = 0;
    for (const auto& [doubt, wrong] : wrong_of_doubt) {
      shown.doubt.colRange(left, left + kSide) = doubt;
      truth(cv::Rect(left, 0, kSide, static_cast<int>(std::lround(kSide * wrong)))) = cv::Scalar(180, 180, 180);
      left += kSide;
    }
    out.shown(std::move(shown));
    out.arrived(time, truth);
  }
  return out;
}

// What is painted is what 'exact' is chosen by, and that is what images have shown.
TEST_F(SeatViewsPictures, ErrorsThatAreExpectedHaveColours) {
  doubt_ = gl::Texture(GL_R8, lens_.width(), lens_.height(), 0, 1, "doubt");
  hand_ = {};
  while (views_->paint() != ViewPaint::doubt) views_->next_paint();
  const auto painted = [&](int doubt, const KindRisks& risks) {
    risks_ = risks;
    const auto value = static_cast<std::uint8_t>(doubt);
    glClearTexImage(doubt_.name(), 0, GL_RED, GL_UNSIGNED_BYTE, &value);
    return class_seen(shown(ViewMode::predicted)(cv::Rect(110, 110, 80, 60)));
  };
  const std::pair<int, double> learnt[] = {{doubt_of({3, 0, Compared::never}), 0.2},
                                           {doubt_of({15, 1, Compared::never}), 0.01},
                                           {doubt_of({0, 0, Compared::suspect}), 0.0},
                                           {doubt_of({0, 0, Compared::same}), 0.1},
                                           {kBesideEdge + 4, 0.02},
                                           {kBesideEdge, 0.5}};
  const ShownFidelity before, after = learnt_of(learnt);
  for (const auto& [doubt, wrong] : learnt)
    EXPECT_EQ(painted(doubt, after.risks()), wrong <= kRarelyWrong  ? 0
                                             : wrong <= kOftenWrong ? 1
                                                                    : 2)
        << "doubt " << doubt << ", wrong in " << wrong;
  for (int doubt = 0; doubt < 256; doubt += 5)
    for (const ShownFidelity* fidelity : {&before, &after})
      EXPECT_EQ(painted(doubt, fidelity->risks()), class_of(static_cast<std::size_t>(doubt), fidelity->risks()))
          << doubt;
  EXPECT_EQ(painted(doubt_of({0, 0, Compared::same}), before.risks()), 0);
  EXPECT_EQ(painted(doubt_of({15, 0, Compared::off}), before.risks()), 2);
  EXPECT_EQ(painted(kUnconfirmed, after.risks()), 3) << "not known";
  EXPECT_TRUE(views_->shows_doubt());
  shown(ViewMode::two_eyes);
  EXPECT_FALSE(views_->shows_doubt());
  EXPECT_THAT(views_->words(true), testing::HasSubstr("one eye only"));
}

TEST(SeatViewsInset, StandsWithinWindowsOfAnyForm) {
  for (const auto& [width, height] : {std::pair{1280, 720}, {1920, 300}, {320, 1200}, {3840, 100}}) {
    const ViewTarget window{.x = 7, .y = 9, .width = width, .height = height};
    const ViewTarget inset = inset_place(window, 640, 480);
    EXPECT_NEAR(4.0 * inset.height, 3.0 * inset.width, 4) << width << " x " << height;
    EXPECT_GE(inset.x, window.x + width / 2);
    EXPECT_LE(inset.x + inset.width, window.x + width);
    EXPECT_GE(inset.y, window.y + height / 3);
    EXPECT_LE(inset.y + inset.height, window.y + height);
  }
  EXPECT_EQ(inset_place({.width = 1280, .height = 720}, 640, 480).width, 320) << "where there is room, a quarter";
}

TEST(SeatViewsRows, OddOnesAreThoseOfTheScreen) {
  const ViewTarget window{.width = 800, .height = 703}, lower{.width = 800, .height = 702};
  const auto odd = [](int top, const ViewTarget& whole) { return begins_at_odd_row(top, whole, fitted(whole, 4, 3)); };
  EXPECT_NE(odd(0, window), odd(0, lower)) << "the picture is 600 rows high, and begins a row further up";
  for (const ViewTarget& whole : {window, lower}) {
    EXPECT_NE(odd(0, whole), odd(1, whole));
    EXPECT_EQ(odd(0, whole), odd(-2, whole));
    EXPECT_EQ(odd(1, whole), odd(-1, whole)) << "above the screen's top";
  }
}

// Wherever the window is and however high, and whatever the picture's top row in it is.
TEST_F(SeatViewsPictures, EachEyeHasRowsOfTheScreen) {
  for (const int height : {kHeight, kHeight - 1, kHeight - 2, kHeight - 3, 203, 202})
    for (const int top : {0, 1, 37, -5}) {
      views_->set_mode(ViewMode::interlaced);
      ViewTarget window = target_->whole();
      window.height = height;
      fill(target_->whole(), 1, 1, 1);
      session_->draw(place_.T_world_camera, place_.scene);
      views_->draw(*session_, place_, window, 0);
      views_->show(*session_, window, {.trusted = false, .window_top = top});
      const cv::Mat rows = read_window();
      for (int y = 20; y < height - 20; ++y)
        ASSERT_EQ(late(rows.row(kHeight - height + y)) > 0.5, (top + y) % 2 == 0) << height << " " << top << " " << y;
    }
}

TEST_F(SeatViewsPictures, WindowsOfAllSizesAreBorne) {
  for (const auto& [width, height] : {std::pair{1, 1}, {3, 200}, {200, 2}, {0, 0}}) {
    ViewTarget small = target_->whole();
    small.width = width;
    small.height = height;
    for (int i = 0; i <= static_cast<int>(ViewMode::observer); ++i) {
      views_->set_mode(static_cast<ViewMode>(i));
      session_->draw(place_.T_world_camera, place_.scene);
      views_->draw(*session_, place_, small, 1);
      if (width > 0) views_->show(*session_, small, {.trusted = i % 2 == 0, .hand = &hand_});
    }
  }
}

}  // namespace
}  // namespace foresight::seat_views_test
