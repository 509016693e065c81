#include "apps/bench/extraction.hpp"

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <iostream>
#include <nlohmann/json.hpp>

#include "apps/bench/extraction_tables.hpp"
#include "apps/replay_report/progress_bar.hpp"
#include "common/error.hpp"
#include "common/numbers_file.hpp"
#include "common/statistics.hpp"
#include "display/recorded_source.hpp"

namespace foresight {
namespace {

using nlohmann::json;
using SteadyClock = std::chrono::steady_clock;

struct Comparison {
  std::vector<double> core_ms, thesis_ms;
  double texels = 0;    // written by the core, per image
  double polygons = 0;  // in view, per image
};

/// Both pipelines take every frame, one after the other, so that what disturbs the machine
/// disturbs both.
Comparison compare(const BenchSetup& setup) {
  auto core = make_core(setup, setup.texels_per_metre, setup.max_texture);
  thesis::Options options;
  options.texels_per_metre = setup.texels_per_metre;
  options.max_texture = setup.max_texture;
  thesis::Pipeline thesis = make_thesis(setup, options);
  ProgressBar bar("compare", "images", setup.frames.size(), SteadyClock::now(), ProgressBar::for_stderr());
  Comparison out;
  for (std::size_t i = 0; i < setup.frames.size(); ++i) {
    ExtractionReport of_core, of_thesis;
    out.core_ms.push_back(cpu_ms_of([&] { of_core = core->process(setup.frames[i]); }));
    out.thesis_ms.push_back(cpu_ms_of([&] { of_thesis = thesis.process(setup.frames[i]); }));
    out.texels += static_cast<double>(of_core.tiles) * 64 / static_cast<double>(setup.frames.size());
    out.polygons += static_cast<double>(of_thesis.pages) / static_cast<double>(setup.frames.size());
    std::cerr << bar.update(i + 1, SteadyClock::now()) << std::flush;
  }
  std::cerr << bar.finish(setup.frames.size(), SteadyClock::now());
  return out;
}

double mean(const std::vector<double>& values) {
  double sum = 0;
  for (double v : values) sum += v;
  return sum / static_cast<double>(std::max<std::size_t>(values.size(), 1));
}

BenchSetup prepare(const RunFolder& run, const ExtractionBenchOptions& options, bool software) {
  BenchSetup setup{run, surface_for(run), {}, software};
  const std::size_t count = std::min(run.frames().size(), static_cast<std::size_t>(options.images.value_or(1 << 30)));
  for (std::size_t i = 0; i < count; ++i) {
    setup.frames.push_back(load_posed_frame(run, i));
    setup.frames.back().right.reset();  // the thesis' figures are of one camera
  }
  return setup;
}

}  // namespace

int bench_extraction(const ExtractionBenchOptions& options) {
  const RunFolder run = RunFolder::open(options.run, {});
  require_thesis_lens(run);
  const auto context = gl::create_headless_context();
  const gl::DriverInfo driver = gl::query_driver();
  gl::set_up_context();
  const BenchSetup setup = prepare(run, options, driver.is_software);

  const Comparison comparison = compare(setup);
  const double core_ms = mean(comparison.core_ms), thesis_ms = mean(comparison.thesis_ms);
  json all;
  all["images_per_core_second"] = 1000 / core_ms;
  all["speedup_over_thesis"] = thesis_ms / core_ms;
  all["thesis_images_per_core_second"] = 1000 / thesis_ms;
  all["core_cpu_ms"] = {{"mean", core_ms}, {"median", median(comparison.core_ms)}};
  all["thesis_cpu_ms"] = {{"mean", thesis_ms}, {"median", median(comparison.thesis_ms)}};
  all["images"] = setup.frames.size();
  all["image_size_px"] = {run.lens_left().width(), run.lens_left().height()};
  all["texels_per_metre"] = setup.texels_per_metre;
  all["max_texture"] = setup.max_texture;
  all["renderer"] = driver.renderer + ", OpenGL " + driver.version;
  all["texels_per_image"] = comparison.texels;
  all["polygons_per_image"] = comparison.polygons;
  std::printf("%zu images of %d x %d, %.0f texels/m, at most %d texels a side, holes filled; %s\n", setup.frames.size(),
              run.lens_left().width(), run.lens_left().height(), setup.texels_per_metre, setup.max_texture,
              driver.renderer.c_str());
  std::printf("                     CPU-ms per image   median   images per core-second\n");
  std::printf("core                       %10.1f %8.1f   %.1f\n", core_ms, median(comparison.core_ms), 1000 / core_ms);
  std::printf("thesis' pipeline           %10.1f %8.1f   %.2f\n", thesis_ms, median(comparison.thesis_ms),
              1000 / thesis_ms);
  std::printf("ratio                      %10.1f %8.1f\n", thesis_ms / core_ms,
              median(comparison.thesis_ms) / median(comparison.core_ms));
  all["bandwidth"] = bench_bandwidth(setup, core_ms, comparison.texels);
  if (options.tables) {
    all["table_7_1_stages"] = bench_stages(setup);
    all["table_7_2_expansion"] = bench_expansion(setup);
    all["table_7_3_hole_filling"] = bench_hole_filling(setup);
    all["table_7_4_resolutions"] = bench_resolutions(setup);
  }
  write_numbers(options.json, all.dump(2));
  return 0;
}

}  // namespace foresight
