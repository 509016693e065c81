#include "apps/posed_frames.hpp"

#include <algorithm>

#include "texture_gpu/chart_extent.hpp"

namespace foresight {
namespace {

/// A few views spread over the run.
std::vector<ExpectedView> some_views(const RunFolder& run) {
  constexpr std::size_t kMost = 12;
  const auto& frames = run.frames();
  std::vector<ExpectedView> views;
  for (std::size_t i = 0; i < frames.size(); i += std::max<std::size_t>(1, frames.size() / kMost))
    views.push_back({frames[i].left.T_world_camera, run.state_at(frames[i].left.time)});
  return views;
}

}  // namespace

PosedFrame load_posed_frame(const RunFolder& run, std::size_t index) {
  const auto posed = [&](const RunImage& image, const Lens& lens) {
    return PosedImage{read_run_image(image, lens), image.time, image.T_world_camera, run.state_at(image.time)};
  };
  const RunFrame& frame = run.frames()[index];
  PosedFrame out{posed(frame.left, run.lens_left()), std::nullopt};
  if (frame.right) out.right = posed(*frame.right, *run.lens_right());
  return out;
}

std::shared_ptr<const SurfacePatches> surface_for(const RunFolder& run) {
  PatchOptions patches;
  patches.chart_extent = chart_extent_for(*run.scene(), run.lens_left(), some_views(run));
  return std::make_shared<const SurfacePatches>(find_surface_patches(*run.scene(), patches));
}

}  // namespace foresight
