#include "prediction/joint_response.hpp"

#include <algorithm>
#include <cmath>

#include "prediction/few_samples.hpp"
#include "prediction/rate_limit.hpp"

namespace foresight {
namespace {

constexpr double kLongestAge = 0.32;                      // s beyond the delay, until something was identified
constexpr std::size_t kCommands = 32768, kStates = 8192;  // half a minute at 1 kHz and at 250 Hz
constexpr double kLongestGap = 0.15;                      // s between states that what lies between is known for
constexpr std::size_t kFewest = 30;                       // changes to learn from
constexpr double kLeastVariance = 1e-14;
constexpr double kLeastSigma = 1e-7;                  // rad
constexpr double kSigmaOver = 5;                      // s
constexpr std::array kHorizon{0.03, 0.1, 0.3, 1.0};   // s
constexpr std::array kMeanOver{0.0, 0.02, 0.2, 2.0};  // s
constexpr double kGuessEvery = 0.01;                  // s
constexpr double kFarMore = 0.5;                      // of the squares that are left unexplained
constexpr double kAsSure = 1.2;                       // times the sigma of what is known
constexpr double kContradicts = 3;                    // sigmas off from what is known
constexpr std::array kSpeeds{1.0, 0.98, 0.95, 1.03};  // of the largest speed seen
constexpr std::size_t kRestTerms = kMeanOver.size() - 1;

Weights rest_inputs(const std::array<double, kMeanOver.size()>& means) {
  Weights x(kRestTerms);
  for (std::size_t k = 0; k < kRestTerms; ++k) x[static_cast<Eigen::Index>(k)] = means[k] - means.back();
  return x;
}

void carry_on(std::array<double, kMeanOver.size()>& means, double seconds, double unexplained) {
  for (std::size_t k = 0; k < means.size(); ++k)
    means[k] += (1 - (kMeanOver[k] > 0 ? std::exp(-seconds / kMeanOver[k]) : 0)) * (unexplained - means[k]);
}

bool outdoes(const ResponseFigures& found, const KnownResponse& known) {
  const double off = std::abs(found.delay - known.dead_time - known.lag);
  return found.delay_sigma <= kAsSure * known.sigma || off > kContradicts * std::hypot(found.delay_sigma, known.sigma);
}

// Where `ahead` lies between the horizons: the earlier one's index, and the share of the next.
std::pair<std::size_t, double> between_horizons(double ahead) {
  std::size_t i = 0;
  while (i + 2 < kHorizon.size() && ahead > kHorizon[i + 1]) ++i;
  const double share = std::log(std::max(ahead, 1e-9) / kHorizon[i]) / std::log(kHorizon[i + 1] / kHorizon[i]);
  return {i, std::clamp(share, 0.0, 1.0)};
}

}  // namespace

JointResponse::JointResponse(const JointResponseOptions& options)
    : options_(options),
      asked_(kCommands),
      commands_(kCommands),
      states_(kStates),
      tried_(kCommands),
      assumed_(options.known.value_or(KnownResponse{})),
      fit_{StepResponse::lagging(assumed_.dead_time, assumed_.lag, kLongestAge), {}},
      learnt_means_(kStates),
      learnt_unexplained_(kStates),
      learnt_off_(kStates) {
  static_assert(kHorizon.size() == kHorizons && kMeanOver.size() == kMeans);
  for (const double horizon : kHorizon) {
    const auto guesses = static_cast<std::size_t>(std::ceil(horizon / kGuessEvery)) + 2;
    rests_.push_back({Weights::Constant(kRestTerms, 0.3),
                      CalibratedSigma(options.first_sigma, kLeastSigma, kSigmaOver, CalibratedSigma::kScaleOfOne),
                      LastOf<PredictedAt>(guesses), identified()});
  }
}

bool JointResponse::command(double time, double position) noexcept {
  if (!asked_.add(time, position)) return false;
  append_limited(commands_, {time, position}, speed_);
  return true;
}

bool JointResponse::observe(double time, double position, bool typical) noexcept {
  if (!std::isfinite(time) || !std::isfinite(position) || commands_.empty()) return false;
  if (observed_ && !(time > newest_.time)) return false;
  const TimedPosition before = newest_, now{time, position};
  const double unexplained = position - fit_.model.output(commands_, time);
  if (!observed_ || time - before.time > options_.stale) {
    means_.fill(unexplained);
    for (Rest& rest : rests_) rest.guesses.clear();
  } else {
    carry_on(means_, time - before.time, unexplained);
    judge(before, now);
  }
  newest_ = now;
  observed_ = true;
  inputs_now_ = fit_.model.inputs(commands_, time, time);
  if (typical && (states_.empty() || time - states_.values().newest().time >= options_.least_step))
    states_.add(time, position);
  guess();
  return true;
}

// By the commands as they are known by now: those that were expected and did not come are no matter of the drive.
void JointResponse::judge(const TimedPosition& before, const TimedPosition& now) noexcept {
  for (Rest& rest : rests_)
    for (; !rest.guesses.empty() && rest.guesses[0].time <= now.time; rest.guesses.drop_oldest()) {
      const PredictedAt& guess = rest.guesses[0];
      const double truth =
          std::lerp(before.position, now.position, (guess.time - before.time) / (now.time - before.time));
      const double off = std::abs(fit_.model.output(commands_, guess.time) + guess.unexplained - truth);
      rest.sigma.score(CalibratedSigma::usual_part(off, guess.sigma), guess.sigma, kGuessEvery);
    }
}

void JointResponse::guess() noexcept {
  for (std::size_t i = 0; i < kHorizons; ++i) {
    auto& guesses = rests_[i].guesses;
    const double then = newest_.time + kHorizon[i];
    if (!guesses.empty() && then - guesses.newest().time < kGuessEvery) continue;
    // Commands that are not known yet would make another prediction of it than the one that is asked for then.
    if (asked_.values().newest().time < then) continue;
    const PredictedPosition predicted = at(then);
    if (predicted.valid) guesses.next() = {then, rest(kHorizon[i]), predicted.sigma};
  }
}

template <typename Visit>
void JointResponse::for_each_guess(const Visit& visit) noexcept {
  for (Rest& rest : rests_)
    for (std::size_t k = 0; k < rest.guesses.size(); ++k) visit(rest.guesses[k]);
}

void JointResponse::limit_commands(PositionHistory& limited, double speed) const noexcept {
  limited.clear();
  for (std::size_t i = 0; i < asked_.values().size(); ++i) append_limited(limited, asked_.values()[i], speed);
}

// Where commands ask for more speed than was ever seen, the drive may have a largest one. It has where that explains
// far more.
void JointResponse::find_speed(StepResponseFit& best) noexcept {
  const double before = speed_;
  speed_ = std::numeric_limits<double>::infinity();
  const auto reached = speed_reached(asked_, states_);
  if (reached) {
    double least = kFarMore * best.squares / static_cast<double>(best.count);
    for (const double share : kSpeeds) {
      limit_commands(tried_, share * *reached);
      const auto found = fit_step_response(tried_, states_);
      if (!found || found->squares / static_cast<double>(found->count) >= least) continue;
      least = found->squares / static_cast<double>(found->count);
      speed_ = share * *reached;
      best = *found;
    }
  }
  if (speed_ != before) limit_commands(commands_, speed_);
}

void JointResponse::forget_states_after(double time) noexcept {
  const bool any = !states_.empty() && states_.values().newest().time > time;
  states_.forget_after(time);
  if (any && learnt_) identify();
}

bool JointResponse::identify() noexcept {
  auto found = fit_step_response(asked_, states_);
  if (!found) return false;
  if (!learnt_ && options_.known && !outdoes(found->figures(), *options_.known)) return false;
  for_each_guess([&](PredictedAt& guess) { guess.unexplained += fit_.model.output(commands_, guess.time); });
  find_speed(*found);
  fit_ = *found;
  for_each_guess([&](PredictedAt& guess) { guess.unexplained -= fit_.model.output(commands_, guess.time); });
  figures_ = fit_.figures();
  std::size_t first = 0;
  while (states_.values()[first].time < fit_.first) ++first;
  learn_rest(first);
  learnt_ = true;
  inputs_now_ = fit_.model.inputs(commands_, newest_.time, newest_.time);
  return true;
}

void JointResponse::learn_rest(std::size_t first) noexcept {
  const auto& states = states_.values();
  Means means{};
  for (std::size_t i = first; i < states.size(); ++i) {
    const double unexplained = states[i].position - fit_.model.output(commands_, states[i].time);
    const double seconds = i == first ? 0 : states[i].time - states[i - 1].time;
    if (i == first || seconds > options_.stale)
      means.fill(unexplained);
    else
      carry_on(means, seconds, unexplained);
    learnt_unexplained_[i] = unexplained;
    learnt_means_[i] = means;
  }
  means_ = means;
  for (std::size_t h = 0; h < kHorizons; ++h) learn_rest(first, h);
}

void JointResponse::learn_rest(std::size_t first, std::size_t horizon) noexcept {
  const auto& states = states_.values();
  Rest& rest = rests_[horizon];
  const auto for_each_pair = [&](const auto& visit) {
    for (std::size_t i = first, then = first; i < states.size(); ++i) {
      while (then < states.size() && states[then].time < states[i].time + kHorizon[horizon]) ++then;
      if (then == states.size()) return;
      if (states[then].time - states[then - 1].time <= kLongestGap)
        visit(rest_inputs(learnt_means_[i]), learnt_unexplained_[then] - learnt_means_[i].back());
    }
  };
  double variance = kLeastVariance;
  std::size_t count = 0;
  for_each_pair([&](const Weights& x, double) {
    variance += x[0] * x[0];
    ++count;
  });
  if (count < kFewest) {  // too short a recording so far: the nearer horizon knows most
    if (rest.is_own || horizon == 0) return;
    const double wider = std::sqrt(kHorizon[horizon] / kHorizon[horizon - 1]);  // as of a random walk
    rest.sigma = CalibratedSigma(wider * rests_[horizon - 1].sigma.sigma(), kLeastSigma, kSigmaOver,
                                 CalibratedSigma::kScaleOfOne, 1);
    return;
  }
  constexpr double kFirmly = 10;  // samples
  variance /= static_cast<double>(count);
  OnlineRegression fit(Weights::Constant(kRestTerms, 0.3), Weights::Constant(kRestTerms, kFirmly * variance), 1);
  for_each_pair([&](const Weights& x, double y) { fit.add(x, y); });
  rest.weights = fit.weights();
  if (rest.is_own) return;
  rest.is_own = true;
  rest.guesses.clear();  // they tell of the prior, or of the nearer horizon's sigma
  AlikeErrors errors;
  for_each_pair([&](const Weights& x, double y) {
    const double off = y - fit.predict(x);
    learnt_off_[errors.count()] = std::abs(off);
    errors.add(off);
  });
  const std::size_t judged = errors.count();
  const double rms = std::sqrt(errors.squares() / static_cast<double>(judged));
  const auto worst = learnt_off_.begin() + static_cast<std::ptrdiff_t>(judged * 19 / 20);
  std::nth_element(learnt_off_.begin(), worst, learnt_off_.begin() + static_cast<std::ptrdiff_t>(judged));
  const double scale = rms > 0 ? std::clamp(0.5 * *worst / rms, 0.5, 2.0) : CalibratedSigma::kScaleOfOne;
  const double degrees = errors.independent() - kRestTerms;  // the weights fit these very errors
  rest.sigma = CalibratedSigma(rms * widening_of_few(degrees), kLeastSigma, kSigmaOver, scale, 1);
}

double JointResponse::rest(double ahead) const noexcept {
  const auto [i, share] = between_horizons(ahead);
  const Weights weights = (1 - share) * rests_[i].weights + share * rests_[i + 1].weights;
  return means_.back() + rest_inputs(means_).dot(weights);
}

double JointResponse::sigma(double ahead) const noexcept {
  const auto [i, share] = between_horizons(ahead);
  return std::lerp(rests_[i].sigma.sigma(), rests_[i + 1].sigma.sigma(), share);
}

PredictedPosition JointResponse::at(double time) const noexcept {
  PredictedPosition answer;
  if (!observed_ || !(time >= newest_.time && time <= newest_.time + options_.farthest)) return answer;
  const double ahead = time - newest_.time;
  const StepResponse& model = fit_.model;
  const Weights then = model.inputs(commands_, time, time);
  answer.position = model.base(commands_, time, time) + then.dot(model.realised) + rest(ahead);
  answer.sigma = std::hypot(sigma(ahead), fit_.sigma(then - inputs_now_));
  if (!learnt_) {  // it may be as far off as it goes meanwhile
    const double meanwhile = commands_.at(time, time) - commands_.at(time - assumed_.sigma, time);
    answer.sigma = std::hypot(answer.sigma, meanwhile);
    answer.assumed = !identified() && meanwhile != 0;
  }
  answer.valid = std::isfinite(answer.position);
  return answer;
}

}  // namespace foresight
