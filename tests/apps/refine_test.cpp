// What `replay --refine` wins on poses that are wrong by a known number of pixels.
#include <fmt/core.h>

#include <fstream>
#include <opencv2/imgcodecs.hpp>

#include "scene/run_writer.hpp"
#include "sim/pan_tilt_head.hpp"
#include "sim/run_files.hpp"
#include "sim/tag_room.hpp"
#include "tests/apps/program.hpp"
#include "tests/apps/runs.hpp"

namespace foresight::refine_test {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using testing::HasSubstr;
using testing::Not;

struct Shown {
  double psnr_db = 0, sharpness = 0;
};

/// A head that turns before tags on table and wall. Given poses of the first images are off by one and the same turn.
class TagRun : public TempFolder {
 public:
  TagRun(int wrong_images, double wrong_px, double interval_s = 1 / 30.0) {
    const Lens lens({LensModel::plumb_bob, 480, 360, 390, 391, 238, 182, {-0.12, 0.03, 0.0004, -0.0006, 0}});
    const sim::TagRoom room(sim::TagRoom::lab_tags());
    const cv::Mat rays = sim::TagRoom::corner_rays(lens);
    const Pose off(Eigen::AngleAxisd(wrong_px / 390, Eigen::Vector3d::UnitY()));
    RunWriter run(path(), lens, "left");
    for (int i = 0; i < kImages; ++i) {
      const Pose T = sim::T_world_head_left({0.006 * i, 0.5});
      const RobotTime time = RobotTime{} + seconds(i * interval_s);
      const std::string file = RunWriter::image_name(false, static_cast<std::uint64_t>(i));
      run.write_image(file, room.picture(rays, T, 2, static_cast<unsigned>(i)));
      run.add_image(false, time, file);
      run.add_pose(time, i < wrong_images ? Pose(T * off) : T);
    }
    run.flush();
    write("scene.ply", kRoom);
    std::string tags;
    for (const auto& [id, corners] : room.corners())
      for (std::size_t c = 0; c < 4; ++c)
        tags += fmt::format("{} {} {:.9f} {:.9f} {:.9f}\n", id, c, corners[c].x(), corners[c].y(), corners[c].z());
    write("tags.txt", tags);
  }

  static constexpr int kImages = 8;

 private:
  static constexpr const char* kRoom = R"(ply
format ascii 1.0
element vertex 8
property float x
property float y
property float z
element face 4
property list uchar int vertex_indices
end_header
-2 -2 0
0.6 -2 0
0.6 2 0
-2 2 0
0.6 -2 0
0.6 -2 2
0.6 2 2
0.6 2 0
3 0 1 2
3 0 2 3
3 4 5 6
3 4 6 7
)";
};

class Refine : public testing::Test {
 protected:
  fs::path synth(const std::string& name, const std::vector<std::string>& more) const {
    const fs::path run = folder_ / name;
    std::vector<std::string> words{"synth", run, "--size", "240x180", "--pose-error-px", "2"};
    words.insert(words.end(), more.begin(), more.end());
    const Outcome outcome = run_program(words);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    return run;
  }

  /// Gives `run` its true poses.
  static void correct(const fs::path& run) {
    std::map<std::string, std::string> truth;
    const auto rows = [](const fs::path& file, const auto& use) {
      std::ifstream stream(file);
      for (std::string line; std::getline(stream, line);)
        if (!line.starts_with('#')) use(line.substr(0, line.find(' ')), line);
    };
    rows(run / "truth/trajectory.txt", [&](const std::string& time, const std::string& line) { truth[time] = line; });
    std::string poses;
    rows(run / "trajectory.txt", [&](const std::string& time, const std::string&) { poses += truth.at(time) + "\n"; });
    std::ofstream(run / "trajectory.txt") << poses;
  }

  Outcome replay(const fs::path& run, std::vector<std::string> more) const {
    std::vector<std::string> words{"replay", run, "--report", report_};
    words.insert(words.end(), more.begin(), more.end());
    return run_program(words);
  }

  Shown shown(const fs::path& run, const std::vector<std::string>& more) const {
    const Outcome outcome = replay(run, more);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    Shown mean;
    const json frames = read_json(report_)["frames"];
    for (const json& frame : frames) {
      mean.psnr_db += frame["predicted"]["psnr_db"].get<double>() / static_cast<double>(frames.size());
      mean.sharpness += frame["predicted"]["sharpness"].get<double>() / static_cast<double>(frames.size());
    }
    return mean;
  }

  TempFolder folder_;
  fs::path report_ = folder_ / "report.json";
};

