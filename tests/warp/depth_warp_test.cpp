// A warped picture beside the one that is drawn from the new pose.
#include "display/warp/cube_views.hpp"
#include "display/warp/second_eye.hpp"

#include <random>

#include "display/view_session.hpp"
#include "gl/read_texture.hpp"
#include "tests/support/headless_test.hpp"
#include "tests/support/small_scene.hpp"
#include "tests/texture_gpu/reference/ray_caster.hpp"

namespace foresight::depth_warp_test {
namespace {

/// The same pinhole with so many pixels more at each border.
Lens with_guard(const Lens& lens, int guard) {
  Lens::Parameters p = lens.parameters();
  p.width += 2 * guard;
  p.height += 2 * guard;
  p.cx += guard;
  p.cy += guard;
  return Lens(p);
}

Lens eye() {
  Lens::Parameters p;
  p.width = 240;
  p.height = 180;
  p.fx = p.fy = 220;
  p.cx = 119.5;
  p.cy = 89.5;
  return Lens(p);
}

// Over all pixels and three channels.
double decibels(const cv::Mat& a, const cv::Mat& b) {
  double sum = 0;
  for (int y = 0; y < a.rows; ++y)
    for (int x = 0; x < a.cols; ++x)
      for (int c = 0; c < 3; ++c) {
        const double d = a.at<cv::Vec4b>(y, x)[c] - b.at<cv::Vec4b>(y, x)[c];
        sum += d * d;
      }
  return 10 * std::log10(255 * 255 / (sum / (3.0 * static_cast<double>(a.total()))));
}

class DepthWarpTest : public HeadlessTest {
 protected:
  static constexpr int kGuard = 24;
  void SetUp() override {
    HeadlessTest::SetUp();
    if (IsSkipped()) return;
    ViewSetup setup{scene_, surface_for(*scene_, small_lens("pinhole"), {}), small_lens("pinhole"), std::nullopt, {},
                    {}};
    setup.textures.memory_bytes = 12 << 20;
    session_.emplace(*context_, setup);
    for (const Pose& from :
         {usual_view(), look_at({-0.4, -1.0, 0.8}, {0, 0, 0.1}), look_at({-1.0, -0.3, 0.8}, {0, 0, 0.1})})
      session_->process({posed_photograph(*scene_, state_, small_lens("pinhole"), from), std::nullopt});
    source_.emplace(session_->make_view(with_guard(eye(), kGuard)));
    truth_.emplace(session_->make_view(eye()));
    for (auto* view : {&source_, &truth_}) (*view)->mix_silhouettes(false);  // as those that a head display warps
    parts_ = std::make_shared<WarpScene>(*scene_);
    capture_.emplace(parts_);
    layers_.emplace(with_guard(eye(), kGuard));
    warp_.emplace(parts_, eye());
  }
  void TearDown() override {
    warp_.reset();
    layers_.reset();
    capture_.reset();
    parts_.reset();
    source_.reset();
    truth_.reset();
    session_.reset();
    HeadlessTest::TearDown();
  }
  /// From where the source was drawn to where it is warped to: decibels against drawing it there.
  double warped(const Pose& from, const Pose& to) {
    draw_source(from);
    (*warp_)(*layers_, to);
    return compared(to, state_, warp_->picture(), warp_->holes());
  }
  void draw_source(const Pose& from) {
    session_->draw(*source_, from, state_);
    (*capture_)(source_->picture(), source_->faces(), from, state_, *layers_);
  }
  double compared(const Pose& to, const SceneState& state, const gl::Texture& picture, const gl::Texture& holes) {
    session_->draw(*truth_, to, state);
    drawn_ = gl::read_texture(truth_->picture());
    shown_ = gl::read_texture(picture);
    holes_ = gl::read_texture(holes);
    return decibels(drawn_, shown_);
  }
  // Of pixels at which there is something: what is behind the model's own border nobody can draw.
  double holes_on_model() const {
    cv::Mat alpha;
    cv::extractChannel(drawn_, alpha, 3);
    return cv::countNonZero((holes_ != 0) & (alpha > 0)) / static_cast<double>(holes_.total());
  }
  double holes() const { return cv::countNonZero(holes_) / static_cast<double>(holes_.total()); }

