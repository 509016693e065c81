// A small made-up run for tests: plausible numbers, fixed seed.
#pragma once

#include <string>

#include "apps/replay_report/replay_report.hpp"

namespace foresight {

inline RunRecord example_run(int frames = 40) {
  RunRecord run;
  run.run = "example & <co>";
  run.image_width_px = 640;
  run.image_height_px = 480;
  run.lens_model = "plumb_bob";
  run.scene_triangles = 5000;
  run.charts = 212;
  run.texels = 830'000;
  run.options = {{"delay_frames", std::int64_t{6}}, {"margin_px", 3.0}, {"real_time", false}, {"scene", "scene.ply"}};
  run.renderer = "llvmpipe (LLVM 15.0.6, 256 bits)";
  run.version = "0.1.0";
  run.notes = {"The texture budget was reached at 0004: 12 charts were halved."};
  cv::RNG rng(1);
  for (int i = 0; i < frames; ++i) {
    FrameRecord f;
    f.stem = "0000" + std::to_string(10 + i);
    f.time_s = 0.5 + i / 15.0;
    f.delay_s = 0.4;
    const double settled = 1 - std::exp(-i / 4.0);
    f.predicted = {15 + 4 * settled + rng.gaussian(0.4), 0.5 + 0.2 * settled, 0.93 + rng.gaussian(0.02)};
    f.delayed = {12 + rng.gaussian(0.5), 0.35, 1.0 + rng.gaussian(0.02)};
    f.coverage = {0.55 + 0.25 * settled, 0.1 - 0.05 * settled, 0.2 - 0.18 * settled, 0.15 - 0.02 * settled};
    f.stages = {{"upload", 1.1, 0.05, StagePart::texture}, {"depth", 4.9, 0.06, StagePart::texture},
                {"margin", 3.2, 0.04, StagePart::texture}, {"extract", 28 + rng.gaussian(2), 0.3, StagePart::texture},
                {"exposure", 2.4, {}, StagePart::texture}, {"fill", 18 + rng.gaussian(1), 0.1, StagePart::texture},
                {"publish", 1.4, {}, StagePart::texture},  {"view", 9.0, 0.2, StagePart::view},
                {"compare", 14.0, {}, StagePart::measure}};
    f.arrival_to_publish_ms = 60 + std::abs(rng.gaussian(12));
    f.texture_bytes_used = static_cast<std::uint64_t>(14e6 + 1e5 * i);
    f.texture_bytes_budget = 64u << 20;
    f.gain = 1.02;
    run.frames.push_back(f);
  }
  return run;
}

}  // namespace foresight
