// Both pipelines in one process and one context, fed with the same frames.
#pragma once

#include <memory>
#include <vector>

#include "gl/context.hpp"
#include "scene/run_folder.hpp"
#include "texture_gpu/texture_core.hpp"
#include "texture_gpu/thesis/thesis_pipeline.hpp"

namespace foresight {

/// Throws InputError where the thesis' pipeline cannot take the run's left lens.
void require_thesis_lens(const RunFolder& run);

/// A core on the calling thread, with the place it publishes to. All that an image costs is done when process()
/// returns.
class BenchCore {
 public:
  BenchCore(std::shared_ptr<const SceneModel> scene, std::shared_ptr<const SurfacePatches> surface, const Lens& lens,
            const TextureOptions& options, bool software_renderer)
      : surface_(std::move(surface)),
        core_(std::move(scene), surface_, lens, std::nullopt, options, software_renderer) {}

  /// Throws RuntimeFailure where the frame could not be published.
  ExtractionReport process(const PosedFrame& frame);
  /// The same; the image itself goes to `newest` before.
  ExtractionReport process(const PosedFrame& frame, LatestImages& newest);

  const LatestTextures& textures() const { return latest_; }
  const std::shared_ptr<const SurfacePatches>& surface() const { return surface_; }

 private:
  std::shared_ptr<const SurfacePatches> surface_;
  LatestTextures latest_;
  TextureCore core_;
};

/// CPU-ms of the whole process that `work` takes.
template <typename Work>
double cpu_ms_of(Work&& work) {
  const double before = process_cpu_ms();
  work();
  return process_cpu_ms() - before;
}

/// Adds up stages by name, in the order of their first appearance.
class StageSums {
 public:
  void add(const ExtractionReport& report);
  /// Mean per added report, CPU-ms.
  std::vector<StageCost> means() const;
  double mean_of(const char* stage) const;  ///< 0 where there is none

 private:
  std::vector<StageCost> sums_;
  int count_ = 0;
};

/// `count` places spread evenly over 0 .. size - 1, without repetition.
std::vector<std::size_t> spread(std::size_t size, std::size_t count);

}  // namespace foresight
