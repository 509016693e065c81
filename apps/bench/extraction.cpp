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
  std::vector<double> needed_ms;    // the core where views look images up: extracts what is needed then
  std::vector<double> same_job_ms;  // likewise, with neither lamp nor shadows, as the thesis' pipeline
  double texels = 0;                // written by the core, per image
  double texels_needed = 0;         // likewise
  double polygons = 0;              // in view, per image
};

/// All take every frame, one after the other, so that what disturbs the machine disturbs all.
Comparison compare(const BenchSetup& setup) {
  auto core = make_core(setup, setup.texels_per_metre, setup.max_texture);
  auto needed = make_core(setup, setup.texels_per_metre, setup.max_texture);
  auto same_job = make_core(setup, setup.texels_per_metre, setup.max_texture, false);
  LatestImages newest, newest_of_same_job;
  thesis::Options options;
  options.texels_per_metre = setup.texels_per_metre;
  options.max_texture = setup.max_texture;
  thesis::Pipeline thesis = make_thesis(setup, options);
  ProgressBar bar("compare", "images", setup.frames.size(), SteadyClock::now(), ProgressBar::for_stderr());
  Comparison out;
  for (std::size_t i = 0; i < setup.frames.size(); ++i) {
    ExtractionReport of_core, of_needed, of_thesis;
    out.core_ms.push_back(cpu_ms_of([&] { of_core = core->process(setup.frames[i]); }));
    out.needed_ms.push_back(cpu_ms_of([&] { of_needed = needed->process(setup.frames[i], newest); }));
    out.same_job_ms.push_back(cpu_ms_of([&] { same_job->process(setup.frames[i], newest_of_same_job); }));
    out.thesis_ms.push_back(cpu_ms_of([&] { of_thesis = thesis.process(setup.frames[i]); }));
    out.texels += static_cast<double>(of_core.tiles) * 64 / static_cast<double>(setup.frames.size());
    out.texels_needed += static_cast<double>(of_needed.tiles) * 64 / static_cast<double>(setup.frames.size());
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

json cost_of(const std::vector<double>& ms) {
  return {{"mean", mean(ms)}, {"median", median(ms)}};
}

void print(const Comparison& c) {
  std::printf("                     CPU-ms per image   median   images per core-second\n");
  const auto row = [](const char* name, const std::vector<double>& ms) {
    std::printf("%-26s %10.1f %8.1f   %.2f\n", name, mean(ms), median(ms), 1000 / mean(ms));
  };
  const auto ratio = [&](const char* name, const std::vector<double>& ms) {
    std::printf("%-26s %10.1f %8.1f\n", name, mean(c.thesis_ms) / mean(ms), median(c.thesis_ms) / median(ms));
  };
  row("core", c.core_ms);
  row("core, what views need", c.needed_ms);
  row("likewise, no shadows", c.same_job_ms);
  row("thesis' pipeline", c.thesis_ms);
  ratio("ratio", c.core_ms);
  ratio("ratio, what views need", c.needed_ms);
  ratio("likewise, no shadows", c.same_job_ms);
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
  all["speedup_over_thesis_needed"] = thesis_ms / mean(comparison.needed_ms);
  all["speedup_over_thesis_needed_no_shadows"] = thesis_ms / mean(comparison.same_job_ms);
  all["core_cpu_ms"] = cost_of(comparison.core_ms);
  all["core_needed_cpu_ms"] = cost_of(comparison.needed_ms);
  all["core_needed_no_shadows_cpu_ms"] = cost_of(comparison.same_job_ms);
  all["thesis_cpu_ms"] = cost_of(comparison.thesis_ms);
  all["images"] = setup.frames.size();
  all["image_size_px"] = {run.lens_left().width(), run.lens_left().height()};
  all["texels_per_metre"] = setup.texels_per_metre;
  all["max_texture"] = setup.max_texture;
  all["renderer"] = driver.renderer + ", OpenGL " + driver.version;
  all["texels_per_image"] = comparison.texels;
  all["texels_needed_per_image"] = comparison.texels_needed;
  all["polygons_per_image"] = comparison.polygons;
  std::printf("%zu images of %d x %d, %.0f texels/m, at most %d texels a side, holes filled; %s\n", setup.frames.size(),
              run.lens_left().width(), run.lens_left().height(), setup.texels_per_metre, setup.max_texture,
              driver.renderer.c_str());
  print(comparison);
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