TEST_F(Refine, WinsBackMostOfWhatWrongPosesLose) {
  const fs::path run = synth("run", {"--frames", "16", "--seed", "4"});
  for (const char* delay : {"0", "1"}) {
    SCOPED_TRACE(delay);
    const Shown given = shown(run, {"--delay-frames", delay}),
                refined = shown(run, {"--delay-frames", delay, "--refine"});
    const fs::path right = folder_ / (std::string("right") + delay);
    fs::copy(run, right, fs::copy_options::recursive);
    correct(right);
    const Shown exact = shown(right, {"--delay-frames", delay});
    EXPECT_GT(exact.psnr_db, given.psnr_db + 2);
    EXPECT_GT((refined.psnr_db - given.psnr_db) / (exact.psnr_db - given.psnr_db), 0.5);
    EXPECT_NEAR(refined.sharpness, exact.sharpness, 0.04);
  }
}

TEST_F(Refine, ErrorsThatLastAreBridgedOverLongDelays) {
  const fs::path run = synth("run", {"--frames", "16", "--seed", "4", "--pose-error-s", "3"});
  const Shown given = shown(run, {"--delay-frames", "3"}), refined = shown(run, {"--delay-frames", "3", "--refine"});
  EXPECT_GT(refined.psnr_db, given.psnr_db + 1);
}

TEST_F(Refine, GoesWithTwoCamerasAndByTheClockButNotWithTheThesis) {
  const fs::path run = synth("stereo", {"--stereo", "--frames", "5"});
  const Outcome stereo = replay(run, {"--refine"});
  EXPECT_EQ(stereo.exit_code, 0) << stereo.err;
  EXPECT_THAT(stereo.out, HasSubstr("Poses refined of"));
  EXPECT_GT(read_json(report_)["refinement"]["refined_images"], 0);
  EXPECT_EQ(replay(run, {"--refine", "--real-time"}).exit_code, 0);
  const Outcome refused = replay(run, {"--refine", "--pipeline", "thesis"});
  EXPECT_EQ(refused.exit_code, 2);
  EXPECT_THAT(refused.last_line(), HasSubstr("--pipeline core"));
}

TEST_F(Refine, RefinesByTheClockToo) {
  // Slow enough that only a stall of seconds leaves every image out; while shaders are compiled for the first time
  // there may be one.
  const TagRun run(0, 0, 0.5);
  int refined = 0;
  for (int attempt = 0; attempt < 3 && refined == 0; ++attempt) {
    const Outcome outcome = replay(run.path(), {"--refine", "--real-time"});
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    refined = read_json(report_)["refinement"]["refined_images"];
  }
  EXPECT_GT(refined, 0);
}

TEST_F(Refine, TagsVetoPosesThatFollowWrongTextures) {
  // Textures of the first images lie 6 px off, and the first images that are given right align to them.
  const TagRun run(4, 6);
  const Outcome vetoed = replay(run.path(), {"--refine"});
  ASSERT_EQ(vetoed.exit_code, 0) << vetoed.err;
  const json with = read_json(report_)["refinement"];
  EXPECT_GT(with["vetoed_images"], 0) << with;
  EXPECT_GT(with["images_with_tags"], 4) << with;
  EXPECT_THAT(vetoed.out, HasSubstr("vetoed " + with["vetoed_images"].dump() + " of these"));

  fs::remove(run / "tags.txt");
  const Outcome free = replay(run.path(), {"--refine"});
  EXPECT_THAT(free.out, Not(HasSubstr("Tags were seen")));
  const json without = read_json(report_)["refinement"];
  EXPECT_EQ(without["vetoed_images"], 0);
  EXPECT_EQ(without["images_with_tags"], 0);
  EXPECT_EQ(without["refined_images"], with["refined_images"].get<int>() + with["vetoed_images"].get<int>());
}

TEST_F(Refine, TagsDoNotVetoGoodPoses) {
  const TagRun run(0, 0);
  ASSERT_EQ(replay(run.path(), {"--refine"}).exit_code, 0);
  const json did = read_json(report_)["refinement"];
  EXPECT_GT(did["images_with_tags"], 4) << did;
  EXPECT_EQ(did["vetoed_images"], 0) << did;
  EXPECT_EQ(replay(run.path(), {}).exit_code, 0);
  EXPECT_FALSE(read_json(report_).contains("refinement"));

  run.write("tags.txt", "4 0 0 0 0\n4 1 1 0 0\n");
  const Outcome broken = replay(run.path(), {"--refine"});
  EXPECT_EQ(broken.exit_code, 2);
  EXPECT_THAT(broken.last_line(), HasSubstr("tag 4 has 2 corners"));
  EXPECT_EQ(run_program({"replay", run.path(), "--report", run / "tags.txt"}).exit_code, 2);
}

}  // namespace
}  // namespace foresight::refine_test
