#include "calibration/camera/model_choice.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "calibration/camera/held_out.hpp"
#include "calibration/camera/rig_start.hpp"
#include "calibration/camera/uncertainty.hpp"
#include "common/error.hpp"

namespace foresight {
namespace {

constexpr std::size_t kTrialViews = 20;
constexpr int kTrialGroups = 5;    // of views left out together
constexpr double kBetter = 0.95;   // a richer lens model must lower the held-out error to this part
constexpr double kFar = 1.15;      // misfit over the least one: out
constexpr double kMostError = 10;  // px; beyond, a corner is wrong rather than badly explained

// Mean error of all corners, also of the rejected ones: a model that cannot follow the lens has its errors at the rim
// of the image, where they are taken for outliers.
double misfit(const RigViews& views, const RigSolution& solution) {
  double sum = 0;
  std::size_t count = 0;
  for (const auto& view : rig_errors(views, solution))
    for (const auto& errors : view)
      for (const Eigen::Vector2d& error : errors) sum += std::min(error.norm(), kMostError), ++count;
  return sum / static_cast<double>(std::max<std::size_t>(1, count));
}

RigSolverOptions rough(const RigSolverOptions& options) {
  RigSolverOptions few = options;
  few.warp = false;
  few.most_rounds = std::min(3, options.most_rounds);
  few.most_iterations = std::min(30, options.most_iterations);
  return few;
}

// Of each camera alone, summed; perspective models follow one another, each from the last one's solution.
class Screening {
 public:
  Screening(const RigViews& views, const RigSolverOptions& options) : options_(rough(options)) {
    for (int c = 0; c < views.cameras; ++c) {
      const RigViews all = views_of(views, c).views;
      cameras_.push_back(subset(all, spread_views(all, kTrialViews)));
    }
  }

  double operator()(Distortion model) {
    double sum = 0;
    for (std::size_t c = 0; c < cameras_.size(); ++c) {
      RigSolution start;
      if (model == Distortion::radtan4 || model == Distortion::equidistant || last_.size() <= c) {
        start = start_camera(cameras_[c], model);
      } else {
        start = last_[c];
        start.rejected.clear();
        start.rig.cameras[0].distortion = model;
      }
      RigSolution solution = solve_rig(cameras_[c], start, options_);
      sum += misfit(cameras_[c], solution);
      if (model == Distortion::equidistant) continue;
      last_.resize(std::max(last_.size(), c + 1));
      last_[c] = std::move(solution);
    }
    return sum;
  }

 private:
  RigSolverOptions options_;
  std::vector<RigViews> cameras_;
  std::vector<RigSolution> last_;
};

RigSolution with_model(const RigViews& views, const RigSolution& solution, Distortion model,
                       const RigSolverOptions& options) {
  const bool other_family =
      model == Distortion::equidistant || solution.rig.cameras[0].distortion == Distortion::equidistant;
  if (other_family) return solve_from_nothing(views, model, options);
  RigSolution start = solution;
  for (CameraModel& camera : start.rig.cameras) camera.distortion = model;
  return solve_rig(views, start, options);
}

struct Trial {
  RigSolution solution;
  HeldOutScore score;
};

class Trials {
 public:
  Trials(const RigViews& views, const RigSolution& solution, const RigSolverOptions& options)
      : options_(options), views_(views) {
    base_.solution = solution;
    if (views.views.size() > kTrialViews) {
      const auto indices = spread_views(views, kTrialViews);
      views_ = subset(views, indices);
      base_.solution = solve_rig(views_, subset(solution, indices), options);
    }
  }

  /// Whether the model predicts better than those that were tried before.
  bool improves(Distortion model) {
    try {
      Trial trial{with_model(views_, base_.solution, model, options_), {}};
      // What does not even fit better cannot predict better.
      if (!(trial.solution.noise_px < kBetter * base_.solution.noise_px)) return false;
      if (!RigUncertainty(views_, trial.solution, options_.warp).usable()) return false;
      trial.score = score(trial.solution);
      if (!best_) best_ = score(base_.solution);
      if (!(trial.score.joint_px < kBetter * best_->joint_px && trial.score.cross_px <= best_->cross_px)) return false;
      best_ = trial.score;
      return true;
    } catch (const InputError&) {
      return false;  // a lens that cannot even be solved for is none to choose
    }
  }

