#include "apps/bench/head_bench.hpp"

#include <algorithm>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "apps/bench/child_process.hpp"
#include "apps/bench/head_lab.hpp"
#include "apps/bench/head_motion_figures.hpp"
#include "apps/bench/head_server_figures.hpp"
#include "apps/bench/level_figures.hpp"
#include "apps/bench/openxr_figures.hpp"
#include "apps/bench/portal_figures.hpp"
#include "apps/bench/pose_table.hpp"
#include "apps/bench/sorting_figures.hpp"
#include "apps/bench/stereogram_figures.hpp"
#include "apps/bench/temporary_folder.hpp"
#include "apps/bench/warp_figures.hpp"
#include "common/error.hpp"
#include "common/numbers_file.hpp"
#include "sim/synth_run.hpp"

namespace foresight {
namespace {

constexpr std::size_t kMostShare = 3;  // of an eye's pixels that its view has, at most

/// The given run, or the lab, rendered for as long as this lives.
class BenchRun {
 public:
  explicit BenchRun(const std::optional<std::filesystem::path>& given)
      : run_(RunFolder::open(given ? *given : make(), {})) {}
  const RunFolder& run() const { return run_; }

 private:
  std::filesystem::path make() {
    std::fputs("bench: rendering a lab of 12 images\n", stderr);
    const std::filesystem::path out = folder_.emplace().path() / "lab";
    sim::SynthOptions options;
    options.frames = 12;
    options.truth = false;
    // Who draws is forked next, which must not have seen a context.
    if (!wait_for_child(start_child([&] { sim::write_synth_run(out, options); })))
      throw RuntimeFailure("the lab for the bench could not be rendered", "read what is said above");
    return out;
  }
  std::optional<TemporaryFolder> folder_;
  RunFolder run_;
};

nlohmann::json server_figures(HeadLab& lab, gl::Context& context, DrawingProcess& process,
                              const HeadBenchOptions& options) {
  if (options.seconds <= 0) return nullptr;
  std::printf("frames in real time, extraction and drawing beside them, the line dead for %.1f s:\n",
              std::min(5.0, options.seconds / 2));
  nlohmann::json rows = nlohmann::json::array();
  for (const auto second : {head::SecondEyeFrom::own_view, head::SecondEyeFrom::first_eye}) {
    HeadServerTrial large{options.width, options.height, options.rate_hz, options.seconds, second};
    rows.push_back(head_server_figures(lab, context, large));
    HeadServerTrial small{options.width / 2, options.height / 2, 2.25 * options.rate_hz, options.seconds, second};
    rows.push_back(head_server_figures(lab, context, small));
  }
  for (const DrawnBy by : {DrawnBy::showing_thread, DrawnBy::process})
    rows.push_back(head_server_figures(lab, context,
                                       {options.width, options.height, options.rate_hz, options.seconds,
                                        head::SecondEyeFrom::own_view, by, &process}));
  return rows;
}

/// Those that need no images.
void add_scene_figures(const HeadBenchOptions& options, const PoseTrack& head, nlohmann::json& all) {
  if (options.wants("portals"))
    all["portals"] = portal_figures({options.building, options.building_views, options.seed});
  if (options.wants("levels"))
    all["time_critical_rendering"] = level_figures({.triangles = options.building,
                                                    .width = options.width,
                                                    .height = options.height,
                                                    .frames = std::min(150, 4 * options.views),
                                                    .seed = options.seed,
                                                    .picture = options.picture},
                                                   head);
  if (options.wants("sorting")) all["state_sorting_buffer"] = sorting_figures(options.seed);
}

void add_lab_figures(const HeadBenchOptions& options, const PoseTrack& head, const RunFolder& run, gl::Context& context,
                     DrawingProcess& process, nlohmann::json& all) {
  MonotonicClock clock;
  HeadLab lab(run, context, clock);
  if (options.wants("warp"))
    all["warped_against_rendered"] = warp_figures(lab, {options.width, options.height, options.views, options.degrees,
                                                        options.metres, options.eyes_apart, options.seed});
  if (options.wants("recorded"))
    all["recorded_head_motion"] = head_motion_figures(lab, head, options.width, options.height);
  if (options.wants("cube"))
    all["viewport_independent_rendering"] = cube_figures(lab, head, options.width, options.height, options.head_frames);
  if (options.wants("server")) all["head_pose_to_swap"] = server_figures(lab, context, process, options);
  if (options.wants("stereograms")) all["stereograms"] = stereogram_figures(run, options.width);
  if (options.wants("openxr")) all["openxr_session"] = openxr_figures(lab, context, options.openxr_frames);
}

}  // namespace

bool HeadBenchOptions::wants(std::string_view part) const {
  return only.empty() || std::ranges::find(only, part) != only.end();
}

int bench_head(const HeadBenchOptions& options) {
  const PoseTrack head = options.path ? head_track(read_pose_table(*options.path)) : swaying_head();
  const bool with_lab = std::ranges::any_of(kHeadBenchLabParts, [&](const std::string& p) { return options.wants(p); });
  std::optional<BenchRun> lab_run;
  std::optional<DrawingProcess> process;
  if (with_lab) {
    lab_run.emplace(options.run);
    process.emplace(lab_run->run(), kMostShare * static_cast<std::size_t>(options.width * options.height));
  }
  const auto context = gl::create_headless_context();
  const gl::DriverInfo driver = gl::query_driver();
  gl::set_up_context();
  std::printf("%s\n", driver.renderer.c_str());

  nlohmann::json all;
  all["renderer"] = driver.renderer + ", OpenGL " + driver.version;
  all["size_px"] = {options.width, options.height};
  all["run"] = options.run ? options.run->string() : "a synthetic lab of 12 images";
  all["head"] = options.path ? options.path->string() : "made up: it sways";
  if (with_lab) add_lab_figures(options, head, lab_run->run(), *context, *process, all);
  add_scene_figures(options, head, all);
  write_numbers(options.json, all.dump(2));
  return 0;
}

}  // namespace foresight
