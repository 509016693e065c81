#include "sim/synth_run.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <opencv2/imgproc.hpp>
#include <sstream>

#include "common/error.hpp"
#include "scene/run_folder.hpp"
#include "sim/lamp.hpp"
#include "sim/motion.hpp"
#include "sim/run_files.hpp"
#include "sim/tracer.hpp"

namespace foresight::sim::synth_run_test {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

std::map<std::string, std::string> bytes_of(const fs::path& folder) {
  std::map<std::string, std::string> out;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    if (!entry.is_regular_file()) continue;
    std::ifstream file(entry.path(), std::ios::binary);
    std::stringstream text;
    text << file.rdbuf();
    out[fs::relative(entry.path(), folder).string()] = text.str();
  }
  return out;
}

// The model of a run at one instant, as triangles in the world.
struct World {
  World(const RunFolder& run, RobotTime time) : state(run.state_at(time)) {
    std::vector<Triangle> triangles;
    for (std::size_t n = 0; n < run.scene()->nodes().size(); ++n) {
      const Mesh& mesh = run.scene()->nodes()[n].mesh;
      for (const auto& t : mesh.triangles) {
        Triangle world;
        for (int k = 0; k < 3; ++k)
          world[k] = (state.T_world_node[n] * mesh.vertices[t[k]].cast<double>()).cast<float>();
        triangles.push_back(world);
        node.push_back(static_cast<int>(n));
      }
    }
    tracer.emplace(std::move(triangles));
  }
  SceneState state;
  std::vector<int> node;  // of each triangle
  std::optional<Tracer> tracer;
};

class SynthRun : public ::testing::Test {
 protected:
  SynthRun() : folder_(fs::temp_directory_path() / ("foresight_synth_test_" + std::to_string(getpid()))) {
    fs::remove_all(folder_);
    fs::create_directories(folder_);
  }
  ~SynthRun() override { fs::remove_all(folder_); }

  std::vector<fs::path> left_behind() const {
    std::vector<fs::path> out;
    for (const auto& entry : fs::directory_iterator(folder_)) out.push_back(entry.path());
    return out;
  }

  fs::path folder_;
  const SynthOptions tiny_{.width = 48, .height = 36, .frames = 2, .sensor = {.noise = 2}, .pose_error_px = 0};
};

TEST_F(SynthRun, IsReadBackAsWritten) {
  SynthOptions options = tiny_;
  options.stereo = true;
  write_synth_run(folder_ / "run", options);
  const RunFolder run = RunFolder::open(folder_ / "run", {});
  ASSERT_EQ(run.frames().size(), 2u);
  EXPECT_EQ(run.lens_left().parameters().d, synth_lens(options, false).parameters().d);
  EXPECT_EQ(run.lens_right()->parameters().fx, synth_lens(options, true).parameters().fx);
  EXPECT_TRUE(run.T_left_right().isApprox(T_left_right(), 1e-12));
  const double t = 1 / options.rate;
  EXPECT_EQ(run.frames()[1].left.pose_status, StateStatus::exact);
  EXPECT_TRUE(run.frames()[1].left.T_world_camera.isApprox(T_world_camera_at(t), 1e-11));
  ASSERT_TRUE(run.frames()[1].right);
  EXPECT_TRUE(run.frames()[1].right->T_world_camera.isApprox(T_world_camera_at(t) * T_left_right(), 1e-11));
  const SceneState state = run.state_at(run.frames()[1].left.time);
  EXPECT_EQ(state.status, StateStatus::exact);
  const Lab lab = make_lab(0.01, 1);
  const LabState expected = lab_state_at(lab, t);
  ASSERT_EQ(run.scene()->nodes().size(), lab.parts.size());
  for (std::size_t k = 0; k < lab.parts.size(); ++k) {
    const auto node = static_cast<std::size_t>(run.scene()->find(lab.parts[k].name).value());
    EXPECT_TRUE(state.T_world_node[node].isApprox(expected[k], 1e-11)) << lab.parts[k].name;
    EXPECT_EQ(run.scene()->nodes()[node].mesh.triangles.size(), lab.parts[k].facets.size()) << lab.parts[k].name;
  }
  // The robot's own joints say the same as its tracks do at the start.
  const auto rest = run.scene()->rest_poses();
  const auto start = run.state_at(run.frames()[0].left.time).T_world_node;
  for (std::size_t node = 0; node < rest.size(); ++node) EXPECT_TRUE(rest[node].isApprox(start[node], 1e-9)) << node;
  for (const RunFrame& frame : run.frames()) {
    EXPECT_EQ(read_run_image(frame.left, run.lens_left()).size(), cv::Size(48, 36));
    EXPECT_EQ(read_run_image(*frame.right, *run.lens_right()).size(), cv::Size(48, 36));
  }
}

TEST_F(SynthRun, SameOptionsGiveTheSameBytes) {
  write_synth_run(folder_ / "a", tiny_);
  write_synth_run(folder_ / "b", tiny_);
  EXPECT_EQ(bytes_of(folder_ / "a"), bytes_of(folder_ / "b"));
  SynthOptions other = tiny_;
  other.seed = 2;
  write_synth_run(folder_ / "c", other);
  EXPECT_NE(bytes_of(folder_ / "a").at("rgb/000000.png"), bytes_of(folder_ / "c").at("rgb/000000.png"));
}

