// `foresight replay --refine`: better poses for a recorded run, from nothing that comes later.
#pragma once

#include <vector>

#include "apps/replay_report/replay_report.hpp"
#include "calibration/registration/correction_filter.hpp"
#include "calibration/registration/photometric_refinement.hpp"
#include "calibration/registration/tag_veto.hpp"
#include "display/recorded_source.hpp"
#include "display/view_session.hpp"

namespace foresight {

/// Aligns each image that has arrived to the model as textured by the images before it, and predicts
/// from that the poses of images that have not arrived. Where the run has tags.txt, tags in an image may veto
/// its refined pose: the given one is used then. One thread, the session's.
class ReplayRefinement final : public FrameSource {
 public:
  /// All must outlive this. `margin_px`: of poses without any error. Throws InputError for a tags.txt that is wrong.
  ReplayRefinement(const RunFolder& run, RecordedSource& source, ViewSession& session, double margin_px);

  bool real_time() const override { return source_.real_time(); }
  SourceState advance() override { return source_.advance(); }
  const ShownInstant& instant() const override { return source_.instant(); }
  /// With refined poses and a margin for them.
  std::optional<PosedFrame> arrived() override;
  /// With the camera's pose as it can be known when the images refined so far have arrived; uses given poses up to the
  /// instant.
  ViewPlace place() override;
  cv::Mat actual() override { return source_.actual(); }
  std::uint64_t overtaken() const override { return source_.overtaken(); }

  /// Counts, and what was done in words, as notes.
  void report(RunRecord& record) const;

 private:
  Pose predict(std::size_t index);
  void refine(std::size_t index, PosedFrame& frame);
  std::optional<RenderedView> render(const Pose& T_world_camera, const SceneState& state);
  std::vector<std::string> notes() const;
  void give(std::size_t index);
  double use(std::size_t index, const RefinementSummary& found, PosedFrame& frame);
  bool vetoed(std::size_t index, const RefinementSummary& found, const PosedFrame& frame);

  const RunFolder& run_;
  RecordedSource& source_;
  ViewSession& session_;
  double margin_px_;
  CorrectionFilter filter_{CorrectionFilterOptions{}};
  std::optional<TagVeto> veto_;
  std::size_t given_ = 0;
  RefinementRecord record_;
  double moved_px_ = 0, sigma_px_ = 0, margins_ = 0, cpu_ms_ = 0;  // sums
  std::map<std::string, int> reasons_;
};

}  // namespace foresight