  std::shared_ptr<const SceneModel> scene_ = small_scene();
  SceneState state_ = state_of(*scene_);
  std::optional<ViewSession> session_;
  std::optional<PredictedView> source_, truth_;
  std::shared_ptr<const WarpScene> parts_;
  std::optional<LayerCapture> capture_;
  std::optional<WarpLayers> layers_;
  std::optional<DepthWarp> warp_;
  cv::Mat drawn_, shown_, holes_;
};

Pose moved(const Pose& T, const Eigen::Vector3d& by, double turn, const Eigen::Vector3d& axis) {
  Pose step = Pose::Identity();
  step.translation() = by;
  step.linear() = Eigen::AngleAxisd(turn, axis.normalized()).toRotationMatrix();
  return T * step;
}

TEST_F(DepthWarpTest, WithoutMotionItIsThePictureItself) {
  const double db = warped(usual_view(), usual_view());
  EXPECT_GT(db, 55);
  EXPECT_EQ(holes(), 0);
}

// 2 degrees and 2 cm: what a head does in a tenth of a second.
TEST_F(DepthWarpTest, AHeadsSmallMotionsAreShownAsIfDrawnAnew) {
  std::mt19937 random(1);
  std::normal_distribution some(0.0, 1.0);
  const auto any = [&] { return Eigen::Vector3d(some(random), some(random), some(random)).normalized().eval(); };
  double worst = 1e9, most_holes = 0, sum = 0;
  constexpr int kViews = 12;
  for (int i = 0; i < kViews; ++i) {
    const Pose to = moved(usual_view(), 0.02 * any(), 2 * EIGEN_PI / 180, any());
    const double db = warped(usual_view(), to);
    worst = std::min(worst, db);
    most_holes = std::max(most_holes, holes());
    sum += db;
    EXPECT_EQ(cv::countNonZero(holes_ == 255), 0) << "the guard band reaches";
  }
  RecordProperty("mean_db", std::to_string(sum / kViews));
  RecordProperty("worst_db", std::to_string(worst));
  RecordProperty("most_holes", std::to_string(most_holes));
  EXPECT_GT(worst, 30);
  EXPECT_GT(sum / kViews, 32);
  EXPECT_LT(most_holes, 0.02) << "of a small picture, where borders count for more";
  std::printf("mean %.2f dB, worst %.2f dB, holes at most %.2f %%\n", sum / kViews, worst, 100 * most_holes);
}

// Whoever only turns the picture leaves near things behind.
TEST_F(DepthWarpTest, DepthIsWorthIt) {
  const Pose to = moved(usual_view(), {0.02, 0, 0}, 0, Eigen::Vector3d::UnitX());
  const double db = warped(usual_view(), to);
  cv::Mat unmoved = gl::read_texture(source_->picture())(cv::Rect(kGuard, kGuard, 240, 180)).clone();
  EXPECT_GT(db, decibels(drawn_, unmoved) + 8);
}

// A hole is a place that the source did not see; and what it saw is no hole.
TEST_F(DepthWarpTest, HolesAreWhatTheSourceDidNotSee) {
  const Pose from = usual_view(), to = moved(from, {0.06, 0.02, 0}, 0.01, Eigen::Vector3d::UnitY());
  warped(from, to);
  ASSERT_GT(holes(), 0.002);
  const reference::RayCaster rays(*scene_, state_);
  int hidden = 0, told = 0, right = 0;
  for (int y = 0; y < holes_.rows; y += 2)
    for (int x = 0; x < holes_.cols; x += 2) {
      const Eigen::Vector3d d = to.linear() * eye().unproject({x, y})->normalized();
      const auto hit = rays.cast(to.translation(), d, gl::kNearPlane);
      if (!hit) continue;
      const Eigen::Vector3d sight = hit->p_world - from.translation();
      const auto seen = rays.cast(from.translation(), sight.normalized(), gl::kNearPlane);
      const bool is_hidden = seen && seen->t < sight.norm() - 0.01;
      hidden += is_hidden;
      told += holes_.at<std::uint8_t>(y, x) != 0;
      right += is_hidden && holes_.at<std::uint8_t>(y, x) != 0;
    }
  std::printf("%d hidden, %d told of, %d of them hidden\n", hidden, told, right);
  EXPECT_GT(right, 0.75 * hidden);
  EXPECT_GT(right, 0.6 * told) << "borders are a pixel wide";
}

// The second eye stands 65 mm beside the first, to either side; what only it sees is filled and told of.
TEST_F(DepthWarpTest, ASecondEyeIsMadeOfTheFirstRowByRow) {
  const Pose first = usual_view();
  draw_source(first);
  DepthWarp wide(parts_, with_guard(eye(), kGuard));  // the other eye sees beyond the border
  wide(*layers_, first);
  for (const double side : {0.065, -0.065}) {
    ASSERT_TRUE(SecondEye::fits(wide.lens(), eye(), Pose(Eigen::Translation3d(side, 0, 0))));
    SecondEye second(wide.lens(), eye());
    second(wide.picture(), wide.depth(), side);
    const double db = compared(first * Eigen::Translation3d(side, 0, 0), state_, second.picture(), second.holes());
    std::printf("%+.3f m: %.2f dB, holes %.2f %%\n", side, db, 100 * holes());
    EXPECT_GT(db, 27) << side;
    EXPECT_LT(holes(), 0.06) << side;
    EXPECT_GT(holes(), 0.002) << "it sees behind things";
  }
}

TEST_F(DepthWarpTest, ASecondEyeThatLooksElsewhereIsNotMadeSo) {
  Pose turned(Eigen::Translation3d(0.065, 0, 0));
  turned.linear() = Eigen::AngleAxisd(0.1, Eigen::Vector3d::UnitY()).toRotationMatrix();
  EXPECT_FALSE(SecondEye::fits(eye(), eye(), turned));
  EXPECT_FALSE(SecondEye::fits(eye(), eye(), Pose(Eigen::Translation3d(0.065, 0.01, 0))));
  EXPECT_FALSE(SecondEye::fits(eye(), small_lens("pinhole"), Pose(Eigen::Translation3d(0.065, 0, 0))));
  EXPECT_THROW(SecondEye(eye(), small_lens("pinhole")), std::invalid_argument);
}

// A part that goes on after the picture was drawn goes on in the warped one, and what it stood before comes out.
TEST_F(DepthWarpTest, PartsMoveBetweenDrawnPictures) {
  const SceneState later = state_of(*scene_, 0.06);
  draw_source(usual_view());
  const Pose to = moved(usual_view(), {0.005, 0, 0}, 0.01, Eigen::Vector3d::UnitY());
  (*warp_)(*layers_, to);
  const double still = compared(to, later, warp_->picture(), warp_->holes());
  (*warp_)(*layers_, to, later.T_world_node);
  const double moves = compared(to, later, warp_->picture(), warp_->holes());
  std::printf("%.2f dB where it stands still, %.2f dB where it moves, holes %.2f %%\n", still, moves, 100 * holes());
  EXPECT_GT(moves, still + 3);
  EXPECT_GT(moves, 28);
  (*warp_)(*layers_, to, state_.T_world_node);
  EXPECT_NEAR(compared(to, later, warp_->picture(), warp_->holes()), still, 1e-9) << "nobody moved";
}

// Whoever turns on the spot sees what was drawn before; whoever goes away does not.
TEST_F(DepthWarpTest, FacesAroundTheViewerServeAHeadThatTurns) {
  CubeViews cube(parts_, eye());
  PredictedView face_view = session_->make_view(cube.face_lens());
  const auto draw_missing = [&](const Pose& from) {
    int drawn = 0;
    while (const auto face = cube.missing(from)) {
      const Pose at = CubeViews::T_world_face(face->side, from);
      session_->draw(face_view, at, state_);
      (*capture_)(face_view.picture(), face_view.faces(), at, state_, cube.layers(*face));
      if (++drawn > CubeViews::kFaces) break;
    }
    return drawn;
  };
  const auto shown = [&](const Pose& from) {
    const gl::Texture& picture = cube(from, state_.T_world_node);
    const double db = compared(from, state_, picture, cube.holes());
    EXPECT_EQ(cv::countNonZero(holes_ == 255), 0) << "every direction is there";
    return db;
  };
  const int first = draw_missing(usual_view());
  EXPECT_GE(first, 1);
  EXPECT_LE(first, 4);
  EXPECT_GT(shown(usual_view()), 32);
  // Small turns of the head need nothing new; all the way round, each face once.
  const Pose turned = moved(usual_view(), {0.01, 0, 0}, 0.05, Eigen::Vector3d::UnitZ());
  EXPECT_EQ(draw_missing(turned), 0);
  EXPECT_GT(shown(turned), 30);
  int all = first;
  for (double angle = 0.3; angle < 6.3; angle += 0.3)
    all += draw_missing(moved(usual_view(), {0, 0, 0}, angle, Eigen::Vector3d::UnitY()));
  EXPECT_LE(all, 6);
  EXPECT_EQ(draw_missing(usual_view()), 0);
  EXPECT_GE(draw_missing(moved(usual_view(), {0.2, 0, 0}, 0, Eigen::Vector3d::UnitY())), 1) << "too far from there";
  // Near things move more: closely over the table, a step serves no more that does elsewhere.
  const Pose low = look_at({0.25, -0.1, 0.04}, {0, 0, 0.03});
  const auto step = [](const Pose& from) { return moved(from, {0.02, 0, 0}, 0, Eigen::Vector3d::UnitY()); };
  EXPECT_GE(draw_missing(low), 1);
  EXPECT_EQ(draw_missing(low), 0) << "drawn once";
  EXPECT_GE(draw_missing(step(low)), 1);
  cube.forget();
  EXPECT_EQ(draw_missing(usual_view()), first);
  EXPECT_EQ(draw_missing(step(usual_view())), 0);
}

// Near things are drawn again when the viewer moves or the picture changes, far ones more rarely; at each pixel the
// nearest surface is seen, whatever is drawn from where.
TEST_F(DepthWarpTest, ShellsOfDistanceHaveRatesOfTheirOwn) {
  CubeViews cube(parts_, eye(), {1.05});
  PredictedView face_view = session_->make_view(cube.face_lens());
  const auto draw_missing = [&](const Pose& from) {
    std::array<int, 2> drawn{};
    while (const auto face = cube.missing(from)) {
      const Pose at = CubeViews::T_world_face(face->side, from);
      face_view.draw_part(cube.part(face->shell));
      session_->draw(face_view, at, state_);
      (*capture_)(face_view.picture(), face_view.faces(), at, state_, cube.layers(*face));
      if (++drawn[face->shell] > CubeViews::kFaces) break;
    }
    return drawn;
  };
  const auto first = draw_missing(usual_view());
  EXPECT_GE(first[0], 1);
  EXPECT_EQ(first[0], first[1]);
  EXPECT_GT(compared(usual_view(), state_, cube(usual_view()), cube.holes()), 30);
  EXPECT_EQ(cv::countNonZero(holes_ == 255), 0);
  // Farther than near things may be looked at from, and not so far for the others.
  const Pose aside = moved(usual_view(), {0.08, 0, 0}, 0.02, Eigen::Vector3d::UnitY());
  const auto again = draw_missing(aside);
  EXPECT_GE(again[0], 1);
  EXPECT_EQ(again[1], 0);
  const double db = compared(aside, state_, cube(aside), cube.holes());
  EXPECT_GT(db, 28) << "drawn from two places, with no gap and the right order between";
  EXPECT_LT(holes_on_model(), 0.02);
  // What has changed is seen in near things at once, in far ones with every second change.
  for (int change = 1; change <= 4; ++change) {
    cube.changed();
    const auto drawn = draw_missing(aside);
    EXPECT_GE(drawn[0], 1) << change;
    EXPECT_EQ(drawn[1] > 0, change % 2 == 0) << change;
  }
  EXPECT_THROW(CubeViews(parts_, eye(), {1, 0.9}), std::invalid_argument);
  EXPECT_THROW(CubeViews(parts_, eye(), {0.01}), std::invalid_argument);
}

// What stands behind the edges of a view is drawn once more: most holes are none then.
TEST_F(DepthWarpTest, HolesAreLookedUpBehindEdges) {
  const Pose from = usual_view();
  session_->draw(*source_, from, state_);
  (*capture_)(source_->picture(), source_->faces(), from, state_, *layers_);
  WarpLayers behind(with_guard(eye(), kGuard), true);
  source_->draw_part(capture_->behind_edges(*layers_));
  session_->draw(*source_, from, state_);
  (*capture_)(source_->picture(), source_->faces(), from, state_, behind);
  source_->draw_part(std::nullopt);
  const cv::Mat first = gl::read_texture(layers_->depth), second = gl::read_texture(behind.depth);
  EXPECT_GT(cv::countNonZero(second), 200);
  EXPECT_EQ(cv::countNonZero((second > 0) & (second >= first)), 0) << "all of it is hidden";
  double all_before = 0, all_after = 0;
  for (const double side : {0.02, -0.02, 0.05}) {
    const SceneState later = state_of(*scene_, 0.5 * side);  // a part moves, too
    const Pose to = moved(from, {side, 0.3 * side, 0}, 0.01, Eigen::Vector3d::UnitY());
    (*warp_)(*layers_, to, later.T_world_node);
    const double filled = compared(to, later, warp_->picture(), warp_->holes()), holes_before = holes_on_model();
    warp_->mend(behind, to, later.T_world_node);
    const double mended = compared(to, later, warp_->picture(), warp_->holes());
    std::printf("%+.2f m: holes %.2f %% -> %.2f %%, %.2f -> %.2f dB\n", side, 100 * holes_before,
                100 * holes_on_model(), filled, mended);
    EXPECT_GT(mended, filled - 0.1) << side;
    all_before += holes_before;
    all_after += holes_on_model();
  }
  EXPECT_LT(all_after, 0.5 * all_before);
}

// The distortion of a panel's lens is part of the same pass, as if the view were drawn through that lens.
TEST_F(DepthWarpTest, APanelsLensIsPartOfThePass) {
  draw_source(usual_view());
  for (const char* kind : {"plumb_bob", "rational"}) {
    Lens::Parameters p = small_lens(kind).parameters();
    p.fx = p.fy = 1.05 * eye().parameters().fx * p.width / eye().width();  // all of it is in the source
    const Lens panel(p);
    DepthWarp through(parts_, panel);
    truth_.emplace(session_->make_view(panel));
    for (const double side : {0.0, 0.02}) {
      const Pose to = moved(usual_view(), {side, 0, 0}, 0.5 * side, Eigen::Vector3d::UnitY());
      const SceneState later = state_of(*scene_, 2 * side);  // a part has moved
      through(*layers_, to, later.T_world_node);
      const double db = compared(to, later, through.picture(), through.holes());
      std::printf("%s, moved by %.2f m: %.2f dB, holes %.2f %%\n", kind, side, db, 100 * holes());
      EXPECT_GT(db, 29) << kind;
      EXPECT_EQ(cv::countNonZero(holes_ == 255), 0) << kind << ": the guard band reaches";
      EXPECT_LT(holes(), 0.05) << kind;
    }
  }
}

// What the lens does not see stays empty.
TEST_F(DepthWarpTest, BeyondWhatALensSeesNothingIsShown) {
  draw_source(usual_view());
  const Lens fisheye = small_lens("wide_fisheye");
  DepthWarp through(parts_, fisheye);
  through(*layers_, usual_view());
  const cv::Mat shown = gl::read_texture(through.picture());
  for (int y = 0; y < shown.rows; ++y)
    for (int x = 0; x < shown.cols; ++x) {
      const auto ray = fisheye.unproject({x, y});
      if (!ray || ray->z() < 0.05) {
        ASSERT_EQ(shown.at<cv::Vec4b>(y, x), cv::Vec4b(0, 0, 0, 0)) << x << " " << y;
      }
    }
  EXPECT_GT(shown.at<cv::Vec4b>(shown.rows / 2, shown.cols / 2)[3], 0);
}

TEST_F(DepthWarpTest, RefusesWhatItCannotDo) {
  EXPECT_THROW(WarpLayers(small_lens("fisheye")), std::invalid_argument);
  session_->draw(*source_, usual_view(), state_);
  WarpLayers other(eye());
  EXPECT_THROW((*capture_)(source_->picture(), source_->faces(), usual_view(), state_, other), std::invalid_argument)
      << "of another size";
}

}  // namespace
}  // namespace foresight::depth_warp_test
