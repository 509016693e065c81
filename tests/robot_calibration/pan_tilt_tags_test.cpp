#include "calibration/robot/pan_tilt_tags.hpp"

#include "synthetic_rig.hpp"
#include "tests/scene/test_run.hpp"

namespace foresight::pan_tilt_tags_test {
namespace {

using testing::AllOf;
using testing::HasSubstr;

constexpr double kHalfTurn = 3.14159265358979323846;

/// A head with a pair of cameras in the middle of a ring of tags of 0.15 m.
struct TagRing {
  explicit TagRing(Random& random) {
    CameraModel lens{640, 480, Distortion::radtan4, {520, 521, 318, 243, -0.12, 0.03, 0.0004, -0.0006}};
    cameras.cameras = {lens, lens};
    cameras.T_left_right.translation().x() = 0.065;
    truth.T_world_pan = random_pose(random, 0.05, 0.05);
    truth.length_m = 0.003, truth.twist_rad = -kHalfTurn / 2 + 0.01;
    truth.T_tilt_camera.linear() =
        (Eigen::Matrix3d() << 0, 0, 1, 1, 0, 0, 0, 1, 0).finished() * random_pose(random, 0.02, 0).linear();
    truth.T_tilt_camera.translation() << 0.03, 0.01, 0.04;
    truth.backlash_rad = {-0.002, -0.001};
    for (int i = 0; i < 40; ++i) {
      Pose T = Pose::Identity();
      const double angle = 2 * kHalfTurn * i / 40;
      T.translate(Eigen::Vector3d((1.2 + 0.5 * (i % 3)) * std::cos(angle), (1.2 + 0.5 * (i % 3)) * std::sin(angle),
                                  0.5 * (i % 4) - 0.8));
      T.rotate(Eigen::AngleAxisd(angle + 0.3 * (i % 5 - 2), Eigen::Vector3d::UnitZ()));
      T.linear() *= (Eigen::Matrix3d() << 0, 0, 1, -1, 0, 0, 0, -1, 0).finished();  // x right, y down, z away
      const double s = 0.075;
      map[i] = {T * Eigen::Vector3d(-s, s, 0), T * Eigen::Vector3d(s, s, 0), T * Eigen::Vector3d(s, -s, 0),
                T * Eigen::Vector3d(-s, -s, 0)};
    }
  }

  /// What is seen at the shafts that `view`'s encoders, rates and `offset_s` mean, with noise.
  void look(Random& random, PanTiltView& view, double noise_px, double noise_rad, double offset_s) const {
    PanTiltAngles shafts = view.angles;
    shafts.pan += view.rate[0] * offset_s + normal(random, noise_rad);
    shafts.tilt += view.rate[1] * offset_s + normal(random, noise_rad);
    const Pose T_left_world = camera_pose(truth, shafts).inverse();
    for (const auto& [id, corners] : map)
      for (int camera = 0; camera < 2; ++camera) {
        SeenTag tag{id, camera, corners, {}};
        bool inside = true;
        for (std::size_t c = 0; c < 4; ++c) {
          const Eigen::Vector3d p = to_camera(cameras, camera, T_left_world * corners[c]);
          const auto pixel = p.z() > 0.2 && p.head<2>().norm() < p.z()
                                 ? project(cameras.cameras[static_cast<std::size_t>(camera)], p)
                                 : std::nullopt;
          inside = inside && pixel && pixel->x() > 0 && pixel->y() > 0 && pixel->x() < 639 && pixel->y() < 479;
          if (inside) tag.pixels[c] = *pixel + normal3(random, noise_px).head<2>();
        }
        if (inside) view.tags.push_back(tag);
      }
  }

  std::vector<PanTiltView> views(Random& random, int count, double noise_px, double noise_rad,
                                 double offset_s = 0) const {
    std::uniform_real_distribution<double> even(-1, 1);
    std::vector<PanTiltView> out;
    for (int i = 0; i < count; ++i) {
      PanTiltView view{"view" + std::to_string(i), {0.9 * even(random), 0.35 * even(random), {}}, {0, 0}, {}};
      view.angles.came = {even(random) > 0 ? 1 : -1, even(random) > 0 ? 1 : -1};
      if (offset_s != 0) view.rate = {0.5 * even(random), 0.4 * even(random)};
      look(random, view, noise_px, noise_rad, offset_s);
      out.push_back(view);
    }
    return out;
  }

  /// RMS px over views that no solver has seen, by encoders alone.
  double unseen_px(Random& random, const PanTiltModel& model) const {
    double sum = 0;
    std::size_t n = 0;
    for (const PanTiltView& view : views(random, 40, 0, 0))
      for (const double error : corner_errors(cameras, camera_pose(model, view.angles), view))
        sum += error * error, ++n;
    return std::sqrt(sum / static_cast<double>(n));
  }

