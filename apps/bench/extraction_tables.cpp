#include "apps/bench/extraction_tables.hpp"

#include <array>
#include <cstdio>
#include <cstring>
#include <nlohmann/json.hpp>

#include "texture_gpu/atlas_layout.hpp"

namespace foresight {
namespace {

using nlohmann::json;

constexpr std::size_t kTableFrames = 24;  // of which the tables take means
constexpr std::size_t kFewFrames = 6;     // where every setting needs a pipeline of its own
constexpr double kThesisTotal = 125.7;    // ms, table 7.1

thesis::Options profiled(const BenchSetup& setup) {
  thesis::Options options;
  options.texels_per_metre = setup.texels_per_metre;
  options.max_texture = setup.max_texture;
  options.profile = true;
  return options;
}

/// Stages of the thesis' pipeline over some frames; the first ones only fill its textures.
StageSums profile(const BenchSetup& setup, const thesis::Options& options, std::size_t frames, std::size_t warm_up) {
  thesis::Pipeline pipeline = make_thesis(setup, options);
  StageSums sums;
  std::size_t done = 0;
  for (std::size_t i : spread(setup.frames.size(), frames + warm_up)) {
    const ExtractionReport report = pipeline.process(setup.frames[i]);
    if (done++ >= warm_up) sums.add(report);
  }
  return sums;
}

double total_of(const std::vector<StageCost>& stages) {
  double total = 0;
  for (const StageCost& stage : stages) total += stage.cpu_ms;
  return total;
}

/// Of the whole run: the lamp is found and shadows are taken out late in it.
json stages_of_core(const BenchSetup& setup, bool only_what_views_need) {
  auto core = make_core(setup, setup.texels_per_metre, setup.max_texture);
  LatestImages newest;
  StageSums sums;
  for (const PosedFrame& frame : setup.frames)
    sums.add(only_what_views_need ? core->process(frame, newest) : core->process(frame));
  std::printf("\nStages of the core%s\n", only_what_views_need ? ", what views need" : "");
  const double total = total_of(sums.means());
  json out;
  for (const StageCost& stage : sums.means()) {
    std::printf("%-40s %12s %7s %12.1f %7.1f\n", stage.name.c_str(), "", "", stage.cpu_ms, 100 * stage.cpu_ms / total);
    out.push_back({{"stage", stage.name}, {"cpu_ms", stage.cpu_ms}});
  }
  return out;
}

}  // namespace

thesis::Pipeline make_thesis(const BenchSetup& setup, const thesis::Options& options) {
  return thesis::Pipeline(setup.run.scene(), setup.run.lens_left(), std::nullopt, options, setup.software);
}

std::unique_ptr<BenchCore> make_core(const BenchSetup& setup, double texels_per_metre, int max_texture, bool shadows) {
  TextureOptions options;
  options.texels_per_metre = texels_per_metre;
  options.max_texture = max_texture;
  options.shadows = shadows;
  options.depth_tolerance = setup.run.scene()->accuracy().value_or(options.depth_tolerance);
  return std::make_unique<BenchCore>(setup.run.scene(), setup.surface, setup.run.lens_left(), options, setup.software);
}

json bench_stages(const BenchSetup& setup) {
  struct Row {
    const char* stage;  // of thesis::Pipeline
    const char* title;  // of table 7.1
    double thesis_ms;   // of table 7.1
  };
  constexpr Row kRows[] = {{"perspective texture", "extraction of the perspective texture", 14.6},
                           {"occlusion", "occlusion", 4.6},
                           {"expansion", "suppression of artefacts, 3 iterations", 24.1},
                           {"normalisation", "normalisation and scaling", 4.8},
                           {"fusion", "fusion", 2.3},
                           {"hole filling", "hole filling, pyramid", 66.2},
                           {"other", "other (upload, undistortion, waiting)", 9.1}};
  const StageSums thesis = profile(setup, profiled(setup), kTableFrames, 2);
  const double total = total_of(thesis.means());
  std::printf("\nTable 7.1: stages of the thesis' pipeline (profiled: every step waits for the last)\n");
  std::printf("%-40s %12s %7s %12s %7s\n", "", "thesis [ms]", "[%]", "here [CPU-ms]", "[%]");
  json out;
  for (const Row& row : kRows) {
    double ms = thesis.mean_of(row.stage);
    if (std::strcmp(row.stage, "other") == 0) ms += thesis.mean_of("upload");
    std::printf("%-40s %12.1f %7.1f %12.1f %7.1f\n", row.title, row.thesis_ms, 100 * row.thesis_ms / kThesisTotal, ms,
                100 * ms / total);
    out["thesis_pipeline"].push_back({{"stage", row.stage},
                                      {"thesis_ms", row.thesis_ms},
                                      {"thesis_share", row.thesis_ms / kThesisTotal},
                                      {"cpu_ms", ms},
                                      {"share", ms / total}});
  }
  std::printf("%-40s %12.1f %7.0f %12.1f %7.0f\n", "all", kThesisTotal, 100.0, total, 100.0);

  out["core"] = stages_of_core(setup, false);
  out["core_needed"] = stages_of_core(setup, true);
  return out;
}

json bench_expansion(const BenchSetup& setup) {
  struct Row {
    int iterations;
    double thesis_scaling, thesis_shader;
  };
  constexpr Row kRows[] = {{0, 0, 0},       {2, 15.3, 18.6}, {4, 25.7, 29.5},
                           {6, 36.1, 40.5}, {8, 46.5, 51.5}, {10, 56.9, 62.4}};
  std::printf("\nTable 7.2: suppression of artefacts, CPU-ms per image (thesis: ms)\n");
  std::printf("%10s %22s %22s\n", "iterations", "bilinear (thesis)", "shader (thesis)");
  json out;
  for (const Row& row : kRows) {
    std::array<double, 2> ms{};
    for (std::size_t method = 0; method < 2; ++method) {
      thesis::Options options = profiled(setup);
      options.expansion = method == 0 ? thesis::Expansion::alternating : thesis::Expansion::shader;
      options.iterations = row.iterations;
      options.hole_filling = thesis::HoleFilling::none;
      ms[method] = profile(setup, options, kFewFrames, 0).mean_of("expansion");
    }
    std::printf("%10d %12.1f (%6.1f) %13.1f (%6.1f)\n", row.iterations, ms[0], row.thesis_scaling, ms[1],
                row.thesis_shader);
    out.push_back({{"iterations", row.iterations},
                   {"bilinear_cpu_ms", ms[0]},
                   {"shader_cpu_ms", ms[1]},
                   {"thesis_bilinear_ms", row.thesis_scaling},
                   {"thesis_shader_ms", row.thesis_shader}});
  }
  return out;
}

json bench_resolutions(const BenchSetup& setup) {
  struct Row {
    double texels_per_metre;
    int max_texture;
    double thesis_ms;
  };
  constexpr Row kRows[] = {{50, 512, 118.3}, {100, 64, 100.9},  {100, 256, 112.5}, {100, 512, 128.9},
                           {500, 64, 104.8}, {500, 256, 125.7}, {500, 512, 464.7}};
  std::printf("\nTable 7.4: resolution of textures, per image\n");
  std::printf("%12s %8s %12s %18s %14s %7s\n", "texels/m", "at most", "thesis [ms]", "pipeline [CPU-ms]",
              "core [CPU-ms]", "ratio");
  json out;
  for (const Row& row : kRows) {
    BenchSetup coarse = setup;
    coarse.texels_per_metre = row.texels_per_metre;
    coarse.max_texture = row.max_texture;
    thesis::Options options = profiled(coarse);
    options.profile = false;
    thesis::Pipeline thesis = make_thesis(coarse, options);
    auto core = make_core(coarse, row.texels_per_metre, row.max_texture);
    double thesis_ms = 0, core_ms = 0;
    int done = 0, counted = 0;
    for (std::size_t i : spread(setup.frames.size(), 2 * kFewFrames)) {
      const double t = cpu_ms_of([&] { thesis.process(setup.frames[i]); });
      core->process(setup.frames[i]);  // the jump to here changes resolutions: not what a video does
      const double c = cpu_ms_of([&] { core->process(setup.frames[i]); });
      if (done++ < 2) continue;
      ++counted;
      thesis_ms += t;
      core_ms += c;
    }
    thesis_ms /= counted;
    core_ms /= counted;
    std::printf("%12.0f %8d %12.1f %18.1f %14.1f %7.1f\n", row.texels_per_metre, row.max_texture, row.thesis_ms,
                thesis_ms, core_ms, thesis_ms / core_ms);
    out.push_back({{"texels_per_metre", row.texels_per_metre},
                   {"max_texture", row.max_texture},
                   {"thesis_ms", row.thesis_ms},
                   {"thesis_pipeline_cpu_ms", thesis_ms},
                   {"core_cpu_ms", core_ms}});
  }
  return out;
}

json bench_bandwidth(const BenchSetup& setup, double core_cpu_ms, double texels) {
  constexpr std::size_t kBytes = std::size_t{64} << 20;
  std::vector<char> from(kBytes, 1), to(kBytes, 2);
  double best = 1e30;
  for (int i = 0; i < 5; ++i) best = std::min(best, cpu_ms_of([&] { std::memcpy(to.data(), from.data(), kBytes); }));
  const double copy = 2 * static_cast<double>(kBytes) / (best * 1e-3) * 1e-9;  // read and written
  // Height, old and new colour, image; then the pyramid reads the colour and writes a third of it.
  constexpr double kColour = atlas::kTexelBytes, kBytesPerTexel = 2 + kColour + kColour + 4 + kColour + kColour / 3;
  const Lens& lens = setup.run.lens_left();
  const double pixels = static_cast<double>(lens.width()) * lens.height();
  // Per pixel: colour converted and uploaded, depth written and read for blocks.
  const double bytes = texels * kBytesPerTexel + pixels * (3 + 4 + 4 + 4 + 4);
  const double core = bytes / (core_cpu_ms * 1e-3) * 1e-9;
  std::printf(
      "\nBandwidth: memory copies at %.1f GB/s here; the core moves %.1f bytes per texel, in all %.1f MB per\n"
      "image: %.2f GB/s, %.1f %% of that\n",
      copy, kBytesPerTexel, bytes * 1e-6, core, 100 * core / copy);
  return {{"copy_gb_per_s", copy},
          {"bytes_per_texel", kBytesPerTexel},
          {"core_mb_per_image", bytes * 1e-6},
          {"core_gb_per_s", core}};
}

}  // namespace foresight
