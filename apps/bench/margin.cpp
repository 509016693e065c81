#include "apps/bench/margin.hpp"

#include <cstdio>
#include <iostream>
#include <nlohmann/json.hpp>

#include "apps/bench/bench_pipelines.hpp"
#include "apps/bench/margin_plot.hpp"
#include "apps/bench/texel_truth.hpp"
#include "apps/replay_report/progress_bar.hpp"
#include "common/error.hpp"
#include "common/numbers_file.hpp"
#include "common/plot_data.hpp"
#include "display/recorded_source.hpp"
#include "sim/pose_error.hpp"

namespace foresight {
namespace {

using SteadyClock = std::chrono::steady_clock;

constexpr double kErrors[] = {0, 0.5, 1, 2, 3};  // px
constexpr double kTexelsPerMetre = 500;
constexpr int kLargestTexture = 4096;  // so that no polygon of the thesis is coarser than the core's charts
constexpr unsigned kSeed = 1;

cv::Mat depth_of(const GroundTruth::Surface& truth) {
  cv::Mat depth(truth.height(), truth.width(), CV_32FC1);
  for (int v = 0; v < depth.rows; ++v)
    for (int u = 0; u < depth.cols; ++u) depth.at<float>(v, u) = static_cast<float>(truth.depth(u, v));
  return depth;
}

/// The images as the pipelines get them when each pose is wrong by `error_px`.
std::vector<JudgedImage> images_with(const RunFolder& run, const GroundTruth& truth,
                                     const std::vector<std::size_t>& frames, double error_px) {
  std::vector<JudgedImage> out;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    const RunImage& image = run.frames()[frames[i]].left;
    JudgedImage judged{{}, truth.read(frames[i], false), static_cast<int>(i)};
    const Pose error =
        sim::random_pose_error(run.lens_left(), depth_of(judged.truth), error_px, kSeed, static_cast<int>(frames[i]));
    judged.given = {coded_picture(run.lens_left(), judged.code), image.time,
                    truth.T_world_camera(frames[i], false) * error, run.state_at(image.time)};
    out.push_back(std::move(judged));
  }
  return out;
}

class MarginBench {
 public:
  MarginBench(const RunFolder& run, bool software)
      : run_(run), software_(software), surface_(surface_for(run)), judge_(run) {}

  TexelCount core(const std::vector<JudgedImage>& images, double margin_px) const {
    TextureOptions options;
    options.texels_per_metre = kTexelsPerMetre;
    options.margin_px = margin_px;
    options.depth_tolerance = run_.scene()->accuracy().value_or(options.depth_tolerance);
    options.even_exposure = false;  // colours are codes here
    options.shadows = false;
    options.worse = 1e-9;  // every image that sees a texel paints it
    BenchCore core(run_.scene(), surface_, run_.lens_left(), options, software_);
    TexelCount sum;
    for (const JudgedImage& image : images) {
      core.process({image.given, std::nullopt});
      const TextureLease lease = core.textures().acquire();
      sum += judge_.count(TextureReadback(*lease, surface_), image);
    }
    return sum;
  }

  TexelCount thesis(const std::vector<JudgedImage>& images, int iterations) const {
    thesis::Options options;
    options.texels_per_metre = kTexelsPerMetre;
    options.max_texture = kLargestTexture;
    options.expansion = iterations ? thesis::Expansion::shader : thesis::Expansion::none;
    options.iterations = iterations;
    options.hole_filling = thesis::HoleFilling::none;  // leaves alone what it would not have filled
    thesis::Pipeline pipeline(run_.scene(), run_.lens_left(), std::nullopt, options, software_);
    TexelCount sum;
    for (const JudgedImage& image : images) {
      pipeline.process({image.given, std::nullopt});
      sum += judge_.count(pipeline.textures(), image);
    }
    return sum;
  }

 private:
  const RunFolder& run_;
  bool software_;
  std::shared_ptr<const SurfacePatches> surface_;
  TexelJudge judge_;
};

nlohmann::json to_json(const MarginRow& row) {
  const auto count = [](const TexelCount& c) {
    return nlohmann::json{{"right", c.right}, {"wrong", c.wrong}, {"arm_on_still_nodes", c.arm_stray}};
  };
  return {{"error_px", row.error_px},
          {"core", count(row.core)},
          {"core_without_margin", count(row.core_without)},
          {"thesis", count(row.thesis)},
          {"thesis_without_expansion", count(row.thesis_without)},
          {"core_rejected_right", row.core_without.right - row.core.right},
          {"thesis_rejected_right", row.thesis_without.right - row.thesis.right}};
}

void print(const std::vector<MarginRow>& rows) {
  std::printf("Texels of 2 mm x 2 mm, in thousands. Wrong: the pixel shows a point more than 20 mm away.\n");
  std::printf("%5s | %30s | %30s\n", "error", (core_with_margin() + " (none)").c_str(),
              "thesis: 3 shader iter. (none)");
  std::printf("%5s | %15s %14s | %15s %14s\n", "px", "wrong", "right lost", "wrong", "right lost");
  for (const MarginRow& row : rows)
    std::printf("%5.1f | %6.2f (%6.2f) %14.1f | %6.2f (%6.2f) %14.1f\n", row.error_px, row.core.wrong / 1e3,
                row.core_without.wrong / 1e3, (row.core_without.right - row.core.right) / 1e3, row.thesis.wrong / 1e3,
                row.thesis_without.wrong / 1e3, (row.thesis_without.right - row.thesis.right) / 1e3);
  const MarginRow& exact = rows.front();
  std::printf(
      "Of %.0f thousand right texels. The arm on what stands still, without errors: %.2f thousand (core), "
      "%.2f (thesis).\n",
      exact.core_without.right / 1e3, exact.core.arm_stray / 1e3, exact.thesis.arm_stray / 1e3);
}

}  // namespace

int bench_margin(const MarginBenchOptions& options) {
  const RunFolder run = RunFolder::open(options.run, {});
  if (!GroundTruth::exists(run))
    throw InputError(options.run.string(), "has no truth", "give a run of `foresight synth --no-distortion`");
  require_thesis_lens(run);
  const GroundTruth truth = GroundTruth::open(run);
  const auto context = gl::create_headless_context();
  const gl::DriverInfo driver = gl::query_driver();
  gl::set_up_context();

  const auto frames = spread(run.frames().size(), static_cast<std::size_t>(options.images));
  const MarginBench bench(run, driver.is_software);
  std::vector<MarginRow> rows;
  ProgressBar bar("margin", "errors", std::size(kErrors), SteadyClock::now(), ProgressBar::for_stderr());
  for (double error : kErrors) {
    const auto images = images_with(run, truth, frames, error);
    rows.push_back({error, bench.core(images, TextureOptions().margin_px), bench.core(images, 0),
                    bench.thesis(images, 3), bench.thesis(images, 0)});
    std::cerr << bar.update(rows.size(), SteadyClock::now()) << std::flush;
  }
  std::cerr << bar.finish(rows.size(), SteadyClock::now());
  print(rows);
  nlohmann::json all;
  all["images"] = frames.size();
  for (const MarginRow& row : rows) all["errors"].push_back(to_json(row));
  write_numbers(options.json, all.dump(2));
  if (options.plot) write_page(*options.plot, margin_plot(rows), "bench margin", margin_plot_data(rows));
  return 0;
}

}  // namespace foresight
