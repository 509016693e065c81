#include "apps/replay_refinement.hpp"

#include <algorithm>
#include <cstdio>

#include "apps/posed_frames.hpp"
#include "common/cpu_time.hpp"

namespace foresight {

void ReplayRefinement::give(std::size_t index) {
  for (; given_ <= index; ++given_) {
    const RunImage& image = run_.frames()[given_].left;
    filter_.add_given(image.time, image.T_world_camera);
  }
}

Pose ReplayRefinement::predict(std::size_t index) {
  give(index);
  return filter_.predict(run_.frames()[index].left.time).T_world_camera;
}

void ReplayRefinement::refine(std::size_t index, PosedFrame& frame) {
  const double before = process_cpu_ms();
  give(index);
  const auto prediction = filter_.predict(frame.left.time);
  const Pose T_left_right =
      frame.right ? frame.left.T_world_camera.inverse() * frame.right->T_world_camera : Pose::Identity();
  double sigma_px = prediction.sigma_px;
  frame.left.T_world_camera = prediction.T_world_camera;
  if (const auto view = session_.render(prediction.T_world_camera, frame.left.scene)) {
    const RefinementSummary found = refine_pose(run_.lens_left(), *view, frame.left.pixels, {});
    if (found.accepted) {
      frame.left.T_world_camera = filter_.add_refined(frame.left.time, found.T_world_camera, found.px_metric);
      ++refined_;
      moved_px_ += found.moved_px;
      sigma_px_ += found.sigma_px;
      sigma_px = std::hypot(found.sigma_px, filter_.gauge_px());
    } else {
      ++refused_;
      ++reasons_[found.reason];
    }
  } else {
    filter_.add_refined(frame.left.time, frame.left.T_world_camera, Matrix6d::Zero());  // the gauge
  }
  if (frame.right) frame.right->T_world_camera = frame.left.T_world_camera * T_left_right;
  const double margin = margin_for(margin_px_, sigma_px);
  frame.left.margin_px = margin;
  if (frame.right) frame.right->margin_px = margin;
  margins_ += margin;
  cpu_ms_ += process_cpu_ms() - before;
}

std::vector<std::string> ReplayRefinement::notes() const {
  std::vector<std::string> out;
  char text[256];
  const double n = std::max<double>(1, static_cast<double>(refined_));
  std::snprintf(text, sizeof text,
                "Poses refined of %zu images, by %.2f px from their prediction, sigma %.2f px; %zu refused; mean "
                "margin %.1f px; %.0f CPU-ms each.",
                refined_, moved_px_ / n, sigma_px_ / n, refused_,
                margins_ / static_cast<double>(std::max<std::size_t>(1, refined_ + refused_ + 1)), cpu_ms_ / n);
  out.emplace_back(text);
  if (refined_ > 0 && !filter_.helps())
    out.emplace_back("In the end the refined poses were not used: they made the motion rougher.");
  for (const auto& [reason, count] : reasons_)
    out.push_back("Refused, " + std::to_string(count) + " images: " + reason + ".");
  return out;
}

}  // namespace foresight
