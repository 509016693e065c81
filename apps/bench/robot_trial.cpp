#include "apps/bench/robot_trial.hpp"

#include <algorithm>
#include <cmath>
#include <deque>
#include <map>

#include "apps/bench/random_motion.hpp"
#include "common/cpu_time.hpp"
#include "common/error.hpp"
#include "input/hand_of_rig.hpp"
#include "link/line/delay_line.hpp"
#include "operators/robot_start.hpp"
#include "prediction/future_tool.hpp"
#include "rig/robot_devices.hpp"

namespace foresight {
namespace {

using namespace std::chrono_literals;

constexpr std::size_t kSetPointBytes = 200, kReportBytes = 900;
constexpr Duration kSpareLife = 250ms;      // of set-points, beyond the line's delay
constexpr Duration kOpenFirst = 200ms;      // that the switch is seen open first
constexpr double kStillHeld = 0.5;          // s: what held the robot back may still be in what is shown
constexpr double kTipVelocityOver = 0.035;  // s
constexpr double kFocal = 525;              // px

/// The robot with its drives, and the set-points that came.
class RobotSide {
 public:
  RobotSide(const Rig& rig, SteppedClock& clock)
      : rig_(rig), clock_(clock), devices_(rig, clock, mock()), shape_(rig.shape()) {
    devices_.bring_up([](const std::string&) {});
    robot_ = std::make_unique<Robot>(rig.gate_options(), shape_.get(), devices_.networks(), devices_.drives());
    cycles_.emplace(robot_->cycles());
  }

  /// Enabled and homed.
  void start() {
    RobotStart start(true);
    for (const RobotTime until = clock_.now() + 600s; clock_.now() < until;) {
      const RobotStart::Progress progress = start.tick(clock_.now(), robot_->status());
      if (progress.ready) return;
      if (!progress.failure.empty()) throw RuntimeFailure("the rig's emulated drives: " + progress.failure, "");
      robot_->ask(progress.request);
      for (int i = 0; i < 3; ++i) cycle();
    }
    throw RuntimeFailure("the rig's emulated drives do not find their homes within 600 s", "look at the rig's homing");
  }
  void came(RobotTime at, const SentSetPoint& set_point) {
    if (set_point.number <= newest_.number) return;
    newest_ = set_point;
    newest_came_ = at;
  }
  /// Sleeps until the next cycle is due, and makes it.
  void cycle() {
    next_ = std::max(next_ + period_, clock_.now());
    clock_.sleep_until(next_);
    cycle_now();
  }
  void cycle_now() {
    const RobotTime now = clock_.now();
    next_ = now;
    command(now);
    robot_->cycle(now);
    while (const auto newer = cycles_->take()) last_ = *newer;
  }
  RobotReport report() const {
    RobotReport out;
    out.time = last_.time;
    out.doing = doing_of(last_.phase, last_.gate);
    out.speed = robot_->status().gate.speed;
    out.newest_set_point = newest_.number;
    out.newest_came = newest_came_;
    out.joints = last_.joints;
    for (std::size_t i = 0; i < last_.joints; ++i)
      out.joint[i] = {last_.joint[i].time, last_.joint[i].position, last_.joint[i].set_point};
    return out;
  }
  Duration period() const { return period_; }
  const RobotCycle& last() const { return last_; }
  const RobotDevices& devices() const { return devices_; }

 private:
  static RobotDeviceOptions mock() {
    RobotDeviceOptions out;
    out.mock = true;
    return out;
  }
  // As operators/line_operator: the newest set-point again and again, aged so that the gate drops it when it expires.
  void command(RobotTime now) {
    if (newest_.number == 0 || now > newest_.sent + newest_.lasts) return;
    MotionCommand command{1, ++sequence_, now, newest_.deadman, rig_.joints.size(), newest_.position, 1};
    command.time = std::min(now, newest_.sent + newest_.lasts - seconds(rig_.command_age_s));
    robot_->submit(command);
  }

