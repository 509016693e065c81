#include "apps/bench/bench_pipelines.hpp"

#include <algorithm>

#include "common/error.hpp"

namespace foresight {

void require_thesis_lens(const RunFolder& run) {
  if (!thesis::CameraFrame::can_undistort(run.lens_left()))
    throw InputError(run.root().string(), "the thesis' pipeline cannot take a lens of more than 120 degrees",
                     "give a run of `foresight synth --no-distortion`");
}

ExtractionReport BenchCore::process(const PosedFrame& frame) {
  ExtractionReport report = core_.process(frame, latest_);
  core_.wait_for_search();
  if (!report.published) throw RuntimeFailure("the core dropped a frame", "give it more memory");
  return report;
}

ExtractionReport BenchCore::process(const PosedFrame& frame, LatestImages& newest) {
  core_.look(frame, newest);
  ExtractionReport report = core_.extract(latest_, &newest);
  core_.wait_for_search();
  if (!report.published) throw RuntimeFailure("the core dropped a frame", "give it more memory");
  return report;
}

void StageSums::add(const ExtractionReport& report) {
  ++count_;
  for (const StageCost& stage : report.stages) {
    const auto at = std::find_if(sums_.begin(), sums_.end(), [&](const StageCost& s) { return s.name == stage.name; });
    if (at == sums_.end())
      sums_.push_back(stage);
    else
      at->cpu_ms += stage.cpu_ms;
  }
}

std::vector<StageCost> StageSums::means() const {
  std::vector<StageCost> out = sums_;
  for (StageCost& stage : out) stage.cpu_ms /= std::max(1, count_);
  return out;
}

double StageSums::mean_of(const char* name) const {
  for (const StageCost& stage : means())
    if (stage.name == name) return stage.cpu_ms;
  return 0;
}

std::vector<std::size_t> spread(std::size_t size, std::size_t count) {
  std::vector<std::size_t> out;
  count = std::min(count, size);
  for (std::size_t i = 0; i < count; ++i) out.push_back((2 * i + 1) * size / (2 * count));
  return out;
}

}  // namespace foresight
