// A robot of two joints with the gate's own motion and drives that lag, a line, and who predicts it, in stepped time.
#pragma once

#include <deque>
#include <functional>
#include <map>
#include <optional>
#include <random>

#include "prediction/robot_future.hpp"
#include "tests/prediction/rod.hpp"

namespace foresight {

struct WorldOptions {
  double delay = 0.3;                       // s, each way
  double jitter = 0;                        // s, more, evenly
  double loss = 0;                          // share of set-points and reports
  double lag = 0.015;                       // s, of the drives
  double quantum = 1e-5;                    // rad, of the encoders
  bool jaws = false;                        // the first joint is that of a gripper
  std::optional<KnownResponse> known = {};  // what was found of the drives before
  /// What the robot's end of the line asks for, and what set-points name; 0: nothing.
  std::uint64_t consent = 0, named = 0;
  bool agrees = false;  // `named` is what reports told last
  double tells_every = 0,
         tells_late = 0;  // s; what is asked for is told so often, and comes so much later than reports
  int looks_every = 1;    // cycles in which the robot's program looks for set-points that came
  unsigned seed = 1;
};

class FutureWorld {
 public:
  explicit FutureWorld(const WorldOptions& options = {})
      : options_(options),
        robot_shape_(rod_.shape()),
        model_shape_(rod_.shape()),
        gate_(gate_options(), robot_shape_.get()),
        future_(future_options(), model_shape_.get()),
        random_(options.seed) {
    lasts = options.delay + options.jitter + 0.25;
    GateModel::State state;
    state.time = now_;
    state.doing = GateDoing::idle;
    if (options_.consent != 0) state.consent = options_.consent;
    gate_.set(state);
  }

  // What may go wrong.
  bool jammed = false;         // the first joint is held fast by something
  bool robot_silent = false;   // no reports
  bool line_cut_down = false;  // no set-point arrives
  double slower = 0;           // s that set-points take besides
  bool sends = true;           // set-points
  std::function<void(RobotReport&)> edit_report = [](RobotReport&) {};
  std::function<bool(double)> holds = [](double t) { return t > 0.2; };  // the switch
  double lasts = 0;                                                      // s, each set-point
  std::function<JointValues(double)> wish = [](double t) {
    return JointValues{-0.3 + 0.7 * std::sin(0.9 * t) + 0.2 * std::sin(2.3 * t), 0.5 * std::sin(1.7 * t)};
  };

  struct Picture {
    PredictedRobot shown;
    JointValues truth{};  // once known
  };

  void run(double time) {
    for (const RobotTime end = now_ + seconds(time); now_ < end;) tick();
  }
  double t() const { return to_seconds(now_ - begin_); }
  RobotTime now() const { return now_; }
  RobotFuture& future() { return future_; }
  const GateModel& gate() const { return gate_; }
  const std::vector<PredictedRobot>& pictures() const { return pictures_; }
  /// Those whose truth is known to be that of the shafts, from `from` seconds on.
  JointValues truth_at(RobotTime time) const {
    auto after = shafts_.lower_bound(time);
    if (after == shafts_.end()) return std::prev(after)->second;
    if (after == shafts_.begin()) return after->second;
    const auto before = std::prev(after);
    const double share = to_seconds(time - before->first) / to_seconds(after->first - before->first);
    JointValues out{};
    for (std::size_t i = 0; i < 2; ++i) out[i] = std::lerp(before->second[i], after->second[i], share);
    return out;
  }

 private:
  static constexpr double kSag = 5e-4;  // rad by which weight bends what the motor turns: no linear response
  GateOptions gate_options() const {
    GateOptions out = rod_.options();
    out.joints[0].keeps_grip = options_.jaws;
    return out;
  }
  RobotFutureOptions future_options() const {
    RobotFutureOptions out;
    out.gate = gate_options();
    out.responses.assign(2, options_.known);
    return out;
  }
  static constexpr Duration kTick = std::chrono::milliseconds(4);

