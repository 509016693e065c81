#include "apps/replay_refinement.hpp"

#include <fmt/core.h>

#include <Eigen/Cholesky>
#include <algorithm>

#include "apps/posed_frames.hpp"
#include "calibration/registration/calibrated_head.hpp"
#include "common/cpu_time.hpp"

namespace foresight {
namespace {

std::optional<TagVeto> veto_for(const RunFolder& run) {
  const std::filesystem::path tags = run.root() / "tags.txt";
  if (!std::filesystem::exists(tags)) return std::nullopt;
  return std::optional<TagVeto>(
      std::in_place, StereoLenses{run.lens_left(), run.lens_right().value_or(run.lens_left()), run.T_left_right()},
      read_tag_map(tags), TagDetector::Options{});
}

/// How sure a refined pose is once its gauge counts too.
Matrix6d with_gauge(const RefinementSummary& found, double gauge_px) {
  return found.covariance + gauge_px * gauge_px / 6 * found.px_metric.ldlt().solve(Matrix6d::Identity());
}

}  // namespace

ReplayRefinement::ReplayRefinement(const RunFolder& run, ReplaySession& session, double margin_px)
    : run_(run), session_(session), margin_px_(margin_px), veto_(veto_for(run)) {}

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
      sigma_px = use(index, found, frame);
    } else {
      ++record_.refused;
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

bool ReplayRefinement::vetoed(std::size_t index, const RefinementSummary& found, const PosedFrame& frame) {
  if (!veto_) return false;
  const RefinedPose pose{run_.frames()[index].left.T_world_camera, found.T_world_camera,
                         with_gauge(found, filter_.gauge_px())};
  const TagVerdict verdict = veto_->judge(pose, frame.left.pixels, frame.right ? frame.right->pixels : cv::Mat());
  if (verdict != TagVerdict::unseen) ++record_.with_tags;
  return verdict == TagVerdict::object;
}

/// Sets the left pose; returns its expected error in px. A vetoed one tells the filter that the given pose was right.
double ReplayRefinement::use(std::size_t index, const RefinementSummary& found, PosedFrame& frame) {
  const bool refused = vetoed(index, found, frame);
  const Pose& used = refused ? run_.frames()[index].left.T_world_camera : found.T_world_camera;
  frame.left.T_world_camera = filter_.add_refined(frame.left.time, used, found.px_metric);
  if (refused) {
    ++record_.vetoed;
    return run_.frames()[index].left.predicted_px.value_or(0);
  }
  ++record_.refined;
  moved_px_ += found.moved_px;
  sigma_px_ += found.sigma_px;
  return std::hypot(found.sigma_px, filter_.gauge_px());
}

std::vector<std::string> ReplayRefinement::notes() const {
  std::vector<std::string> out;
  const double n = std::max<double>(1, static_cast<double>(record_.refined));
  out.push_back(fmt::format(
      "Poses refined of {} images, by {:.2f} px from their prediction, sigma {:.2f} px; {} refused; mean margin {:.1f} "
      "px; {:.0f} CPU-ms each.",
      record_.refined, moved_px_ / n, sigma_px_ / n, record_.refused,
      margins_ / static_cast<double>(record_.refined + record_.refused + record_.vetoed + 1), cpu_ms_ / n));
  if (record_.refined > 0 && !filter_.helps())
    out.emplace_back("In the end the refined poses were not used: they made the motion rougher.");
  if (veto_)
    out.push_back("Tags were seen in " + std::to_string(record_.with_tags) + " images with a refined pose and vetoed " +
                  std::to_string(record_.vetoed) + " of these: the given ones were used.");
  for (const auto& [reason, count] : reasons_)
    out.push_back("Refused, " + std::to_string(count) + " images: " + reason + ".");
  return out;
}

}  // namespace foresight
