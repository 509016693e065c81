// What an export leaves behind: a file that another library reads, and that looks like the run.
#include <sys/mount.h>

#include <cerrno>
#include <cstring>
#include <opencv2/imgcodecs.hpp>
#include <thread>

#include "scene/run_folder.hpp"
#include "tests/apps/exported_model.hpp"
#include "tests/apps/program.hpp"
#include "tests/apps/runs.hpp"

namespace foresight::export_test {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

class Export : public testing::Test {
 protected:
  Outcome run(const std::vector<std::string>& words) const {
    Outcome outcome = run_program(words);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    return outcome;
  }
  TempFolder out_;
};

void expect_scene(const ExportedModel& model, const RunFolder& run, std::size_t frame) {
  const SceneModel& scene = *run.scene();
  const SceneState state = run.state_at(run.frames()[frame].left.time);
  EXPECT_EQ(model.T_world_node.size(), scene.nodes().size());
  EXPECT_EQ(model.triangles.size(), scene.triangle_count());
  EXPECT_TRUE(model.unlit);
  EXPECT_TRUE(model.two_sided);
  for (std::size_t n = 0; n < scene.nodes().size(); ++n) {
    const std::string& name = scene.nodes()[n].name;
    SCOPED_TRACE(name);
    ASSERT_TRUE(model.T_world_node.count(name));
    EXPECT_LT((model.T_world_node.at(name).matrix() - state.T_world_node[n].matrix()).cwiseAbs().maxCoeff(), 2e-6);
    EXPECT_EQ(model.triangles_of_node.at(name), scene.nodes()[n].mesh.triangles.size());
  }
}

/// Whether a surface ends within a pixel of it: what lies there and around it is on no plane, by more than 2 cm. Views
/// mix these pixels (SilhouettePass), the picture does not.
bool is_at_silhouette(const cv::Mat& inverse_z, int x, int y) {
  const double here = inverse_z.at<double>(y, x);
  const cv::Rect all(0, 0, inverse_z.cols, inverse_z.rows);
  for (const cv::Point way : {cv::Point(1, 0), {0, 1}, {1, 1}, {1, -1}}) {
    const cv::Point one = cv::Point(x, y) + way, other = cv::Point(x, y) - way;
    if (!all.contains(one) || !all.contains(other)) continue;
    if (std::abs(inverse_z.at<double>(one) + inverse_z.at<double>(other) - 2 * here) > 0.02 * here * here) return true;
  }
  return false;
}

/// Over the pixels where `view` shows any colour.
struct Similarity {
  double psnr_db = 0;
  double alike = 0;  ///< share of those that are at no silhouette which differ by at most 10 of 255
  int pixels = 0;
  int compared = 0;  ///< at no silhouette
};
Similarity compare(const ExportedModel::Picture& picture, const cv::Mat& view) {
  double sum = 0, alike = 0;
  Similarity out;
  for (int y = 0; y < view.rows; ++y)
    for (int x = 0; x < view.cols; ++x) {
      const cv::Vec4b expected = view.at<cv::Vec4b>(y, x);
      if (expected[3] < 128) continue;
      ++out.pixels;
      int worst = 0;
      for (int c = 0; c < 3; ++c) {
        const int difference = std::abs(picture.bgr.at<cv::Vec3b>(y, x)[c] - expected[c]);
        worst = std::max(worst, difference);
        sum += difference * difference;
      }
      if (is_at_silhouette(picture.inverse_z, x, y)) continue;
      ++out.compared;
      alike += worst <= 10;
    }
  out.psnr_db = 10 * std::log10(255 * 255 * 3 * out.pixels / sum);
  out.alike = alike / out.compared;
  return out;
}

TEST_F(Export, LooksLikeThePredictedView) {
  const SmallRun sample;
  const RunFolder folder = RunFolder::open(sample.path(), {});
  run({"replay", sample.path(), "--no-projection", "--out", out_ / "replay"});
  for (const std::size_t frame : {std::size_t{7}, std::size_t{3}}) {
    const std::string file = out_ / ("model" + std::to_string(frame) + (frame == 7 ? ".glb" : ".gltf"));
    std::vector<std::string> words{"export", sample.path(), "--out", file};
    if (frame != 7) words.insert(words.end(), {"--until-frame", std::to_string(frame)});
    run(words);
    const ExportedModel model(file);
    expect_scene(model, folder, frame);
    const RunImage& image = folder.frames()[frame].left;
    const cv::Mat view = cv::imread(out_ / ("replay/predicted/" + image.stem + ".png"), cv::IMREAD_UNCHANGED);
    const Similarity likeness = compare(model.picture(folder.lens_left(), image.T_world_camera), view);
    RecordProperty("psnr_db_" + std::to_string(frame), std::to_string(likeness.psnr_db));
    // The view's triangle comes from a rasterised face, up to 0.7 px beside the ray: silhouettes differ,
    // and at 96 x 72 many pixels lie on one. What is smaller than a pixel is filtered there, not here.
    EXPECT_GT(likeness.psnr_db, 30) << "frame " << frame;

    EXPECT_GT(likeness.alike, 0.93) << "frame " << frame;
    EXPECT_GT(likeness.pixels, 0.95 * static_cast<double>(view.total()));
    EXPECT_GT(likeness.compared, 0.7 * static_cast<double>(view.total()));
  }
}

TEST_F(Export, IsTheSameEveryTime) {
  const SmallRun sample;
  for (const char* name : {"a.glb", "b.glb"}) run({"export", sample.path(), "--out", out_ / name});
  EXPECT_EQ(out_.read("a.glb"), out_.read("b.glb"));
}

TEST_F(Export, MakesFoldersAndFitsTheAtlas) {
  const SmallRun sample;
  const Outcome outcome = run({"export", sample.path(), "--out", out_ / "a/b/model.GLTF", "--max-atlas", "300"});
  EXPECT_THAT(names_in(out_ / "a/b"), testing::ElementsAre("model.GLTF", "model.bin", "model.png"));
  EXPECT_THAT(outcome.out, HasSubstr("--max-atlas"));
  const cv::Mat atlas = cv::imread(out_ / "a/b/model.png");
  EXPECT_LE(std::max(atlas.cols, atlas.rows), 300);
}

TEST_F(Export, WrongInputEndsWithCode2AndNoOutput) {
  const SmallRun sample;
  const TempFolder places;
  places.write("file", "kept");
  fs::create_directories(places / "folder.glb");
  const std::string good = out_ / "model.glb";
  const std::vector<std::array<std::string, 6>> all = {
      // run, --out, one more option and its value; where, what
      {sample.path(), out_ / "model.obj", "", "", "model.obj", "'.obj' is not a form"},
      {sample.path(), out_ / "model", "", "", "--out", "has no extension"},
      {sample.path(), places / "file/model.glb", "", "", "--out", "cannot be written to"},
      {sample.path(), "/proc/foresight/model.gltf", "", "", "--out", "cannot be written to"},
      {sample.path(), places / "folder.glb", "", "", "--out", "this is a folder"},
      {sample.path(), sample / "rgb/000001.gltf", "", "", "--out", "would overwrite"},
      {sample.path(), good, "--until-frame", "8", "--until-frame 8", "only 8 images"},
      {sample.path(), good, "--until-frame", "-1", "--until-frame", "'-1' is not a number"},
      {sample.path(), good, "--max-atlas", "63", "--max-atlas", "'63' is not a number"},
      {sample.path(), good, "--max-atlas", "64", "--max-atlas 64", "do not fit"},
      {sample.path(), good, "--texture-memory-mb", "0", "--texture-memory-mb", "'0' is not a number"},
      {out_ / "nowhere", good, "", "", "nowhere", "no such folder"},
  };
  for (const auto& [run, out, option, value, where, what] : all) {
    SCOPED_TRACE(out + " " + option + " " + value);
    std::vector<std::string> words{"export", run, "--out", out};
    if (!option.empty()) words.insert(words.end(), {option, value});
    const Outcome outcome = run_program(words);
    EXPECT_EQ(outcome.exit_code, 2) << outcome.out;
    EXPECT_THAT(outcome.last_line(), says(where, what, ""));
    EXPECT_TRUE(fs::is_empty(out_.path()));
  }
  EXPECT_EQ(places.read("file"), "kept");
}

TEST_F(Export, AFullDiskLeavesTheOldFiles) {
  const std::string kOld = R"({"asset":{"generator":"Foresight"}})";
  const SmallRun sample;
  const fs::path disk = out_ / "disk";
  fs::create_directory(disk);
  if (::mount("foresight", disk.c_str(), "tmpfs", 0, "size=24k") != 0)
    GTEST_SKIP() << "no right to mount a small disk: " << std::strerror(errno);
  const std::string old = out_.write("disk/model.gltf", kOld);
  const Outcome three = run_program({"export", sample.path(), "--out", old});
  const Outcome one = run_program({"export", sample.path(), "--out", disk / "model.glb"});
  const auto left = names_in(disk);
  const std::string content = out_.read("disk/model.gltf");
  ::umount(disk.c_str());
  for (const Outcome& outcome : {three, one}) {
    EXPECT_EQ(outcome.exit_code, 1);
    EXPECT_THAT(outcome.last_line(), says("disk/model.", "No space left", "free some disk space"));
  }
  EXPECT_THAT(left, testing::ElementsAre("model.gltf"));
  EXPECT_EQ(content, kOld);
}

TEST_F(Export, CtrlCLeavesNothing) {
  const LoopedRun run(2000, 0.1);  // longer than the wait on any machine
  Program program({"export", run.path(), "--out", out_ / "model.glb"});
  std::this_thread::sleep_for(std::chrono::milliseconds(1500));
  program.interrupt();
  const Outcome outcome = program.wait();
  EXPECT_EQ(outcome.exit_code, 130);
  EXPECT_TRUE(fs::is_empty(out_.path()));
}

}  // namespace
}  // namespace foresight::export_test