  const Rig& rig_;
  SteppedClock& clock_;
  RobotDevices devices_;
  std::unique_ptr<RobotShape> shape_;
  std::unique_ptr<Robot> robot_;
  std::optional<BroadcastRing<RobotCycle>::Reader> cycles_;
  Duration period_ = seconds(1 / rig_.rate_hz);
  RobotTime next_;
  std::uint64_t sequence_ = 0;
  SentSetPoint newest_;
  RobotTime newest_came_;
  RobotCycle last_;
};

/// One that shows the robot, and what else might have been shown.
class OperatorSide {
 public:
  OperatorSide(const Rig& rig, const RobotTrialOptions& options, RobotTrialFigures& figures)
      : rig_(rig),
        figures_(figures),
        shape_(rig.shape()),
        future_(future_options(rig), shape_.get()),
        tool_(arm_chain(*rig.robot, options.tool.empty() ? tool_link(rig) : options.tool, "", rig.name),
              rig.joint_names(), rig.name),
        lens_(Lens::Parameters{LensModel::plumb_bob, 640, 480, kFocal, kFocal, 319.5, 239.5, {}}) {}

  SentSetPoint set_point(RobotTime now, const JointValues& asked, bool deadman, Duration lasts) {
    asked_ = asked;
    return {++number_, now, lasts, deadman, rig_.joints.size(), asked};
  }
  void sent(const SentSetPoint& set_point, RobotTime now) { count(future_.sent(set_point, now)); }
  void reported(const RobotReport& report, RobotTime now) {
    const HistoryFault fault = future_.reported(report, now);
    if (fault != HistoryFault::out_of_order) count(fault);
    if (fault != HistoryFault::none) return;
    reports_.push_back(report);
    if (reports_.size() > 1 && to_seconds(report.time - reports_[1].time) > kTipVelocityOver) reports_.pop_front();
  }
  void advance(RobotTime now) { future_.advance(now); }
  /// `judged`: it counts.
  PredictedRobot show(RobotTime now, bool judged) {
    const RobotTime instant = future_.instant_to_show(now);
    const PredictedRobot robot = future_.show(instant);
    tool_.show(robot);
    if (judged)
      judge(robot);
    else
      last_shown_.reset();
    return robot;
  }
  void judge(const PredictedRobot& robot) {
    ++figures_.pictures;
    if (robot.status == StateStatus::invalid) {
      ++figures_.invalid;
      if (figures_.invalid_words.empty()) figures_.invalid_words = to_words(robot, rig_.joint_names());
      last_shown_.reset();
      return;
    }
    measure_step(robot);
    const RobotTime instant = robot.time;
    others_.push_back({instant, tool_.place(held()), tool_.place(went_on(instant)), tool_.place(asked_)});
  }
  /// `held_back` says whether the gate did so at an instant.
  template <typename HeldBack>
  void score(const RobotDevices& devices, const HeldBack& held_back) {
    while (const auto scored = future_.take_scored()) {
      const auto error = tool_.score(*scored);
      while (!others_.empty() && others_.front().time < scored->shown.time) others_.pop_front();
      if (!error || others_.empty() || others_.front().time != scored->shown.time) continue;
      if (held_back(scored->shown.time))
        figures_.held.push_back(error->position);
      else
        score(*scored, *error, others_.front(), devices);
    }
  }
  void finish() {
    figures_.delay_s = future_.delay().seconds;
    figures_.delay_sigma_s = future_.delay().sigma;
    for (std::size_t i = 0; i < rig_.joints.size(); ++i) figures_.drives.push_back(future_.figures(i));
  }
  const RobotFuture& future() const { return future_; }

