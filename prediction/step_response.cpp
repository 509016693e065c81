#include "prediction/step_response.hpp"

#include <algorithm>
#include <cmath>

#include "prediction/few_samples.hpp"

namespace foresight {
namespace {

constexpr std::array kAgesAboutDelay{-0.1, -0.04, -0.02, -0.01, 0.0, 0.01, 0.02, 0.04, 0.08, 0.16, 0.32};  // s
constexpr double kFriction = 0.01;       // rad: what friction's share is a share of
constexpr double kFrictionSpeed = 0.02;  // rad/s: where friction is nearly all there
constexpr double kSpeedOver = 0.01;      // s to both sides
constexpr double kMayDiffer = 0.5;       // share of a change's time by which it may differ where states come seldom
constexpr double kDense = 0.006;         // s: commands so near on average are alike held or joined
constexpr double kAllSteps = 0, kAllLines = 0.5;
constexpr std::size_t kFewestChanges = 40;  // changes to learn from
constexpr std::size_t kEnough = 2000;       // more are left out, evenly
constexpr double kMoved = 1e-4;             // rad rms: commands that change less teach nothing
constexpr double kPriorsWeight = 4;         // inverse variance of a step's share about the pure delay's
constexpr double kLeastStepVariance = 1e-14;
constexpr double kResolution = 0.001;  // s that the steps of the ages leave open

// States before which `change` seconds, and before these `reach` of commands, are known.
struct Window {
  const PositionHistory& commands;
  const PositionHistory& states;
  std::size_t first = 0, stride = 1, count = 0;
  double change = 0, reach = 0, earliest = 0;

