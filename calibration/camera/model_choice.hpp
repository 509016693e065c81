// Which lens model the views call for, where none was asked for.
//
// Two steps, as the perspective models take long to fail on a fish-eye. First every camera alone, on
// a few views that spread over the image, with every model: those whose misfit is far above the least
// one are out. Then, of those left, the one that predicts views left out best; of models that predict
// alike the one with the fewest parameters. Thin-prism is never chosen: nothing else here can draw it.
#pragma once

#include "calibration/camera/rig_solver.hpp"

namespace foresight {

struct ModelScreening {
  Distortion simplest = Distortion::radtan4;  ///< that fits about as well as any
  std::vector<Distortion> richer;             ///< that fit better still, in the order in which to try them
};

/// Throws InputError, that of radtan4, where no model can be solved for.
ModelScreening screen_models(const RigViews& views, const RigSolverOptions& options);

/// The solution with that of the `models` which predicts views left out better than `solution` does:
/// joint error lower by 5 %, cross error not higher, in five groups of at most 20 views. Nothing
/// where none does.
std::optional<RigSolution> better_model(const RigViews& views, const RigSolution& solution,
                                        const std::vector<Distortion>& models, const RigSolverOptions& options);

/// At most `most` of the views, those that differ most in place and size of the board in the images;
/// ascending.
std::vector<std::size_t> spread_views(const RigViews& views, std::size_t most);

}  // namespace foresight