 private:
  struct Others {
    RobotTime time;
    Pose hold, velocity, asked;
  };
  static RobotFutureOptions future_options(const Rig& rig) {
    RobotFutureOptions out;
    out.gate = rig.gate_options();
    return out;
  }
  void count(HistoryFault fault) const {
    if (fault != HistoryFault::none)
      throw RuntimeFailure(std::string("the trial's own history: ") + to_string(fault), "");
  }
  JointValues held() const {
    JointValues out{};
    for (std::size_t i = 0; i < rig_.joints.size(); ++i) out[i] = reports_.back().joint[i].position;
    return out;
  }
  JointValues went_on(RobotTime instant) const {
    JointValues out = held();
    for (std::size_t i = 0; i < rig_.joints.size(); ++i) {
      const ReportedJoint &now = reports_.back().joint[i], &then = reports_.front().joint[i];
      const double span = to_seconds(now.time - then.time);
      if (span > 0) out[i] += (now.position - then.position) / span * to_seconds(instant - now.time);
    }
    return out;
  }
  void measure_step(const PredictedRobot& robot) {
    for (std::size_t i = 0; last_shown_ && i < rig_.joints.size(); ++i) {
      const double most = rig_.joints[i].drive.max_velocity * to_seconds(robot.time - last_shown_->time);
      if (most > 0)
        figures_.largest_step_share =
            std::max(figures_.largest_step_share, std::abs(robot.position[i] - last_shown_->position[i]) / most);
    }
    last_shown_ = robot;
  }
  void score(const ScoredRobot& scored, const ToolError& error, const Others& others, const RobotDevices& devices) {
    const auto off = [&](const Pose& shown) { return (shown.translation() - error.T_base_tip.translation()).norm(); };
    figures_.predicted.tool.push_back(error.position);
    figures_.rotation.push_back(error.rotation);
    figures_.hold.tool.push_back(off(others.hold));
    figures_.velocity.tool.push_back(off(others.velocity));
    figures_.asked.tool.push_back(off(others.asked));
    figures_.tool_sigma.push_back(error.sigma);
    figures_.tool_inside += error.position <= 2 * error.sigma ? 1 : 0;
    JointValues shafts = scored.truth;
    for (std::size_t i = 0; i < rig_.joints.size(); ++i) {
      const double joint_off = std::abs(scored.shown.position[i] - scored.truth[i]);
      figures_.joints_inside += joint_off <= 2 * scored.shown.sigma[i] ? 1 : 0;
      ++figures_.joints_judged;
      if (rig_.joints[i].unit == "rad") figures_.joints.push_back(joint_off);
      shafts[i] = devices.shaft_at(rig_.joints[i].drive.name, scored.shown.time).value_or(shafts[i]);
    }
    const Pose shown = tool_.place(scored.shown.position);
    figures_.shafts.push_back((shown.translation() - tool_.place(shafts).translation()).norm());
    if (!camera_) {  // looks against x of the robot's base, from 1.5 m before the tool
      Pose T_base_camera = Pose::Identity();
      T_base_camera.linear() << 0, 0, -1, 1, 0, 0, 0, -1, 0;
      T_base_camera.translation() = error.T_base_tip.translation() + Eigen::Vector3d(1.5, 0, 0);
      camera_ = T_base_camera.inverse();
    }
    if (const auto pixels = pixel_error(lens_, *camera_, shown, error.T_base_tip)) figures_.pixels.push_back(*pixels);
  }

  const Rig& rig_;
  RobotTrialFigures& figures_;
  std::unique_ptr<RobotShape> shape_;
  RobotFuture future_;
  FutureTool tool_;
  Lens lens_;
  std::optional<Pose> camera_;
  std::uint64_t number_ = 0;
  JointValues asked_{};
  std::deque<RobotReport> reports_;
  std::deque<Others> others_;
  std::optional<PredictedRobot> last_shown_;
};

/// Both sides and the line between them.
class RobotTrial {
 public:
  RobotTrial(const Rig& rig, const RobotTrialOptions& options, const RobotTrialHooks& hooks, RobotTrialFigures& figures)
      : rig_(rig),
        options_(options),
        hooks_(hooks),
        figures_(figures),
        robot_(rig, clock_),
        operator_(rig, options, figures) {}

  void run() {
    robot_.start();
    begin_ = clock_.now();
    for (std::size_t i = 0; i < rig_.joints.size(); ++i) start_[i] = robot_.last().joint[i].position;
    if (!hooks_.wish) motion_.emplace(rig_, start_, options_.seed);
    down_.emplace(options_.line.down, begin_, options_.line.seed);
    up_.emplace(options_.line.up, begin_, options_.line.seed + 1);
    lasts_ = options_.line.down.delay + options_.line.down.jitter + kSpareLife;
    next_cycle_ = next_report_ = next_sent_ = next_shown_ = begin_ + robot_.period();
    const RobotTime end = begin_ + seconds(options_.learning + options_.seconds);
    while (clock_.now() < end && !(hooks_.over && hooks_.over())) step();
    operator_.finish();
    figures_.time_s = to_seconds(clock_.now() - begin_);
  }