// Follows surface points from the first image to the last through what was written: lens, poses, meshes, node
// tracks. They must look the same there, and must not three pixels beside.
// What a webcam would do: a lab that is lit eight times too bright is hardly brighter in its images.
TEST_F(SynthRun, AutomaticExposureEvensOutTheLight) {
  SynthOptions options = tiny_;
  const auto mean = [&](const char* name) {
    write_synth_run(folder_ / name, options);
    const RunFolder run = RunFolder::open(folder_ / name, {});
    const cv::Scalar sum = cv::mean(read_run_image(run.frames()[1].left, run.lens_left()));
    return (sum[0] + sum[1] + sum[2]) / 3;
  };
  const double normal = mean("normal");
  options.sensor.exposure = 3;
  const double bright = mean("bright");
  EXPECT_GT(bright, normal + 40);
  options.auto_exposure.emplace();
  const double even = mean("even");
  EXPECT_LT(even, bright - 25);
  EXPECT_NEAR(even, 255 * options.auto_exposure->target, 15);
  EXPECT_EQ(mean("again"), even);
}

TEST_F(SynthRun, NothingMovesInAStillRun) {
  SynthOptions options = tiny_;
  options.frames = 20;
  options.still = true;
  write_synth_run(folder_ / "run", options);
  const RunFolder run = RunFolder::open(folder_ / "run", {});
  const auto first = run.state_at(run.frames().front().left.time), last = run.state_at(run.frames().back().left.time);
  for (std::size_t k = 0; k < first.T_world_node.size(); ++k)
    EXPECT_TRUE(first.T_world_node[k].isApprox(last.T_world_node[k], 1e-12)) << k;
  EXPECT_FALSE(run.frames().front().left.T_world_camera.isApprox(run.frames().back().left.T_world_camera, 1e-3));
}

TEST_F(SynthRun, ModelAndPicturesAgree) {
  SynthOptions options;
  options.width = 240;
  options.height = 180;
  options.frames = 8;
  options.rate = 15;
  write_synth_run(folder_ / "run", options);
  const RunFolder run = RunFolder::open(folder_ / "run", {});
  const RunImage &from = run.frames().front().left, &to = run.frames().back().left;
  const Lens& lens = run.lens_left();
  const World before(run, from.time), after(run, to.time);
  const cv::Mat seen = read_run_image(from, lens), later = read_run_image(to, lens);
  const auto moves = [&](int node) { return run.scene()->nodes()[node].name.starts_with("arm_"); };

  std::vector<double> differences, beside;
  int on_arm = 0;
  for (int y = 2; y < options.height; y += 3)
    for (int x = 2; x < options.width; x += 3) {
      const Eigen::Vector3d ray = from.T_world_camera.linear() * lens.unproject({x, y}).value();
      const auto hit = before.tracer->nearest(from.T_world_camera.translation().cast<float>(), ray.cast<float>());
      if (!hit) continue;
      const int node = before.node[hit->triangle];
      const Eigen::Vector3d p_before = from.T_world_camera.translation() + hit->t * ray;
      const Eigen::Vector3d p = after.state.T_world_node[node] * before.state.T_world_node[node].inverse() * p_before;
      const auto pixel = lens.project(to.T_world_camera.inverse() * p);
      if (!pixel || pixel->minCoeff() < 4 || pixel->x() > options.width - 5 || pixel->y() > options.height - 5)
        continue;
      const Eigen::Vector3d eye = to.T_world_camera.translation();
      if (after.tracer->blocked(eye.cast<float>(), (p - eye).cast<float>(), 0.995f)) continue;
      const auto compare = [&](double dx) {
        cv::Mat patch;
        cv::getRectSubPix(later, {1, 1},
                          cv::Point2f(static_cast<float>(pixel->x() + dx), static_cast<float>(pixel->y())), patch);
        return cv::norm(patch.at<cv::Vec3b>(0, 0), seen.at<cv::Vec3b>(y, x), cv::NORM_L1) / 3;
      };
      differences.push_back(compare(0));
      beside.push_back(compare(3));
      on_arm += moves(node);
    }
  ASSERT_GT(differences.size(), 2000u);
  EXPECT_GT(on_arm, 40);
  const auto share_above = [](const std::vector<double>& values, double level) {
    return static_cast<double>(std::count_if(values.begin(), values.end(), [&](double v) { return v > level; })) /
           static_cast<double>(values.size());
  };
  // Interpolating fine print costs some levels; a wrong place costs contrast.
  EXPECT_LT(share_above(differences, 16), 0.12);
  EXPECT_GT(share_above(beside, 16), 2 * share_above(differences, 16));
}

