// The truth of synthetic runs, read back: against the meshes, the poses and the pictures.
#include "scene/ground_truth.hpp"

#include <map>

#include "sim/motion.hpp"
#include "sim/pose_error.hpp"
#include "sim/synth_run.hpp"
#include "tests/scene/test_run.hpp"

namespace foresight::sim::ground_truth_test {
namespace {

namespace fs = std::filesystem;
using Eigen::Vector3d;

double distance_to_triangle(const Vector3d& p, const Vector3d& a, const Vector3d& b, const Vector3d& c) {
  const Vector3d n = (b - a).cross(c - a).normalized();
  const auto inside = [&](const Vector3d& from, const Vector3d& to) { return (to - from).cross(p - from).dot(n) >= 0; };
  if (inside(a, b) && inside(b, c) && inside(c, a)) return std::abs(n.dot(p - a));
  const auto to_edge = [&](const Vector3d& from, const Vector3d& to) {
    const double s = std::clamp((p - from).dot(to - from) / (to - from).squaredNorm(), 0.0, 1.0);
    return (p - from - s * (to - from)).norm();
  };
  return std::min({to_edge(a, b), to_edge(b, c), to_edge(c, a)});
}

double distance_to_mesh(const Vector3d& p, const Mesh& mesh) {
  double least = 1;
  for (const auto& t : mesh.triangles)
    least =
        std::min(least, distance_to_triangle(p, mesh.vertices[t[0]].cast<double>(), mesh.vertices[t[1]].cast<double>(),
                                             mesh.vertices[t[2]].cast<double>()));
  return least;
}

// Every truth point lies on its node; returns how many points there are on the arm.
int check_points(const fs::path& folder, bool right) {
  const RunFolder run = RunFolder::open(folder, {});
  const GroundTruth truth = GroundTruth::open(run);
  int on_arm = 0;
  for (std::size_t frame = 0; frame < run.frames().size(); ++frame) {
    const auto surface = truth.read(frame, right);
    for (int v = 0; v < surface.height(); v += 2)
      for (int u = 0; u < surface.width(); u += 2) {
        const auto point = surface.at(u, v);
        if (!point) continue;
        const Node& node = run.scene()->nodes()[static_cast<std::size_t>(point->node)];
        EXPECT_LT(distance_to_mesh(point->p_node, node.mesh), 3e-4) << node.name << " at " << u << ", " << v;
        on_arm += node.name.starts_with("arm_");
      }
  }
  return on_arm;
}

class Truth : public testing::Test {
 protected:
  TempFolder folder_;
  SynthOptions small_{.width = 96, .height = 72, .frames = 2, .rate = 1};
};

TEST_F(Truth, PointsLieOnTheirNodes) {
  small_.stereo = true;
  write_synth_run(folder_ / "run", small_);
  EXPECT_GT(check_points(folder_ / "run", false), 50);
  EXPECT_GT(check_points(folder_ / "run", true), 50);
}

TEST_F(Truth, PointsLieOnTheirNodesThroughAFisheyeRowByRow) {
  small_.fisheye = true;
  small_.shutter = {.exposure_s = 0.01, .readout_s = 0.03};
  small_.rate = 30;
  write_synth_run(folder_ / "run", small_);
  EXPECT_GT(check_points(folder_ / "run", false), 50);
}

TEST_F(Truth, PoseErrorsAreAsLargeAsAsked) {
  small_.pose_error_px = 1.5;
  small_.frames = 3;
  write_synth_run(folder_ / "run", small_);
  const RunFolder run = RunFolder::open(folder_ / "run", {});
  const GroundTruth truth = GroundTruth::open(run);
  std::vector<Pose> errors;
  for (std::size_t frame = 0; frame < run.frames().size(); ++frame) {
    const Pose T_true = truth.T_world_camera(frame, false);
    EXPECT_TRUE(T_true.isApprox(T_world_camera_at(static_cast<double>(frame) / small_.rate), 1e-9));
    const auto surface = truth.read(frame, false);
    double sum = 0;
    int count = 0;
    for (int v = 0; v < surface.height(); ++v)
      for (int u = 0; u < surface.width(); ++u) {
        const auto ray = run.lens_left().unproject({u, v});
        if (!surface.at(u, v) || !ray) continue;
        const Vector3d p_world = T_true * (*ray * (surface.depth(u, v) / ray->z()));
        const auto seen = run.lens_left().project(run.frames()[frame].left.T_world_camera.inverse() * p_world);
        if (!seen) continue;
        sum += (*seen - Eigen::Vector2d(u, v)).squaredNorm();
        ++count;
      }
    EXPECT_NEAR(std::sqrt(sum / count), 1.5, 0.002);
    errors.push_back(T_true.inverse() * run.frames()[frame].left.T_world_camera);
  }
  EXPECT_FALSE(errors[0].isApprox(errors[1], 1e-4)) << "each image has its own";
}

TEST_F(Truth, PoseErrorsStayAlikeAsLongAsAsked) {
  small_.pose_error_px = 1.5;
  small_.pose_error_s = 10;  // images are 1 s apart
  small_.frames = 3;
  write_synth_run(folder_ / "run", small_);
  const RunFolder run = RunFolder::open(folder_ / "run", {});
  const GroundTruth truth = GroundTruth::open(run);
  const auto turn = [&](std::size_t frame) {
    const Eigen::AngleAxisd error(
        (truth.T_world_camera(frame, false).inverse() * run.frames()[frame].left.T_world_camera).linear());
    return Eigen::Vector3d(error.angle() * error.axis());
  };
  for (std::size_t frame = 1; frame < 3; ++frame) {
    EXPECT_GT(turn(frame).norm(), 1e-4);
    EXPECT_GT(turn(frame).normalized().dot(turn(frame - 1).normalized()), 0.5) << frame;
  }
}

TEST_F(Truth, WithoutPoseErrorsTheRecordedPosesAreTrue) {
  write_synth_run(folder_ / "run", small_);
  const RunFolder run = RunFolder::open(folder_ / "run", {});
  const GroundTruth truth = GroundTruth::open(run);
  for (std::size_t frame = 0; frame < run.frames().size(); ++frame)
    EXPECT_TRUE(truth.T_world_camera(frame, false).isApprox(run.frames()[frame].left.T_world_camera, 1e-12));
}

TEST_F(Truth, MayBeLeftOut) {
  small_.truth = false;
  write_synth_run(folder_ / "run", small_);
  const RunFolder run = RunFolder::open(folder_ / "run", {});
  EXPECT_FALSE(GroundTruth::exists(run));
  EXPECT_THAT(input_error([&] { GroundTruth::open(run); }), testing::HasSubstr("truth.yaml"));
}

TEST_F(Truth, SaysWhatIsWrongWithItsFiles) {
  small_.frames = 1;
  small_.width = small_.height = 16;
  write_synth_run(folder_ / "run", small_);
  const RunFolder run = RunFolder::open(folder_ / "run", {});
  const std::string yaml = folder_.read("run/truth/truth.yaml"), depth = folder_.read("run/truth/depth/000000.png"),
                    node = folder_.read("run/truth/node/000000.png"), poses = folder_.read("run/truth/trajectory.txt");
  struct Case {
    std::string file, content, where, what;
  };
  const std::vector<Case> cases = {
      {"truth.yaml", "depth_unit_m: 0\nreadout_s: 0\nnodes: 3\n", "truth.yaml:1", "depth unit"},
      {"truth.yaml", "depth_unit_m: 0.001\nreadout_s: -1\nnodes: 3\n", "truth.yaml:2", "readout"},
      {"truth.yaml", "depth_unit_m: 0.001\nreadout_s: 0\nnodes: 3\n", "truth.yaml:3", "speaks of 3 nodes"},
      {"truth.yaml", "depth_unit_m: 0.001\nreadout: 0\nnodes: 3\n", "truth.yaml:2", "readout"},
      {"trajectory.txt", "5 0 0 0 0 0 0 1\n", "trajectory.txt", "no pose"},
      {"trajectory.txt", "0 0 0 0\n", "trajectory.txt:1", "4 fields"},
      {"depth/000000.png", depth.substr(0, 60), "000000.png", ""},
      {"depth/000000.png", encoded(".png", cv::Mat(16, 16, CV_8UC1, cv::Scalar(3))), "000000.png", "16-bit"},
      {"depth/000000.png", encoded(".png", cv::Mat(8, 16, CV_16UC1, cv::Scalar(3))), "000000.png", "16x8"},
      {"node/000000.png", encoded(".png", cv::Mat(16, 16, CV_16UC1, cv::Scalar(999))), "000000.png", "node 998"},
  };
  for (const Case& c : cases) {
    SCOPED_TRACE(c.file + c.what);
    folder_.write("run/truth/" + c.file, c.content);
    EXPECT_THAT(input_error([&] { GroundTruth::open(run).read(0, false); }), says(c.where, c.what, ""));
    folder_.write("run/truth/truth.yaml", yaml);
    folder_.write("run/truth/trajectory.txt", poses);
    folder_.write("run/truth/depth/000000.png", depth);
    folder_.write("run/truth/node/000000.png", node);
  }
  EXPECT_EQ(input_error([&] { GroundTruth::open(run).read(0, false); }), "no error");
  fs::remove(folder_ / "run/truth/node/000000.png");
  EXPECT_THAT(input_error([&] { GroundTruth::open(run).read(0, false); }), says("000000.png", "no such file", ""));
  EXPECT_THAT(input_error([&] { GroundTruth::open(run).read(0, true); }), says("truth_right", "is missing", "synth"));
}

}  // namespace
}  // namespace foresight::sim::ground_truth_test