 private:
  HeldOutScore score(const RigSolution& solution) const {
    return leave_out(views_, views_, solution, options_, kTrialGroups).score;
  }

  const RigSolverOptions& options_;
  RigViews views_;
  Trial base_;
  std::optional<HeldOutScore> best_;
};

// Where the board is in each camera, and how large, as shares of the image.
Eigen::Matrix<double, 6, 1> place_of(const RigViews& views, const RigView& view) {
  Eigen::Matrix<double, 6, 1> place = Eigen::Matrix<double, 6, 1>::Zero();
  for (int c = 0; c < views.cameras; ++c) {
    const auto& corners = view.corners[static_cast<std::size_t>(c)];
    if (corners.empty()) continue;
    Eigen::AlignedBox2d box;
    for (const Corner& corner : corners) box.extend(corner.pixel);
    const Eigen::Vector2d at = box.center() / std::max(1, views.width[static_cast<std::size_t>(c)]);
    place.segment<3>(3 * c) << at.x(), at.y(),
        box.sizes().norm() / std::max(1, views.width[static_cast<std::size_t>(c)]);
  }
  return place;
}

}  // namespace

std::vector<std::size_t> spread_views(const RigViews& views, std::size_t most) {
  const std::size_t n = views.views.size();
  std::vector<std::size_t> taken;
  if (n <= most) {
    for (std::size_t v = 0; v < n; ++v) taken.push_back(v);
    return taken;
  }
  std::vector<Eigen::Matrix<double, 6, 1>> places;
  for (const RigView& view : views.views) places.push_back(place_of(views, view));
  std::vector<double> distance(n, std::numeric_limits<double>::infinity());
  std::size_t next = 0;
  for (std::size_t v = 0; v < n; ++v)  // one that all cameras saw comes first
    if (views.cameras == 1 || views.views[v].both()) {
      next = v;
      break;
    }
  while (taken.size() < most) {
    taken.push_back(next);
    for (std::size_t v = 0; v < n; ++v) {
      const bool useful = views.cameras == 1 || views.views[v].both();
      distance[v] = useful ? std::min(distance[v], (places[v] - places[next]).norm()) : -1;
    }
    next = static_cast<std::size_t>(std::max_element(distance.begin(), distance.end()) - distance.begin());
    if (!(distance[next] > 0)) break;
  }
  std::sort(taken.begin(), taken.end());
  return taken;
}

ModelScreening screen_models(const RigViews& views, const RigSolverOptions& options) {
  Screening screening(views, options);
  std::vector<std::pair<Distortion, double>> found;
  std::exception_ptr failure;
  double least = std::numeric_limits<double>::infinity();
  for (const Distortion model :
       {Distortion::radtan4, Distortion::equidistant, Distortion::radtan5, Distortion::rational}) {
    try {
      found.emplace_back(model, screening(model));
      least = std::min(least, found.back().second);
    } catch (const InputError&) {
      if (!failure) failure = std::current_exception();
    }
  }
  if (found.empty()) std::rethrow_exception(failure);
  std::erase_if(found, [&](const auto& model) { return model.second > kFar * least; });
  ModelScreening result{found.front().first, {}};
  for (const auto& [model, error] : found)
    if (error < found.front().second) result.richer.push_back(model);
  return result;
}

std::optional<RigSolution> better_model(const RigViews& views, const RigSolution& solution,
                                        const std::vector<Distortion>& models, const RigSolverOptions& options) {
  if (models.empty()) return std::nullopt;
  std::optional<Distortion> best;
  Trials trials(views, solution, options);
  for (const Distortion model : models)
    if (trials.improves(model)) best = model;
  if (!best) return std::nullopt;
  return with_model(views, solution, *best, options);
}

}  // namespace foresight