 private:
  void step() {
    clock_.sleep_until(std::min({next_cycle_, next_sent_, next_shown_}));
    const RobotTime now = clock_.now();
    for (; !on_the_way_down_.empty() && on_the_way_down_.begin()->first <= now;
         on_the_way_down_.erase(on_the_way_down_.begin()))
      robot_.came(on_the_way_down_.begin()->first, on_the_way_down_.begin()->second);
    if (now >= next_cycle_) cycle(now);
    const double cpu = cpu_seconds(CLOCK_THREAD_CPUTIME_ID);
    for (; !on_the_way_up_.empty() && on_the_way_up_.begin()->first <= now;
         on_the_way_up_.erase(on_the_way_up_.begin()))
      operator_.reported(on_the_way_up_.begin()->second, now);
    if (now >= next_sent_) send(now);
    operator_.advance(now);
    if (now >= next_shown_) {
      const PredictedRobot shown = operator_.show(now, to_seconds(now - begin_) > options_.learning);
      if (hooks_.shown) hooks_.shown(robot_.devices(), now, shown);
      next_shown_ = next_shown_ + seconds(1 / options_.pictures_hz);
    }
    figures_.cpu_s += cpu_seconds(CLOCK_THREAD_CPUTIME_ID) - cpu;
    operator_.score(robot_.devices(), [this](RobotTime time) { return held_back(time); });
  }
  void cycle(RobotTime now) {
    robot_.cycle_now();
    next_cycle_ = next_cycle_ + robot_.period();
    if (robot_.last().hold.joint >= 0) held_.push_back(now);
    while (!held_.empty() && now - held_.front() > 10s) held_.pop_front();
    watch_motion();
    if (now < next_report_) return;
    next_report_ = next_report_ + seconds(1 / rig_.link.joint_rate_hz);
    if (const auto arrival = up_->send(now, kReportBytes)) on_the_way_up_.emplace(*arrival, robot_.report());
  }
  void watch_motion() {
    for (std::size_t i = 0; i < rig_.joints.size(); ++i) {
      const double speed = std::abs(robot_.last().joint[i].set_point.velocity);
      if (rig_.joints[i].unit == "rad") figures_.moved_rad += speed * to_seconds(robot_.period());
      figures_.fastest_share = std::max(figures_.fastest_share, speed / rig_.joints[i].drive.max_velocity);
    }
  }
  void send(RobotTime now) {
    next_sent_ = next_sent_ + seconds(1 / options_.set_points_hz);
    const bool pressed = now - begin_ > kOpenFirst;
    if (!pressed) pressed_ = now;
    const double t = to_seconds(now - pressed_);
    const JointValues asked = hooks_.wish ? hooks_.wish(t, start_) : motion_->at(t);
    const SentSetPoint set_point = operator_.set_point(now, asked, pressed, lasts_);
    operator_.sent(set_point, now);
    if (const auto arrival = down_->send(now, kSetPointBytes)) on_the_way_down_.emplace(*arrival, set_point);
  }
  bool held_back(RobotTime time) const {
    return std::any_of(held_.begin(), held_.end(),
                       [&](RobotTime held) { return std::abs(to_seconds(time - held)) < kStillHeld; });
  }

  const Rig& rig_;
  const RobotTrialOptions& options_;
  const RobotTrialHooks& hooks_;
  RobotTrialFigures& figures_;
  JointValues start_{};
  SteppedClock clock_;
  RobotSide robot_;
  OperatorSide operator_;
  std::optional<RandomMotion> motion_;
  std::optional<DelayLine> down_, up_;
  std::multimap<RobotTime, SentSetPoint> on_the_way_down_;
  std::multimap<RobotTime, RobotReport> on_the_way_up_;
  std::deque<RobotTime> held_;
  Duration lasts_{};
  RobotTime begin_, next_cycle_, next_report_, next_sent_, next_shown_, pressed_;
};

}  // namespace

RobotTrialFigures try_robot(const Rig& rig, const RobotTrialOptions& options, const RobotTrialHooks& hooks) {
  if (!rig.robot)
    throw InputError(rig.name, "the rig has no robot", "give it a `robot:` section with a URDF, which moves a tool");
  RobotTrialFigures figures;
  RobotTrial(rig, options, hooks, figures).run();
  return figures;
}

}  // namespace foresight