  // Visits a state, and what was measured about `change` earlier.
  template <typename Visit>
  void for_each_change(const Visit& visit) const {
    for (std::size_t i = first; i < states.values().size(); i += stride) {
      const TimedPosition now = states.values()[i];
      const auto then = states.measured_about(now.time - change, kMayDiffer * change);
      if (then && then->time >= earliest) visit(now, *then);
    }
  }
};

// Rest before the first motion teaches nothing, and how right all is then is no measure of what it will be.
double motion_begins(const LastOf<TimedPosition>& commands) {
  std::size_t i = 0;
  while (i + 1 < commands.size() && std::abs(commands[i].position - commands[0].position) < kMoved) ++i;
  return commands[i].time;
}

std::optional<Window> learning_window(const PositionHistory& commands, const PositionHistory& states) {
  if (states.empty() || commands.empty()) return {};
  const double begin = std::max(commands.values()[0].time, states.values()[0].time);
  const double seconds = states.values().newest().time - begin;
  Window window{commands, states};
  window.change = std::min(0.3, 0.25 * seconds);
  window.reach = std::min(0.5, 0.25 * seconds);
  window.earliest = begin + window.reach;
  const double from = std::max(window.earliest + window.change, motion_begins(commands.values()));
  while (window.first < states.values().size() && states.values()[window.first].time < from) ++window.first;
  window.stride = (states.values().size() - window.first) / kEnough + 1;
  double moved = 0;
  std::size_t count = 0;
  window.for_each_change([&](const TimedPosition& now, const TimedPosition& then) {
    const double way = commands.at(now.time, now.time) - commands.at(then.time, then.time);
    moved += way * way;
    ++count;
  });
  window.count = count;
  if (count < kFewestChanges || moved < kMoved * kMoved * static_cast<double>(count)) return {};
  return window;
}

// Whether it matters if commands are held or joined by lines.
bool are_sparse(const LastOf<TimedPosition>& commands) {
  return commands.newest().time - commands[0].time > kDense * static_cast<double>(commands.size() - 1);
}

double misfit(const Window& window, double delay, double sparse) {
  double sum = 0;
  window.for_each_change([&](const TimedPosition& now, const TimedPosition& then) {
    const double off = now.position - window.commands.at(now.time - delay, now.time, sparse) -
                       (then.position - window.commands.at(then.time - delay, then.time, sparse));
    sum += off * off;
  });
  return sum;
}

double best_delay(const Window& window, double sparse) {
  Window coarse = window;
  coarse.stride *= 4;
  double best = 0, least = misfit(coarse, 0, sparse);
  const auto consider = [&](const Window& some, double delay) {
    const double misfit_then = misfit(some, delay, sparse);
    if (misfit_then >= least) return;
    least = misfit_then;
    best = delay;
  };
  for (double delay = 0.002; delay <= window.reach; delay += delay < 0.06 ? 0.002 : delay < 0.2 ? 0.005 : 0.01)
    consider(coarse, delay);
  const double middle = best;
  least = misfit(window, middle, sparse);
  for (double off = -0.01; off <= 0.01; off += 0.001)
    if (middle + off >= 0 && middle + off <= window.reach) consider(window, middle + off);
  return best;
}

StepResponseFit fit(const Window& window, double sparse) {
  const auto count = static_cast<double>(window.count);
  StepResponseFit fit;
  fit.count = window.count;
  fit.first = window.states.values()[window.first].time;
  StepResponse& model = fit.model;
  model = StepResponse::pure_delay(best_delay(window, sparse), window.reach, sparse);
  const double before = std::max(kLeastStepVariance, misfit(window, model.delay, sparse) / count);
  fit.regression = {model.realised, Weights::Constant(model.realised.size(), kPriorsWeight * before), 1};
  const auto for_each_equation = [&](const auto& visit) {
    window.for_each_change([&](const TimedPosition& now, const TimedPosition& then) {
      const double base =
          model.base(window.commands, now.time, now.time) - model.base(window.commands, then.time, then.time);
      visit(model.inputs(window.commands, now.time, now.time) - model.inputs(window.commands, then.time, then.time),
            now.position - then.position - base);
    });
  };
  for_each_equation([&](const Weights& x, double y) { fit.regression.add(x, y); });
  model.realised = fit.regression.weights();
  window.for_each_change([&](const TimedPosition& now, const TimedPosition& then) {
    fit.moved += (now.position - then.position) * (now.position - then.position);
  });
  AlikeErrors errors;
  for_each_equation([&](const Weights& x, double y) { errors.add(y - x.dot(model.realised)); });
  fit.squares = errors.squares();
  fit.variance = std::max(kLeastStepVariance, fit.squares / count) * count / errors.independent();
  return fit;
}

}  // namespace

StepResponse StepResponse::pure_delay(double delay, double reach, double sparse) noexcept {
  StepResponse model;
  model.delay = delay;
  model.sparse = sparse;
  std::size_t count = 1;  // age 0
  for (const double about : kAgesAboutDelay)
    if (delay + about > model.ages[count - 1] && about <= reach) model.ages[count++] = delay + about;
  model.bins = count - 1;
  model.realised.setZero(static_cast<Eigen::Index>(count));
  for (std::size_t k = 0; k < model.bins; ++k)
    model.realised[static_cast<Eigen::Index>(k)] = model.ages[k] >= delay ? 1 : 0;
  return model;
}

// A step in a bin may be of any age between the bin's: the mean of 1 - exp(-(age - dead time) / lag) over them.
StepResponse StepResponse::lagging(double dead_time, double lag, double reach) noexcept {
  StepResponse model = pure_delay(dead_time + lag, reach);
  if (!(lag > 0)) return model;
  const auto remaining = [&](double age) { return std::exp(-std::max(age - dead_time, 0.0) / lag); };
  for (std::size_t k = 0; k < model.bins; ++k) {
    const double from = model.ages[k], to = model.ages[k + 1];
    const double acting = std::max(to, dead_time) - std::max(from, dead_time);
    model.realised[static_cast<Eigen::Index>(k)] = (acting - lag * (remaining(from) - remaining(to))) / (to - from);
  }
  return model;
}

double StepResponse::base(const PositionHistory& commands, double time, double until) const noexcept {
  return commands.at(time - ages[bins], until, sparse);
}

Weights StepResponse::inputs(const PositionHistory& commands, double time, double until) const noexcept {
  Weights x(static_cast<Eigen::Index>(bins + 1));
  double younger = commands.at(time, until, sparse);
  for (std::size_t k = 0; k < bins; ++k) {
    const double older = commands.at(time - ages[k + 1], until, sparse);
    x[static_cast<Eigen::Index>(k)] = younger - older;
    younger = older;
  }
  const double acting = time - delay;
  const double way = commands.at(acting + kSpeedOver, until, sparse) - commands.at(acting - kSpeedOver, until, sparse);
  x[static_cast<Eigen::Index>(bins)] = kFriction * std::tanh(way / (2 * kSpeedOver * kFrictionSpeed));
  return x;
}

double StepResponseFit::sigma(const Weights& inputs) const noexcept {
  return std::sqrt(variance * regression.spread(inputs));
}

ResponseFigures StepResponseFit::figures() const noexcept {
  Weights once = Weights::Zero(model.realised.size()), twice = once;  // moments are sums of these times the shares
  double mean = model.ages[model.bins], square = mean * mean;
  for (std::size_t k = 0; k < model.bins; ++k) {
    const auto at = static_cast<Eigen::Index>(k);
    once[at] = model.ages[k] - model.ages[k + 1];
    twice[at] = model.ages[k] * model.ages[k] - model.ages[k + 1] * model.ages[k + 1];
  }
  mean += once.dot(model.realised);
  square += twice.dot(model.realised);
  ResponseFigures figures;
  figures.delay = mean;
  figures.delay_sigma = std::hypot(kResolution, sigma(once));
  // A dead time d and a lag of time constant T: mean d + T, spread T.
  figures.lag = std::clamp(std::sqrt(std::max(0.0, square - mean * mean)), 0.0, std::max(0.0, mean));
  figures.dead_time = mean - figures.lag;
  const double steep = std::max(figures.lag, 0.001);  // dT = (d square - 2 mean d mean) / 2 T
  figures.dead_time_sigma = std::hypot(kResolution, sigma(once - (twice - 2 * mean * once) / (2 * steep)));
  figures.unexplained = std::sqrt(squares / static_cast<double>(std::max<std::size_t>(count, 1)));
  figures.explained = moved > 0 ? std::max(0.0, 1 - squares / moved) : 0;
  figures.samples = count;
  return figures;
}

std::optional<StepResponseFit> fit_step_response(const PositionHistory& commands,
                                                 const PositionHistory& states) noexcept {
  const auto window = learning_window(commands, states);
  if (!window) return {};
  StepResponseFit best = fit(*window, PositionHistory::kSparse);
  if (are_sparse(commands.values()))
    for (const double sparse : {kAllSteps, kAllLines})
      if (const StepResponseFit other = fit(*window, sparse); other.squares < best.squares) best = other;
  return best;
}

}  // namespace foresight
