// `foresight bench extraction` and `bench margin` on a small run: their numbers agree with each other
// and mean what they say.
#include "tests/apps/program.hpp"
#include "tests/apps/runs.hpp"

namespace foresight::bench_test {
namespace {

class Bench : public testing::Test {
 protected:
  /// A small run with truth, made once.
  static const std::string& run() {
    static const TempFolder folder;
    static const std::string path = [] {
      const std::string out = folder / "run";
      const Outcome outcome =
          run_program({"synth", out, "--frames", "12", "--size", "240x180", "--rate", "10", "--no-distortion"});
      if (outcome.exit_code != 0) throw std::runtime_error("no synthetic run: " + outcome.err);
      return out;
    }();
    return path;
  }
  TempFolder out_;
};

TEST_F(Bench, ExtractionComparesBothPipelines) {
  const std::string file = out_ / "bench.json";
  const Outcome outcome = run_program({"bench", "extraction", run(), "--no-tables", "--json", file});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const nlohmann::json all = read_json(file);
  const double core = all["images_per_core_second"], thesis = all["thesis_images_per_core_second"];
  EXPECT_GT(core, 0);
  EXPECT_NEAR(all["speedup_over_thesis"], core / thesis, 1e-6 * core / thesis);
  EXPECT_NEAR(all["core_cpu_ms"]["mean"], 1000 / core, 1e-6 * 1000 / core);
  EXPECT_EQ(all["images"], 12);
  EXPECT_GT(all["polygons_per_image"], 20);
  EXPECT_GT(all["texels_per_image"], 1000);
  EXPECT_GT(all["core_needed_cpu_ms"]["mean"], 0);
  EXPECT_GT(all["core_needed_no_shadows_cpu_ms"]["mean"], 0);
  EXPECT_LT(all["texels_needed_per_image"], all["texels_per_image"]);
}

TEST_F(Bench, ViewIsDrawnInBothWays) {
  const std::string file = out_ / "view.json";
  const Outcome outcome = run_program({"bench", "view", run(), "--images", "6", "--rounds", "1", "--json", file});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const nlohmann::json all = read_json(file);
  for (const char* way : {"single", "two", "newest"}) EXPECT_GT(all[way]["cpu_ms"], 0) << way;
  EXPECT_NEAR(all["two"]["psnr_db"], all["single"]["psnr_db"], 0.01);
  EXPECT_GT(all["newest"]["psnr_db"], 20);
}

TEST_F(Bench, ShadowGoesOnceTheLampIsKnown) {
  const std::string file = out_ / "shadow.json";
  const Outcome outcome = run_program({"bench", "shadow", run(), "--delay-ms", "100", "--json", file});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const nlohmann::json row = read_json(file)["runs"][0];
  EXPECT_GT(row["pixels"], 0) << "the arm throws a shadow";
  EXPECT_GT(row["views_with_lamp"], 0);
  EXPECT_GT(row["error_gone"], 0.2);
  EXPECT_LT(row["lamp"]["off_m"], 0.4);
}

TEST_F(Bench, ShadowSaysWhereItCannotTellTheLamp) {
  const std::string short_run = out_ / "short", file = out_ / "shadow.json";
  ASSERT_EQ(run_program({"synth", short_run, "--frames", "4", "--size", "240x180", "--rate", "10", "--no-distortion"})
                .exit_code,
            0);
  const Outcome outcome = run_program({"bench", "shadow", short_run, "--delay-ms", "100", "--json", file});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const nlohmann::json row = read_json(file)["runs"][0];
  EXPECT_GT(row["pixels"], 0) << "the arm throws a shadow";
  EXPECT_EQ(row["views_with_lamp"], 0) << "no search has ended by then";
  EXPECT_EQ(row["error_gone"], nullptr);
}

TEST_F(Bench, MarginCountsByTruth) {
  const std::string json = out_ / "margin.json", plot = out_ / "margin.svg";
  const Outcome outcome = run_program({"bench", "margin", run(), "--images", "1", "--json", json, "--plot", plot});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const nlohmann::json rows = read_json(json)["errors"];
  ASSERT_EQ(rows.size(), 5u);
  const nlohmann::json exact = rows[0], off = rows[4];
  EXPECT_GT(exact["core"]["right"], 1e5) << "of 2 mm x 2 mm";
  EXPECT_LT(exact["core"]["wrong"], 1e-3 * exact["core"]["right"].get<double>());
  EXPECT_EQ(exact["core"]["arm_on_still_nodes"], 0) << "the arm is never painted on what stands still";
  EXPECT_GT(off["core"]["wrong"], exact["core"]["wrong"]) << "an error of 3 px must show";
  for (const nlohmann::json& row : rows) {
    EXPECT_LT(row["core"]["wrong"], 0.7 * row["core_without_margin"]["wrong"].get<double>()) << row;
    EXPECT_LT(row["core"]["wrong"], row["thesis"]["wrong"]) << row;
  }
  EXPECT_TRUE(std::filesystem::file_size(plot) > 1000);
  const nlohmann::json plots = read_json(plot + ".plots.json")["plots"];
  ASSERT_EQ(plots.size(), 2u);
  ASSERT_EQ(plots[0]["series"].size(), 4u);
  EXPECT_EQ(plots[0]["series"][1]["y"][4].get<double>(), off["core"]["wrong"].get<double>() / 1e3);
}

TEST_F(Bench, HeadWarpsWhatItDrew) {
  const std::string file = out_ / "head.json";
  const Outcome outcome = run_program(
      {"bench", "head",
       run(),   "--views",
       "3",     "--width",
       "160",   "--height",
       "120",   "--seconds",
       "0.5",   "--building",
       "2000",  "--building-views",
       "5",     "--head-frames",
       "6",     "--openxr-frames",
       "90",    "--json",
       file},
      {.environment = {{"XR_RUNTIME_JSON", FORESIGHT_TEST_RUNTIME}, {"FORESIGHT_TEST_XR", "lose-session@40"}}});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const nlohmann::json all = read_json(file);
  for (const char* row :
       {"head_pose_to_swap", "warped_against_rendered", "recorded_head_motion", "viewport_independent_rendering",
        "portals", "state_sorting_buffer", "stereograms", "openxr_session"})
    EXPECT_FALSE(all[row].is_null()) << row;
  for (const char* which : {"motion", "second_eye", "through_panel_lens"}) {
    const nlohmann::json& row = all["warped_against_rendered"][which];
    EXPECT_GT(row["db"]["worst"], 20) << which;
    EXPECT_GE(row["db"]["median"], row["db"]["worst"]) << which;
    EXPECT_LT(row["holes"]["most"], 0.1) << which;
    EXPECT_GT(row["warped_cpu_ms"], 0) << which;
    EXPECT_GT(row["drawn_cpu_ms"], 0) << which;
  }
  const nlohmann::json& headset = all["openxr_session"];
  EXPECT_EQ(headset["runtime"], "test runtime 0.1.0");
  EXPECT_GE(headset["frames_with_eyes"], 60) << headset;
  EXPECT_GE(headset["losses"], 1) << headset;
  EXPECT_EQ(headset["frames_without_pose"], 0) << headset;
  EXPECT_GT(headset["start_to_first_frame_s"], 0) << headset;
  EXPECT_EQ(all["portals"]["different_pixels"], 0);
  EXPECT_LE(all["portals"]["portals"]["triangles"], all["portals"]["frustum"]["triangles"]);
  for (const char* scene : {"building", "workshop"}) {
    const nlohmann::json& levels = all["time_critical_rendering"][scene];
    ASSERT_EQ(levels["budgets"].size(), 10u) << "four budgets, two rules; one without hysteresis, too";
    for (const nlohmann::json& row : levels["budgets"]) EXPECT_GE(row["within_budget"], 0) << row;
    EXPECT_LE(levels["by_size"]["triangles"], levels["triangles"]);
    EXPECT_GE(levels["transitions"]["hard"]["largest_jump"], levels["transitions"]["geomorph"]["largest_jump"]);
  }
  ASSERT_EQ(all["head_pose_to_swap"].size(), 6u);
  for (const nlohmann::json& row : all["head_pose_to_swap"]) {
    EXPECT_GT(row["frames"], 0) << row;
    EXPECT_GT(row["pose_to_swap_ms"]["p50"], 0) << row;
    EXPECT_GE(row["pose_to_swap_ms"]["p99"], row["pose_to_swap_ms"]["p50"]) << row;
  }
}

TEST_F(Bench, WrongInputIsRefused) {
  const SmallRun distorted;
  std::filesystem::remove_all(distorted / "truth");
  const std::vector<std::pair<std::vector<std::string>, std::string>> all = {
      {{"bench", "margin", distorted.path().string()}, "has no truth"},
      {{"bench", "margin", (out_ / "none")}, "none"},
      {{"bench", "margin", run(), "--images", "0"}, "--images"},
      {{"bench", "extraction", run(), "--images", "1"}, "--images"},
      {{"bench", "view", run(), "--rounds", "0"}, "--rounds"},
      {{"bench", "head", run(), "--views", "0"}, "--views"},
      {{"bench", "extraction", run(), "--json", run() + "/scene.yaml"}, "--json"},
      {{"bench", "extraction", (out_ / "none")}, "none"},
  };
  for (const auto& [arguments, what] : all) {
    const Outcome outcome = run_program(arguments);
    EXPECT_EQ(outcome.exit_code, 2) << outcome.err;
    EXPECT_THAT(outcome.last_line(), testing::HasSubstr(what));
  }
}

}  // namespace
}  // namespace foresight::bench_test
