// `foresight robot --view`: the live, textured scene, measured against what the mock cameras truly see.
#include <fstream>
#include <map>
#include <set>

#include "tests/apps/program.hpp"
#include "tests/apps/runs.hpp"
#include "tests/support/folders.hpp"

namespace foresight::live_view_test {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using testing::HasSubstr;
using testing::Not;

std::string config(const std::string& name) {
  return (source_folder() / "configs" / name).string();
}

std::string text_of(const std::string& file) {
  std::ifstream stream(file);
  return {std::istreambuf_iterator<char>(stream), {}};
}

/// Of a report: its own, and those of what its summary holds.
std::set<std::string> keys_of(const json& report) {
  std::set<std::string> keys;
  for (const auto& [key, value] : report.items()) keys.insert(key);
  for (const auto& [key, value] : report.at("summary").items()) keys.insert("summary." + key);
  return keys;
}

class LiveView : public testing::TestWithParam<const char*> {
 protected:
  std::string motion() const {
    return folder_
        .write("motion.csv",
               "time_s,elbow,shoulder_yaw,pan,tilt\n0,0.2,0,0,0.6\n1,0.6,0.3,0.15,0.5\n2,0.2,0,-0.1,0.6\n")
        .string();
  }
  Outcome view(const std::string& out, const std::vector<std::string>& more = {}) const {
    std::vector<std::string> words{"robot",
                                   small_rig(GetParam(), folder_),
                                   "--stepped",
                                   "--home",
                                   "--follow",
                                   motion(),
                                   "--view",
                                   "--out",
                                   folder_ / out,
                                   "--report",
                                   folder_ / (out + ".json")};
    words.insert(words.end(), more.begin(), more.end());
    return run_program(words);
  }
  TempFolder folder_;
};

TEST_P(LiveView, RepeatsBitForBitAndReplacesAnEarlierView) {
  const auto contents = [&] {
    std::map<std::string, std::string> all;
    for (const std::string& name : names_in(folder_ / "out/predicted"))
      all[name] = folder_.read("out/predicted/" + name);
    return all;
  };
  ASSERT_EQ(view("out", {"--delay-ms", "200"}).exit_code, 0);
  const auto first = contents();
  const json report = without_times(read_json(folder_ / "out.json"));
  EXPECT_GT(first.size(), 8u);
  folder_.write("out/predicted/999999.png", "of a longer session");
  ASSERT_EQ(view("out", {"--delay-ms", "200"}).exit_code, 0);
  EXPECT_TRUE(contents() == first);
  EXPECT_EQ(without_times(read_json(folder_ / "out.json")), report);
}

// Against what the mock cameras truly see, while arm and head move.
TEST_P(LiveView, ShowsThePresentFromThePastAndReportsAsReplayDoes) {
  ASSERT_EQ(view("out", {"--delay-ms", "400"}).exit_code, 0);
  const json report = read_json(folder_ / "out.json"), summary = report.at("summary");
  EXPECT_GT(summary.at("predicted").at("psnr_db").at("mean").get<double>(),
            summary.at("delayed").at("psnr_db").at("mean").get<double>() + 3)
      << summary.dump(1);
  EXPECT_GT(summary.at("coverage").at("seen").get<double>(), 0.5);

  const SmallRun run;
  ASSERT_EQ(run_program({"replay", run.path(), "--delay-ms", "40", "--report", folder_ / "replay.json"}).exit_code, 0);
  EXPECT_EQ(keys_of(report), keys_of(read_json(folder_ / "replay.json")));
}

INSTANTIATE_TEST_SUITE_P(Rigs, LiveView, testing::Values("minerva.yaml", "cia402.yaml"),
                         [](const auto& i) { return std::string(i.param).substr(0, std::string(i.param).find('.')); });

/// The lab's head as `calibrate pan-tilt` would find it, and the lab's tags: every pair is registered, as that of a
/// real rig would be.
TEST(LiveViewCalibrated, RegistersWhatItShows) {
  const TempFolder folder;
  folder.write(
      "head.yaml",
      "kind: pan-tilt\ndate: 2026-01-01T00:00:00Z\nscore: {name: loo_mrad, value: 0.5}\nresult:\n"
      "  T_world_pan: {xyz: [-0.82, 0.04, 0.48], quaternion: [0, 0, 0, 1]}\n"
      "  length_m: 0\n  twist_rad: -1.5707963267948966\n"
      "  T_tilt_camera: {xyz: [0.03, 0, 0.0325], quaternion: [0, 0.70710678118654752, 0, 0.70710678118654752]}\n"
      "  gain: [1, 1]\n  backlash_rad: [0, 0]\n");
  for (const char* name : {"arm.urdf", "lab_tags.txt"}) fs::copy_file(config(name), folder / name);
  std::string text = text_of(config("cia402.yaml"));
  for (auto at = text.find("rate_hz: 10"); at != std::string::npos; at = text.find("rate_hz: 10"))
    text.replace(at, 11, "rate_hz: 4");
  text += "calibration: {pan_tilt: head.yaml, tags: lab_tags.txt}\n";
  const std::string rig = folder.write("rig.yaml", text).string();
  const std::string motion =
      folder.write("motion.csv", "time_s,elbow,pan,tilt\n0,0.2,0,0.6\n1.5,0.6,0.15,0.5\n3,0.2,-0.1,0.6\n").string();
  const Outcome out = run_program({"robot", rig, "--stepped", "--follow", motion, "--view", "--delay-ms", "500",
                                   "--record", folder / "run", "--report", folder / "view.json"});
  ASSERT_EQ(out.exit_code, 0) << out.err;
  const json report = read_json(folder / "view.json");
  const json& summary = report.at("summary");
  EXPECT_GT(summary.at("predicted").at("psnr_db").at("mean").get<double>(),
            summary.at("delayed").at("psnr_db").at("mean").get<double>() + 3)
      << summary.dump(1);
  // Tags are in view most of the time, and the recording has the poses that were shown.
  const std::string registered = folder.read("run/registration.txt");
  const auto count = [&](const std::string& word) {
    std::size_t found = 0;
    for (auto at = registered.find(word); at != std::string::npos; at = registered.find(word, at + 1)) ++found;
    return found;
  };
  EXPECT_GT(count(" tags "), count(" encoders ") + count(" held ")) << registered;
}

TEST(LiveViewInput, WrongInputIsNamed) {
  const TempFolder folder;
  const std::string rig = config("cia402.yaml");
  const auto expect = [&](std::vector<std::string> more, const std::vector<std::string>& words) {
    more.insert(more.begin(), {"robot", rig, "--stepped"});
    const Outcome out = run_program(more);
    EXPECT_EQ(out.exit_code, 2) << out.err;
    for (const std::string& word : words) EXPECT_THAT(out.last_line(), HasSubstr(word));
  };
  expect({"--delay-ms", "100"}, {"--delay-ms", "--view"});
  expect({"--report", folder / "r.json"}, {"--report", "--view"});
  expect({"--view", "--no-cameras"}, {"--view", "--no-cameras"});
  expect({"--view", "--delay-ms", "-5"}, {"--delay-ms", "-5"});
  folder.write("mine/notes.txt", "mine");
  expect({"--view", "--out", folder / "mine"}, {"notes.txt", "new folder"});
  folder.write("theirs/predicted/notes.txt", "mine");
  expect({"--view", "--out", folder / "theirs"}, {"predicted", "new folder"});
  expect({"--view", "--record", folder / "run", "--out", folder / "run/view"}, {"--out", "--record"});
  expect({"--view", "--html", folder / "x", "--report", folder / "x"}, {"--html", "--report"});
  EXPECT_THAT(names_in(folder.path()), testing::ElementsAre("mine", "theirs"));
  EXPECT_EQ(folder.read("mine/notes.txt"), "mine");

  std::string text = text_of(rig);
  const auto from = text.find("\ncameras:"), to = text.find("\njoints:");
  ASSERT_NE(from, std::string::npos);
  text.erase(from, to - from);
  fs::copy_file(config("arm.urdf"), folder / "arm.urdf");
  const std::string blind = folder.write("rig.yaml", text).string();
  const Outcome out = run_program({"robot", blind, "--stepped", "--view", "--out", folder / "out"});
  EXPECT_EQ(out.exit_code, 2);
  EXPECT_THAT(out.last_line(), testing::AllOf(HasSubstr("--view"), HasSubstr("no cameras")));
  EXPECT_FALSE(fs::exists(folder / "out"));
}

}  // namespace
}  // namespace foresight::live_view_test
