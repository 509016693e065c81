// `foresight replay --refine`: better poses for a recorded run, from nothing that comes later.
#pragma once

#include <vector>

#include "apps/replay_report/replay_report.hpp"
#include "apps/replay_session.hpp"
#include "calibration/registration/correction_filter.hpp"
#include "calibration/registration/photometric_refinement.hpp"
#include "calibration/registration/tag_veto.hpp"

namespace foresight {

/// Aligns each image that has arrived to the model as textured by the images before it, and predicts
/// from that the poses of images that have not arrived. Where the run has tags.txt, tags in an image may veto
/// its refined pose: the given one is used then. One thread, the session's.
class ReplayRefinement {
 public:
  /// All must outlive this. `margin_px`: of poses without any error. Throws InputError for a tags.txt that is wrong.
  ReplayRefinement(const RunFolder& run, ReplaySession& session, double margin_px);

  /// The pose of the left camera at image `index` as it can be known when the images refined so far have
  /// arrived. Uses given poses up to `index`; ask in any order, `index` never below the refined ones.
  Pose predict(std::size_t index);

  /// Refines the poses of an image that has arrived, `index` in the run, and sets its margin.
  void refine(std::size_t index, PosedFrame& frame);

  const RefinementRecord& record() const { return record_; }
  std::vector<std::string> notes() const;  ///< what was done, for people

 private:
  void give(std::size_t index);
  double use(std::size_t index, const RefinementSummary& found, PosedFrame& frame);
  bool vetoed(std::size_t index, const RefinementSummary& found, const PosedFrame& frame);

  const RunFolder& run_;
  ReplaySession& session_;
  double margin_px_;
  CorrectionFilter filter_{CorrectionFilterOptions{}};
  std::optional<TagVeto> veto_;
  std::size_t given_ = 0;
  RefinementRecord record_;
  double moved_px_ = 0, sigma_px_ = 0, margins_ = 0, cpu_ms_ = 0;  // sums
  std::map<std::string, int> reasons_;
};

}  // namespace foresight