// The lamp stands in the table where its mirror image has to be seen from the eye, and nowhere else.
TEST_F(SynthRun, GlossMirrorsTheLampWhereTheEyeSeesIt) {
  const fs::path path = folder_ / "path.txt";
  std::ofstream(path) << "0 -0.45 0.1 0.5 -0.888232 0.438504 -0.060630 0.122811\n";
  SynthOptions options{.width = 160, .height = 120, .frames = 1, .distortion = false, .still = true, .head_path = path};
  write_synth_run(folder_ / "matt", options);
  options.gloss = 0.03;
  write_synth_run(folder_ / "glossy", options);
  const RunFolder run = RunFolder::open(folder_ / "matt", {}), glossy = RunFolder::open(folder_ / "glossy", {});
  const RunImage& image = run.frames().front().left;
  const Lens& lens = run.lens_left();
  const World world(run, image.time);
  const cv::Mat without = read_run_image(image, lens), with = read_run_image(glossy.frames().front().left, lens);
  const Eigen::Vector3f eye = image.T_world_camera.translation().cast<float>();
  int mirrored = 0, matt = 0;
  for (int y = 0; y < options.height; ++y)
    for (int x = 0; x < options.width; ++x) {
      const Eigen::Vector3f ray = (image.T_world_camera.linear() * lens.unproject({x, y}).value()).cast<float>();
      const auto hit = world.tracer->nearest(eye, ray);
      if (!hit) continue;
      const Eigen::Vector3f p = eye + static_cast<float>(hit->t) * ray;
      if (std::abs(p.z()) > 0.004f) continue;  // neither the table top nor what lies flat on it
      const float expected = lamp::mirrored(p, Eigen::Vector3f::UnitZ(), (eye - p).normalized());
      const int brighter = with.at<cv::Vec3b>(y, x)[1] - without.at<cv::Vec3b>(y, x)[1];
      mirrored += expected > 0.95f;
      matt += expected == 0;
      if (expected > 0.95f) {
        EXPECT_GT(brighter, 10) << x << ' ' << y;
      }
      if (expected == 0) {
        EXPECT_LE(brighter, 12) << x << ' ' << y;  // blur carries some of it beside
      }
    }
  EXPECT_GT(mirrored, 50);
  EXPECT_GT(matt, 500);
}

TEST_F(SynthRun, RefusesSizesAndCountsOutOfRange) {
  const auto refuses = [&](const SynthOptions& options, const char* text) {
    try {
      write_synth_run(folder_ / "run", options);
      ADD_FAILURE() << "accepted; expected " << text;
    } catch (const InputError& e) {
      EXPECT_THAT(e.what(), HasSubstr(text));
    }
    EXPECT_THAT(left_behind(), ::testing::IsEmpty());
  };
  refuses({.width = 15}, "--size: a width of 15 is outside 16 .. 8192");
  refuses({.height = 8193}, "--size: a height of 8193 is outside 16 .. 8192");
  refuses({.frames = 0}, "--frames: 0 is outside 1");
  refuses({.rate = 0}, "--rate: 0 is outside 0.1 .. 1000");
  refuses({.pose_error_px = std::nan("")}, "--pose-error-px: nan is outside 0 .. 100");
  refuses({.pose_error_s = -1}, "--pose-error-s: -1 is outside 0 .. 60");
  refuses({.sensor = {.vignetting = 1}}, "--vignetting: 1 is outside 0 .. 0.9");
  refuses({.shutter = {.exposure_s = -1}}, "--motion-blur: -1000 is outside 0 .. 1000");
}

TEST_F(SynthRun, KeepsTheFoldersOfOthersAndReplacesItsOwn) {
  fs::create_directory(folder_ / "photos");
  std::ofstream(folder_ / "photos" / "holiday.png") << "x";
  EXPECT_THROW(write_synth_run(folder_ / "photos", tiny_), InputError);
  EXPECT_TRUE(fs::exists(folder_ / "photos" / "holiday.png"));
  EXPECT_EQ(left_behind().size(), 1u);

  fs::create_directory(folder_ / "run");
  SynthOptions one = tiny_;
  write_synth_run(folder_ / "run", one);
  one.frames = 1;
  write_synth_run(folder_ / "run", one);
  EXPECT_FALSE(fs::exists(folder_ / "run" / "rgb" / "000001.png"));
  EXPECT_EQ(left_behind().size(), 2u);
}

// Who is asked to stop before has nothing to take back; after that he hears of it between blocks of pixels.
TEST_F(SynthRun, BeginsToWriteOnceTheLabIsLit) {
  int lighting = 0, drawing = 0;
  bool begun = false;
  write_synth_run(
      folder_ / "run", tiny_, [&](int, int) { ++(begun ? drawing : lighting); },
      [&] {
        begun = true;
        for (const fs::path& there : left_behind()) EXPECT_TRUE(fs::is_empty(there)) << there;
      });
  EXPECT_GT(lighting, 0);
  EXPECT_GE(drawing, 2 * tiny_.frames) << "when an image is done, and while it is drawn";
}

TEST_F(SynthRun, LeavesNothingWhenStopped) {
  EXPECT_THROW(write_synth_run(folder_ / "run", tiny_, [](int, int) { throw std::runtime_error("stop"); }),
               std::runtime_error);
  EXPECT_THAT(left_behind(), ::testing::IsEmpty());
}

}  // namespace
}  // namespace foresight::sim::synth_run_test
