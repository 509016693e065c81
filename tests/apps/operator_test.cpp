// `foresight operator`: a program at the seat, both sides in stepped time; and the seat started wrong.
#include <cstdlib>

#include "tests/apps/program.hpp"
#include "tests/apps/runs.hpp"
#include "tests/link/child.hpp"
#include "tests/support/folders.hpp"

namespace foresight::operator_test {
namespace {

std::string rig_file(int rate_hz = 10) {
  static const TempFolder folder;
  return small_rig("minerva.yaml", folder, "160, 120", rate_hz);
}

// What is shown is what the camera will see, not what it saw.
TEST(Operator, ATourIsShownAsItWillBe) {
  const TempFolder folder;
  const auto report = folder.path() / "report.json", out = folder.path() / "out";
  const Outcome result = run_program({"operator", rig_file(), "--scripted", "tour", "--delay-ms", "300", "--seconds",
                                      "4", "--pictures-hz", "2", "--no-zero-delay", "--report", report, "--out", out});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const nlohmann::json all = read_json(report);
  EXPECT_TRUE(all["succeeded"]);
  EXPECT_GT(all["predicted_db"].get<double>(), all["delayed_db"].get<double>() + 6);
  EXPECT_GT(all["moving_predicted_db"].get<double>(), all["moving_delayed_db"].get<double>() + 6);
  EXPECT_LT(all["joints_p95"].get<double>(), 0.01);
  EXPECT_NEAR(all["acts_after_ms"].get<double>(), 310, 15);
  EXPECT_EQ(all["invalid_share"].get<double>(), 0);
  const double exact = all["exact_share"], exact_wrong = all["exact_wrong"], wrong = all["wrong_share"];
  EXPECT_GT(exact, 0.6);
  EXPECT_LT(exact_wrong, 0.03);
  EXPECT_GT((wrong - exact * exact_wrong) / (1 - exact), 3 * exact_wrong) << "else the marks say nothing";
  EXPECT_EQ(all["fallback_share"].get<double>(), 0);
  const auto shown = names_in(out / "shown");
  EXPECT_GE(shown.size(), 5u);
  EXPECT_EQ(names_in(out / "true"), shown);
  EXPECT_EQ(names_in(out / "delayed"), shown);
}

// What is shown is not good enough for an operator who asks for this much: the newest image takes its place.
TEST(Operator, ThatTheViewIsPoorIsNoticedAsImagesCome) {
  const TempFolder folder;
  const auto report = folder.path() / "report.json";
  const Outcome result =
      run_program({"operator", rig_file(), "--scripted", "tour", "--delay-ms", "100", "--seconds", "2", "--pictures-hz",
                   "10", "--no-zero-delay", "--fidelity-db", "58", "--report", report});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_GT(read_json(report)["fallback_share"].get<double>(), 0.7);
}

// Over a line of 300 ms each way, by a program that knows what comes over it and the model, and nothing else.
TEST(Operator, ABrickIsPickedUpAndPutIntoTheTray) {
  const TempFolder folder;
  const auto report = folder.path() / "report.json";
  const Outcome result = run_program({"operator", rig_file(5), "--scripted", "pick", "--delay-ms", "300",
                                      "--pictures-hz", "0.5", "--no-zero-delay", "--report", report});
  ASSERT_EQ(result.exit_code, 0) << result.err << result.out;
  const nlohmann::json all = read_json(report);
  EXPECT_TRUE(all["succeeded"]);
  EXPECT_GT(all["predicted_db"].get<double>(), all["delayed_db"].get<double>() + 6);
}

// Whatever becomes of the headset, the seat goes on, and says how it is.
TEST(Operator, TheSeatOutlivesItsHeadset) {
  if (!std::getenv("DISPLAY")) GTEST_SKIP() << "no DISPLAY; scripts/test gives one";
  const auto sit = [](const std::string& runtime, const std::string& script, const std::vector<std::string>& words,
                      const std::string& second_eye = "own") {
    Program seat({"operator", rig_file(), "--mock", "--head-display", "openxr", "--second-eye", second_eye},
                 {.environment = {{"XR_RUNTIME_JSON", runtime}, {"FORESIGHT_TEST_XR", script}}});
    const auto said_all = [&] {  // in that order
      const std::string said = seat.said();
      std::size_t from = 0;
      for (const std::string& word : words) {
        from = said.find(word, from);
        if (from == std::string::npos) return false;
      }
      return true;
    };
    EXPECT_TRUE(comes_true([&] { return said_all() || !seat.running(); }) && said_all()) << seat.said();
    seat.interrupt();
    const Outcome outcome = seat.wait();
    EXPECT_EQ(outcome.exit_code, 130) << outcome.err;
  };
  sit(FORESIGHT_TEST_RUNTIME, "real-time lose-session@60", {"the headset was lost", "simulated headset"});
  sit(FORESIGHT_TEST_RUNTIME, "real-time no-egl", {"simulated headset, 90 Hz"}, "first");
  sit(FORESIGHT_TEST_RUNTIME, "no-opengl", {"does not know OpenGL"});
  sit("/nowhere/runtime.json", "", {"no OpenXR runtime"});
}

TEST(Operator, WithoutADesktopItSaysWhatGoesWithoutOne) {
  const Outcome result = run_program({"operator", rig_file(), "--mock", "--head-display", "side-by-side"},
                                     {.environment = {{"DISPLAY", ""}, {"WAYLAND_DISPLAY", ""}}});
  EXPECT_EQ(result.exit_code, 1) << result.err;
  EXPECT_THAT(result.err, testing::HasSubstr("check DISPLAY"));
  EXPECT_THAT(result.err, testing::HasSubstr("`--scripted` operates without a window"));
  EXPECT_THAT(result.err, testing::Not(testing::HasSubstr("--window"))) << "it has no such option";
}

TEST(Operator, StartedWrongItSaysWhatToDo) {
  const auto said = [](std::vector<std::string> words) {
    words.insert(words.begin(), {"operator", rig_file()});
    const Outcome result = run_program(words);
    EXPECT_EQ(result.exit_code, 2) << result.err;
    return result.err;
  };
  EXPECT_THAT(said({"--delay-ms", "100"}), testing::HasSubstr("belongs to --scripted"));
  EXPECT_THAT(said({"--pictures-hz", "3"}), testing::HasSubstr("--pictures-hz: belongs to --scripted"));
  EXPECT_THAT(said({"--seed", "3"}), testing::HasSubstr("belongs to --scripted"));
  EXPECT_THAT(said({"--scripted", "tour", "--no-sounds"}), testing::HasSubstr("is of a seat with a window"));
  EXPECT_THAT(said({"--scripted", "tour", "--scene", rig_file()}), testing::HasSubstr("add --served"));
  EXPECT_THAT(run_program({"operator", "192.168.1.20"}).err, testing::HasSubstr("`link: peers:`"));
  EXPECT_THAT(said({"--line", "/no/such/line.yaml"}), testing::HasSubstr("line.yaml"));
  EXPECT_THAT(said({"--scripted", "dance"}), testing::HasSubstr("tour"));
  EXPECT_THAT(said({"--head-display", "goggles"}), testing::HasSubstr("side-by-side"));
  EXPECT_THAT(said({"--second-eye", "first"}), testing::HasSubstr("add --head-display openxr"));
  EXPECT_THAT(said({"--name", ""}), testing::HasSubstr("--name: is empty"));
  EXPECT_THAT(said({"--head-display"}), testing::HasSubstr("its value is missing; give one of openxr, side-by-side"));
  EXPECT_THAT(said({"--head-display", "openxr", "--display-lens", rig_file()}),
              testing::HasSubstr("add --head-display side-by-side"));
  EXPECT_THAT(said({"--head-display", "side-by-side", "--display-lens", rig_file()}),
              testing::HasSubstr("no result of a calibration; give a file of `foresight calibrate`"));
  EXPECT_THAT(said({"--scripted", "tour", "--coding", "mpeg"}), testing::HasSubstr("h264"));
  EXPECT_THAT(said({"--scripted", "tour", "--served", "--coding", "h264"}), testing::HasSubstr("--coding"));
  EXPECT_THAT(said({"--scripted", "tour", "--head-display", "openxr"}), testing::HasSubstr("--head-display"));
  EXPECT_THAT(said({"--scripted", "tour", "--delay-ms", "nan"}), testing::HasSubstr("--delay-ms"));
}

}  // namespace
}  // namespace foresight::operator_test
