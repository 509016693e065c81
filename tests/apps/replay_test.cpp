// What a replay leaves behind.
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <set>

#include "tests/apps/program.hpp"
#include "tests/apps/runs.hpp"

namespace foresight::replay_test {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using testing::HasSubstr;

class Replay : public testing::Test {
 protected:
  Outcome replay(const fs::path& run, const std::vector<std::string>& more) {
    std::vector<std::string> words{
        "replay", run, "--out", out_ / "out", "--report", out_ / "report.json", "--html", out_ / "report.html"};
    words.insert(words.end(), more.begin(), more.end());
    Outcome outcome = run_program(words);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    return outcome;
  }
  json report() const { return read_json(out_ / "report.json"); }
  cv::Mat picture(const std::string& name) const {
    return cv::imread(out_ / ("out/predicted/" + name), cv::IMREAD_UNCHANGED);
  }

  TempFolder out_;
};

/// RGBA of the camera's size with the four meanings of alpha, and the shares that the report claims.
void expect_view(const cv::Mat& view, const json& coverage) {
  ASSERT_EQ(view.type(), CV_8UC4);
  ASSERT_EQ(view.size(), cv::Size(96, 72));
  std::map<int, int> pixels{{255, 0}, {128, 0}, {64, 0}, {0, 0}};
  for (int y = 0; y < view.rows; ++y)
    for (int x = 0; x < view.cols; ++x) ++pixels[view.at<cv::Vec4b>(y, x)[3]];
  EXPECT_EQ(pixels.size(), 4u) << "alpha takes other values: " << testing::PrintToString(pixels);
  const double total = static_cast<double>(view.total());
  EXPECT_NEAR(coverage["seen"].get<double>(), pixels[255] / total, 1e-9);
  EXPECT_NEAR(coverage["filled"].get<double>(), pixels[128] / total, 1e-9);
  EXPECT_NEAR(coverage["empty"].get<double>(), (pixels[64] + pixels[0]) / total, 1e-9);
}

void expect_quality(const json& quality) {
  for (const char* name : {"psnr_db", "ssim", "sharpness"}) EXPECT_TRUE(quality.at(name).is_number()) << name;
}

TEST_F(Replay, WritesPicturesAndReports) {
  const SmallRun run;
  replay(run.path(), {"--delay-frames", "2"});
  EXPECT_THAT(names_in(out_.path()),
              testing::ElementsAre("out", "report.html", "report.html.plots.json", "report.json"));
  EXPECT_THAT(names_in(out_ / "out"), testing::ElementsAre("contact_sheet.png", "predicted"));
  EXPECT_THAT(names_in(out_ / "out/predicted"),
              testing::ElementsAre("000002.png", "000003.png", "000004.png", "000005.png", "000006.png", "000007.png"));
  EXPECT_FALSE(cv::imread(out_ / "out/contact_sheet.png").empty());

  const json all = report();
  EXPECT_EQ(all["complete"], true);
  EXPECT_EQ(all["run"]["cameras"], 1);
  ASSERT_EQ(all["frames"].size(), 6u);
  for (const json& frame : all["frames"]) {
    const std::string stem = frame["stem"];
    SCOPED_TRACE(stem);
    EXPECT_NEAR(frame["delay_s"].get<double>(), 2 / 30.0, 1e-6);
    expect_quality(frame["predicted"]);
    expect_quality(frame["delayed"]);
    expect_view(picture(stem + ".png"), frame["coverage"]);
    EXPECT_GT(frame["arrival_to_publish_ms"], 0);
    EXPECT_GT(frame["arrival_to_visible_ms"], 0);
    EXPECT_GT(frame["arrival_to_visible_cpu_ms"], 0);
    EXPECT_GE(frame["texels_written"], 0);
    EXPECT_GT(frame["texture_bytes_used"], 0);
    EXPECT_LE(frame["texture_bytes_used"], frame["texture_bytes_budget"]);
    EXPECT_GE(frame["stages"].size(), 5u);
    for (const json& stage : frame["stages"]) {
      EXPECT_TRUE(stage["cpu_ms"].is_number());
      EXPECT_TRUE(stage.contains("gpu_ms"));
    }
  }
  const json& summary = all["summary"];
  EXPECT_EQ(summary["frames"], 6);
  EXPECT_EQ(summary["dropped_frames"], 0);
  EXPECT_EQ(summary["dropped_images"], 0);
  for (const char* which : {"predicted", "delayed"})
    for (const char* name : {"psnr_db", "ssim", "sharpness"})
      EXPECT_TRUE(summary[which][name]["mean"].is_number()) << which << name;
  for (const char* name : {"seen", "filled", "empty"}) EXPECT_TRUE(summary["coverage"][name].is_number()) << name;
  EXPECT_GT(summary["arrival_to_publish_ms"]["median"], 0);
  EXPECT_GE(summary["arrival_to_publish_ms"]["p99"], summary["arrival_to_publish_ms"]["median"]);
  EXPECT_GT(summary["arrival_to_visible_cpu_ms"]["median"], 0);
  EXPECT_GT(summary["images_per_core_second"], 0);
  EXPECT_GT(summary["bytes_per_texel"], 0);
  EXPECT_GT(summary["coverage"]["seen"], 0.4);
  EXPECT_GT(summary["predicted"]["psnr_db"]["mean"], 24);

  const std::string html = out_.read("report.html");
  EXPECT_TRUE(html.starts_with("<!DOCTYPE html>") || html.starts_with("<!doctype html>"));
  EXPECT_THAT(html, HasSubstr("</html>"));
  EXPECT_THAT(html, HasSubstr("data:image/"));
  EXPECT_THAT(html, HasSubstr("<svg"));
  for (const char* outside : {"src=\"http", "href=\"http", "url(http", "<link"})
    EXPECT_THAT(html, testing::Not(HasSubstr(outside)));
}

TEST_F(Replay, IsBitIdenticalButForTimesAndOverwritesPictures) {
  const SmallRun run;
  const auto contents = [&] {
    std::map<std::string, std::string> all{{"sheet", out_.read("out/contact_sheet.png")}};
    for (const std::string& name : names_in(out_ / "out/predicted")) all[name] = out_.read("out/predicted/" + name);
    return all;
  };
  replay(run.path(), {"--delay-ms", "70"});
  const auto first = contents();
  const json first_report = without_times(report());
  EXPECT_EQ(first.size(), 1u + 5u);
  out_.write("out/predicted/000004.png", "an old picture");
  out_.write("out/contact_sheet.png", "");
  replay(run.path(), {"--delay-ms", "70"});
  EXPECT_TRUE(contents() == first);
  EXPECT_EQ(without_times(report()), first_report);

  out_.write("out/notes.txt", "mine");
  const Outcome refused = run_program({"replay", run.path(), "--delay-ms", "70", "--out", out_ / "out"});
  EXPECT_EQ(refused.exit_code, 2);
  EXPECT_THAT(refused.last_line(), HasSubstr("notes.txt"));
  EXPECT_EQ(out_.read("out/notes.txt"), "mine");
  EXPECT_TRUE(contents() == first);
}

TEST_F(Replay, ARunOfOneImageWithoutDelayShowsThatImage) {
  const SmallRun run;
  run.keep("rgb.txt", 1);
  const Outcome outcome = replay(run.path(), {});
  EXPECT_THAT(names_in(out_ / "out/predicted"), testing::ElementsAre("000000.png"));
  const json all = report();
  ASSERT_EQ(all["frames"].size(), 1u);
  EXPECT_EQ(all["frames"][0]["delay_s"], 0);
  EXPECT_GT(all["frames"][0]["predicted"]["psnr_db"], 26);
  EXPECT_THAT(outcome.out, HasSubstr("1 image time"));
}

TEST_F(Replay, ADelayOfZeroIsAllowedInBothUnits) {
  const SmallRun run;
  run.keep("rgb.txt", 3);
  replay(run.path(), {"--delay-frames", "0"});
  const json frames = without_times(report())["frames"];
  EXPECT_EQ(frames.size(), 3u);
  replay(run.path(), {"--delay-ms", "0"});
  EXPECT_EQ(without_times(report())["frames"], frames);
}

TEST_F(Replay, OptionsOfTheTexturesAreFollowed) {
  const SmallRun run;
  run.keep("rgb.txt", 3);
  replay(run.path(),
         {"--texels-per-metre", "150", "--max-texture", "64", "--texture-memory-mb", "16", "--margin-px", "0"});
  const json all = report();
  EXPECT_EQ(all["options"]["texels_per_metre"], 150);
  EXPECT_EQ(all["options"]["max_texture"], 64);
  EXPECT_EQ(all["options"]["margin_px"], 0);
  EXPECT_EQ(all["summary"]["texture_bytes_budget"], 16 << 20);
  EXPECT_LE(all["summary"]["texture_bytes_max"], 16 << 20);
  const json texels = all["run"]["texels"];
  replay(run.path(), {"--texels-per-metre", "600"});
  EXPECT_GT(report()["run"]["texels"], texels);
}

TEST_F(Replay, FullExtractionWritesMore) {
  const SmallRun run;
  run.keep("rgb.txt", 5);
  replay(run.path(), {});
  const json needed = report();
  replay(run.path(), {"--full-extraction"});
  const json full = report();
  EXPECT_EQ(needed["options"]["full_extraction"], false);
  EXPECT_EQ(full["options"]["full_extraction"], true);
  EXPECT_LT(needed["summary"]["texels_written"]["mean"], full["summary"]["texels_written"]["mean"]);
}

TEST_F(Replay, TwoCamerasSeeMoreThanOne) {
  const SmallRun stereo("--stereo");
  stereo.keep("rgb.txt", 3);
  replay(stereo.path(), {});
  const json both = report();
  EXPECT_EQ(both["run"]["cameras"], 2);
  for (const char* name : {"camera_right.yaml", "rgb_right.txt"}) fs::remove(stereo / name);
  replay(stereo.path(), {});
  EXPECT_EQ(report()["run"]["cameras"], 1);
  const auto coloured = [](const json& all) { return all["summary"]["coverage"]["seen"].get<double>(); };
  EXPECT_GT(coloured(both), coloured(report()));
}

TEST_F(Replay, GreyImagesGiveGreyViews) {
  const SmallRun run;
  run.keep("rgb.txt", 3);
  run.change_images([](const cv::Mat& colour) {
    cv::Mat grey;
    cv::cvtColor(colour, grey, cv::COLOR_BGR2GRAY);
    return grey;
  });
  replay(run.path(), {"--delay-frames", "1"});
  EXPECT_GT(report()["summary"]["predicted"]["psnr_db"]["mean"], 24);
  const cv::Mat view = picture("000002.png");
  int most = 0;
  for (int y = 0; y < view.rows; ++y)
    for (int x = 0; x < view.cols; ++x) {
      const auto& p = view.at<cv::Vec4b>(y, x);
      if (p[3] >= 128) most = std::max({most, std::abs(p[0] - p[1]), std::abs(p[1] - p[2])});
    }
  EXPECT_LE(most, 2);
}

TEST_F(Replay, AFisheyeOf150DegreesWorks) {
  const SmallRun run("--fisheye");
  run.keep("rgb.txt", 4);
  replay(run.path(), {"--delay-frames", "1"});
  const json all = report();
  EXPECT_EQ(all["run"]["lens_model"], "equidistant");
  EXPECT_GT(all["frames"][2]["coverage"]["seen"], 0.3);
  EXPECT_GT(all["frames"][2]["predicted"]["psnr_db"], 22);
  expect_view(picture("000003.png"), all["frames"][2]["coverage"]);
}

TEST_F(Replay, AnotherModelCanBeChosen) {
  const SmallRun run;
  const TempFolder models;
  run.keep("rgb.txt", 2);
  fs::remove(run / "nodes.txt");
  models.write(
      "wall.ply",
      "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\nelement face 2\n"
      "property list uchar int vertex_indices\nend_header\n-9 -9 -1\n9 -9 -1\n9 9 -1\n-9 9 -1\n3 0 1 2\n4 0 2 3 3\n");
  replay(run.path(), {"--scene", models / "wall.ply"});
  const json all = report();
  EXPECT_EQ(all["run"]["scene_triangles"], 2);
  EXPECT_EQ(all["run"]["degenerate_triangles"], 1);
}

TEST_F(Replay, CtrlCLeavesFinishedFramesAndValidReports) {
  const LoopedRun run(600, 1 / 30.0);
  Program program({"replay", run.path(), "--delay-frames", "1", "--out", out_ / "out", "--report", out_ / "report.json",
                   "--html", out_ / "report.html"});
  while (program.running() && names_in(out_ / "out/predicted").size() < 4) usleep(5000);
  program.interrupt();
  const Outcome outcome = program.wait();
  EXPECT_EQ(outcome.exit_code, 130) << outcome.err;
  const json all = report();
  EXPECT_EQ(all["complete"], false);
  std::vector<std::string> reported;
  for (const json& frame : all["frames"]) reported.push_back(frame["stem"].get<std::string>() + ".png");
  EXPECT_GE(reported.size(), 4u);
  EXPECT_LT(reported.size(), 599u);
  EXPECT_EQ(names_in(out_ / "out/predicted"), reported);
  for (const std::string& name : reported) EXPECT_EQ(picture(name).size(), cv::Size(96, 72));
  EXPECT_FALSE(cv::imread(out_ / "out/contact_sheet.png").empty());
  EXPECT_THAT(out_.read("report.html"), HasSubstr("</html>"));
}

}  // namespace
}  // namespace foresight::replay_test