  CalibratedCameras cameras;
  PanTiltModel truth;
  std::map<int, std::array<Eigen::Vector3d, 4>> map;
};

TEST(PanTiltTags, PredictsUnseenViewsFromNoisyOnes) {
  Random random(51);
  const TagRing ring(random);
  const PanTiltTagSummary found = solve_pan_tilt_tags(ring.views(random, 30, 0.15, 2e-4), ring.cameras, {});
  EXPECT_LT(ring.unseen_px(random, found.model), 0.15);
  EXPECT_NEAR(found.corner_px, 0.15, 0.02);
  EXPECT_NEAR(found.shaft_rad, 2e-4, 0.8e-4);
  EXPECT_NEAR(found.model.backlash_rad[0], -0.002, 3e-4);
  EXPECT_NEAR(found.model.backlash_rad[1], -0.001, 3e-4);
  EXPECT_GT(found.loo_px, found.in_sample_px);
  EXPECT_LT(found.loo_px, 0.5);
  EXPECT_EQ(found.sigmas.size(), found.names.size());
  EXPECT_THAT(found.notes, testing::Not(testing::Contains(HasSubstr("tag"))));
}

TEST(PanTiltTags, MovedAndMisreadTagsAreLeftOut) {
  Random random(52);
  const TagRing ring(random);
  std::vector<PanTiltView> views = ring.views(random, 30, 0.15, 1e-4);
  int moved = 0;
  for (PanTiltView& view : views)
    for (SeenTag& tag : view.tags)
      if (tag.id == 3 || tag.id == 38) {
        for (Eigen::Vector3d& corner : tag.corners) corner += Eigen::Vector3d(0.01, 0.02, -0.01);
        moved += 4;
      }
  ASSERT_GT(moved, 40);
  const PanTiltTagSummary found = solve_pan_tilt_tags(views, ring.cameras, {});
  EXPECT_GE(found.rejected_points, moved);
  EXPECT_LE(found.rejected_points, moved + 24);
  EXPECT_LT(ring.unseen_px(random, found.model), 0.15);
  EXPECT_THAT(found.notes, testing::UnorderedElementsAre(HasSubstr("tag 3 does not stand where the map has it"),
                                                         HasSubstr("tag 38 does not"), HasSubstr("gains")));
}

TEST(PanTiltTags, SaysThatTagsAreLargerThanTheMapHasThem) {
  Random random(56);
  const TagRing ring(random);
  std::vector<PanTiltView> views = ring.views(random, 20, 0.15, 1e-4);
  for (PanTiltView& view : views)
    for (SeenTag& tag : view.tags) {
      const Eigen::Vector3d middle = (tag.corners[0] + tag.corners[2]) / 2;
      for (Eigen::Vector3d& corner : tag.corners) corner = middle + 0.9 * (corner - middle);
    }
  EXPECT_THAT(solve_pan_tilt_tags(views, ring.cameras, {}).notes, testing::Contains(HasSubstr("the tags look 1.1")));
}

TEST(PanTiltTags, FindsTheClocksOffsetOfAMovingHead) {
  Random random(53);
  const TagRing ring(random);
  PanTiltTagOptions options;
  options.offset = true, options.gains = false;
  const PanTiltTagSummary found = solve_pan_tilt_tags(ring.views(random, 40, 0.15, 1e-4, 0.021), ring.cameras, options);
  EXPECT_NEAR(found.offset_s, 0.021, 4 * found.sigmas.back());
  EXPECT_EQ(found.names.back(), "offset_s");
  EXPECT_LT(found.sigmas.back(), 0.001);
  EXPECT_LT(ring.unseen_px(random, found.model), 0.2);
}

TEST(PanTiltTags, ErrorsLieWithinTheirSigmas) {
  Random random(54);
  const TagRing ring(random);
  PanTiltTagOptions options;
  options.score = false;
  double square = 0;
  int count = 0;
  for (int i = 0; i < 8; ++i) {
    const PanTiltTagSummary found = solve_pan_tilt_tags(ring.views(random, 25, 0.15, 3e-4), ring.cameras, options);
    const PanTiltView probe{"", {0.2, 0.1, {1, 1}}, {0, 0}, {}};
    const Vector6d off = step_between(camera_pose(found.model, probe.angles), camera_pose(ring.truth, probe.angles));
    square += off.cwiseQuotient(found.pose_sigma).squaredNorm();
    count += 6;
  }
  EXPECT_LT(std::sqrt(square / count), 1.6);
  EXPECT_GT(std::sqrt(square / count), 0.4);
}

TEST(PanTiltTags, RefusesWhatCannotBeSolved) {
  Random random(55);
  const TagRing ring(random);
  const std::vector<PanTiltView> good = ring.views(random, 20, 0.1, 0);
  const auto refusal = [&](const std::vector<PanTiltView>& views) {
    return input_error([&] { solve_pan_tilt_tags(views, ring.cameras, {}); });
  };
  EXPECT_THAT(refusal({good.begin(), good.begin() + 5}), HasSubstr("5 views show tags"));

  std::vector<PanTiltView> views = good;
  for (PanTiltView& view : views) {
    view.angles.tilt = 0.1, view.tags.clear();
    ring.look(random, view, 0.1, 0, 0);
  }
  EXPECT_THAT(refusal(views), AllOf(HasSubstr("only the pan joint moved"), HasSubstr("4 of 14")));
  for (PanTiltView& view : views) {
    view.angles.tilt = 0.5 * view.angles.pan, view.tags.clear();
    ring.look(random, view, 0.1, 0, 0);
  }
  EXPECT_THAT(refusal(views), HasSubstr("moved together"));

  views = good;
  for (PanTiltView& view : views)
    for (SeenTag& tag : view.tags) std::reverse(tag.corners.begin(), tag.corners.end());
  EXPECT_THAT(refusal(views), HasSubstr("--tags"));
}

}  // namespace
}  // namespace foresight::pan_tilt_tags_test
