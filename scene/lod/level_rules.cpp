#include "scene/lod/level_rules.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <queue>

namespace foresight {
namespace {

constexpr double kMostTolerance = 64;  // times the least
constexpr double kReaction = 0.5;      // of what would be right were time proportional

double error_px(const LevelCandidate& node, int level) {
  const double error = node.errors[static_cast<std::size_t>(level)];
  return error > 0 ? error * node.px_per_m : 0;  // at infinite sharpness the mesh itself is still exact
}

int coarsest(const LevelCandidate& node) {
  return static_cast<int>(node.errors.size()) - 1;
}

/// The levels of a frame and what they cost, changed step by step in the order of their worth.
class Knapsack {
 public:
  Knapsack(std::span<const LevelCandidate> nodes, const BudgetRule& rule) : nodes_(nodes), rule_(rule) {
    for (std::size_t i = 0; i < nodes.size(); ++i) {
      const LevelCandidate& node = nodes[i];
      const int last = std::clamp(node.last < 0 ? coarsest(node) : node.last, 0, coarsest(node));
      levels_.push_back(std::max(last, coarsest_within(node, rule.invisible_px, rule.hysteresis)));
      cost_ += rule.ms_per_node + cost(node, levels_.back());
      offer(i);
    }
  }

  void fill() {
    while (cost_ > rule_.budget_ms)
      if (const auto step = next(coarser_))
        take(*step);
      else
        return;
    std::size_t trades = nodes_.size();
    while (const auto step = next(finer_)) {
      if (cost_ + step->price <= rule_.budget_ms)
        take(*step);
      else if (trades > 0) {
        --trades;
        trade(*step);
      }
    }
  }
  const std::vector<int>& levels() const { return levels_; }

 private:
  struct Step {
    double worth = 0;  // benefit for cost: what is gained, or, of coarser levels, kept
    std::size_t node = 0;
    int from = 0, to = 0;
    double gain = 0, price = 0;  // negative of coarser levels
    bool operator<(const Step& other) const { return worth != other.worth ? worth < other.worth : node > other.node; }
  };
  using Queue = std::priority_queue<Step>;

  double cost(const LevelCandidate& node, int level) const {
    return rule_.ms_per_triangle * static_cast<double>(node.triangles[static_cast<std::size_t>(level)]);
  }
  double benefit(const LevelCandidate& node, int level) const {
    constexpr double kMostArea = 1e7;  // px: a box around the eye takes all that is seen, but does not drown all others
    const double error = std::max(0.0, error_px(node, level) * node.acuity - rule_.invisible_px);
    const double accuracy = 1 / (1 + error / rule_.px);
    const int steps = node.last < 0 ? 0 : std::abs(level - node.last);
    const double hysteresis = 1 - rule_.hysteresis * steps / (1.0 + steps);
    return std::min(node.area_px, kMostArea) * node.importance * node.acuity * accuracy * hysteresis;
  }
  void offer(std::size_t i) {
    const LevelCandidate& node = nodes_[i];
    const int from = levels_[i];
    for (const int to : {from - 1, from + 1}) {
      if (to < 0 || to > coarsest(node)) continue;
      const double gain = benefit(node, to) - benefit(node, from), price = cost(node, to) - cost(node, from);
      const bool is_exact = error_px(node, from) * node.acuity <= rule_.invisible_px;
      if (to < from && (is_exact || !(gain > 0))) continue;
      (to < from ? finer_ : coarser_).push({gain / std::max(std::abs(price), 1e-12), i, from, to, gain, price});
    }
  }
  /// The most worthy one whose node has not changed since.
  std::optional<Step> next(Queue& queue) {
    while (!queue.empty()) {
      const Step step = queue.top();
      queue.pop();
      if (levels_[step.node] == step.from) return step;
    }
    return std::nullopt;
  }
  void take(const Step& step) {
    levels_[step.node] = step.to;
    cost_ += step.price;
    offer(step.node);
  }
  /// Takes it, and makes others coarser until it fits; takes all of that back where it gains nothing.
  void trade(const Step& wanted) {
    const double cost_before = cost_;
    double gain = wanted.gain;
    std::vector<Step> taken{wanted};
    take(wanted);
    while (cost_ > rule_.budget_ms && gain > 0) {
      const auto step = next(coarser_);
      if (!step || step->node == wanted.node) break;
      taken.push_back(*step);
      gain += step->gain;
      take(*step);
    }
    if (cost_ <= rule_.budget_ms && gain > 0) return;
    while (!taken.empty()) {
      const Step& step = taken.back();
      levels_[step.node] = step.from;
      // What it offered before; but for the wanted step, which is not tried again.
      if (step.node != wanted.node) offer(step.node);
      taken.pop_back();
    }
    cost_ = cost_before;
  }

  std::span<const LevelCandidate> nodes_;
  const BudgetRule& rule_;
  std::vector<int> levels_;
  Queue finer_, coarser_;
  double cost_ = 0;
};

}  // namespace

int coarsest_within(const LevelCandidate& node, double px, double hysteresis) {
  const double allowed = px / node.acuity;
  const auto within = [&](double limit) {
    int level = 0;
    while (level < coarsest(node) && error_px(node, level + 1) <= limit) ++level;
    return level;
  };
  if (node.last < 0 || hysteresis <= 0) return within(allowed);
  // The last one stays between what would be chosen with a stricter and with a laxer limit.
  return std::clamp(node.last, within(allowed / (1 + hysteresis)), within(allowed * (1 + hysteresis)));
}

void ReactiveTolerance::took(double ms, double budget_ms) {
  if (!std::isfinite(ms) || ms < 0 || !(budget_ms > 0)) return;
  const double ratio = std::clamp(ms / budget_ms, 0.25, 4.0);
  px_ = std::clamp(px_ * std::pow(ratio, kReaction), least_, kMostTolerance * least_);
}

std::vector<int> levels_within_budget(std::span<const LevelCandidate> nodes, const BudgetRule& rule) {
  Knapsack knapsack(nodes, rule);
  knapsack.fill();
  return knapsack.levels();
}

}  // namespace foresight