  void tick() {
    now_ = now_ + kTick;
    ++ticks_;
    for (; !down_.empty() && down_.begin()->first <= now_; down_.erase(down_.begin()))
      if (down_.begin()->second.number > newest_) {
        newest_ = down_.begin()->second.number;
        came_ = down_.begin()->first;
        waits_ = down_.begin()->second;
      }
    if (waits_ && ticks_ % static_cast<std::uint64_t>(options_.looks_every) == 0)
      gate_.take(*std::exchange(waits_, std::nullopt), now_);
    gate_.cycle(now_);
    draw_consent();
    for (std::size_t i = 0; i < 2; ++i) {
      const double share = 1 - std::exp(-to_seconds(kTick) / options_.lag);
      if (i > 0 || !jammed) motor_[i] += share * (gate_.state().motion[i].position - motor_[i]);
      shaft_[i] = motor_[i] + kSag * std::sin(4 * motor_[i]);
    }
    shafts_[now_] = shaft_;
    if (ticks_ % 5 == 0) report();
    for (; !up_.empty() && up_.begin()->first <= now_; up_.erase(up_.begin())) {
      const RobotReport& report = up_.begin()->second;
      if (options_.agrees && report.permit) options_.named = report.permit->consent;
      future_.reported(report, now_);
    }
    if (ticks_ % 3 == 0) send();
    future_.advance(now_);
    if (ticks_ % 4 == 0) pictures_.push_back(future_.show(future_.instant_to_show(now_)));
  }
  /// After a loss another one.
  void draw_consent() {
    if (gate_.state().consent != std::optional<std::uint64_t>(0)) return;
    GateModel::State state = gate_.state();
    state.consent = ++options_.consent;
    gate_.set(state);
  }
  std::optional<LinePermit> permit() {
    if (!gate_.state().consent) return {};
    if (!telling_ || now_ - telling_->time >= seconds(options_.tells_every))
      telling_ = {now_, *gate_.state().consent, gate_.state().released};
    if (!told_ || now_ - telling_->time >= seconds(options_.tells_late)) told_ = telling_;
    return told_;
  }
  void report() {
    RobotReport out;
    out.time = now_;
    out.doing = gate_.state().doing;
    out.speed = gate_.options().speed_after(now_ - gate_.state().engaged);
    out.newest_set_point = newest_;
    out.newest_came = came_;
    out.joints = 2;
    out.permit = permit();
    for (std::size_t i = 0; i < 2; ++i)
      out.joint[i] = {now_, std::round(shaft_[i] / options_.quantum) * options_.quantum, gate_.state().motion[i]};
    edit_report(out);
    if (!robot_silent && uniform() >= options_.loss) up_.emplace(now_ + way(), out);
  }
  void send() {
    if (!sends) return;
    const SentSetPoint set_point{++number_, now_, seconds(lasts), holds(t()), 2, wish(t()), options_.named};
    future_.sent(set_point, now_);
    const bool lost = uniform() < options_.loss;
    if (!line_cut_down && !lost) down_.emplace(now_ + way() + seconds(slower), set_point);
  }
  double uniform() { return std::uniform_real_distribution<double>(0, 1)(random_); }
  Duration way() { return seconds(options_.delay + options_.jitter * uniform()); }

  WorldOptions options_;
  Rod rod_;
  std::unique_ptr<RobotShape> robot_shape_, model_shape_;
  GateModel gate_;
  RobotFuture future_;
  std::mt19937 random_;
  RobotTime begin_{1'000'000'000'000}, now_ = begin_;
  std::uint64_t ticks_ = 0, number_ = 0, newest_ = 0;
  RobotTime came_;
  JointValues motor_{}, shaft_{};
  std::map<RobotTime, JointValues> shafts_;
  std::multimap<RobotTime, SentSetPoint> down_;
  std::optional<SentSetPoint> waits_;
  std::optional<LinePermit> telling_, told_;
  std::multimap<RobotTime, RobotReport> up_;
  std::vector<PredictedRobot> pictures_;
};

}  // namespace foresight
