// The measurements behind tables 7.1 to 7.4 of the thesis, repeated with both pipelines.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "apps/bench/bench_pipelines.hpp"
#include "scene/run_folder.hpp"

namespace foresight {

/// What all tables need. Frames are read once and kept: files are not part of what is measured.
struct BenchSetup {
  const RunFolder& run;
  std::shared_ptr<const SurfacePatches> surface;
  std::vector<PosedFrame> frames;
  bool software = true;
  double texels_per_metre = 500;
  int max_texture = 256;
};

/// Each prints its table to stdout and returns the same numbers. CPU-ms per image, means.
nlohmann::json bench_stages(const BenchSetup& setup);        ///< table 7.1
nlohmann::json bench_expansion(const BenchSetup& setup);     ///< table 7.2
nlohmann::json bench_hole_filling(const BenchSetup& setup);  ///< table 7.3
nlohmann::json bench_resolutions(const BenchSetup& setup);   ///< table 7.4

/// What this machine copies from memory to memory in one thread, and how near the core comes.
nlohmann::json bench_bandwidth(const BenchSetup& setup, double core_cpu_ms, double texels_per_image);

/// The thesis' pipeline for the setup's left lens.
thesis::Pipeline make_thesis(const BenchSetup& setup, const thesis::Options& options);
/// A core of that resolution. Without shadows, and the lamp that they need, it does the job of the thesis' pipeline.
std::unique_ptr<BenchCore> make_core(const BenchSetup& setup, double texels_per_metre, int max_texture,
                                     bool shadows = true);

}  // namespace foresight
