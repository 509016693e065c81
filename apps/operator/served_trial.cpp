#include "apps/operator/served_trial.hpp"

#include <fmt/core.h>

#include <mutex>

#include "apps/operator/seat_begin.hpp"
#include "apps/operator/thing_lies.hpp"
#include "display/view_loop.hpp"
#include "seat/predicted_source.hpp"
#include "seat/seat_log.hpp"
#include "seat/seat_options.hpp"
#include "seat/seen_nodes.hpp"
#include "seat/view_setup.hpp"
#include "seat/view_trust.hpp"

namespace foresight {
namespace {

using namespace std::chrono_literals;

constexpr Duration kNewsEvery = 100ms;
constexpr Duration kTruthComesWithin = 10s;  // after the end, for what was shown last, and for the thing

/// What becomes of the script, for another thread than the seat's.
class WatchedDriver final : public SeatDriver {
 public:
  WatchedDriver(ScriptedMotion& motion, const ScriptedDriverOptions& options, link::OperatorEnd& end)
      : driver_(motion, options) {
    driver_.listen_to(robot_says(end));
  }
  SeatWish tick(const SeatView& view) override {
    const std::lock_guard lock(mutex_);
    return driver_.tick(view);
  }
  ScriptState state() const {
    const std::lock_guard lock(mutex_);
    return driver_.state();
  }

 private:
  mutable std::mutex mutex_;
  ScriptedDriver driver_;
};

ScriptedDriverOptions driver_options(double found_within_s) {
  ScriptedDriverOptions out;
  out.gives_up_after = seconds(found_within_s);
  return out;
}

/// Everything of a seat; what is above outlives what is below.
class ServedTrial final : ViewObserver {
 public:
  ServedTrial(const Rig& rig, std::shared_ptr<const LiveScene> scene, const ServedTrialOptions& options,
              ScriptedMotion& motion, const std::function<bool()>& stopped,
              const std::function<void(const std::string&)>& say)
      : options_(options),
        stopped_(stopped),
        say_(say),
        participant_(rig.link, options.name, link::Role::operating, begin_line(options.line, clock_)),
        scene_(std::move(scene)),
        setup_(view_setup(rig)),
        end_(participant_, seat_end_options(rig, seat_identity(rig, options.rig_file, *scene_, options.name), *scene_),
             clock_),
        motion_(motion),
        seen_(scene_->model()),
        driver_(motion, driver_options(options.found_within_s), end_),
        seat_(rig, end_, driver_, clock_),
        context_(gl::create_headless_context()),
        session_(*context_, setup_),
        source_(rig, scene_, end_, seat_, clock_, source_options(rig)),
        trust_(session_, setup_, clock_, trust_options(options)),
        task_(options.most_s, options.things ? TaskWatch::OverTime::fails : TaskWatch::OverTime::ends),
        measures_(describe_seat(rig, session_, setup_), options.out),
        joints_(rig.joint_names()) {
    source_.listen([this](const link::LineFrame& frame, const PosedFrame* posed) {
      trust_.heard(frame.image[0], posed, seat_.was_surprised(frame.image[0].captured));
      measures_.saw(frame.image[0].captured, frame.image[0].bgr);
    });
    motion_.look_by([this](const std::string& node) { return seen_.at(node); });
    if (!options.things) return;
    things_.emplace(rig, scene_, things_about(options.rig_file, *scene_, true), true);
    source_.show_things(&*things_);
  }

  SeatTrialFigures run() {
    end_.start();
    if (const std::string refused = seat_.start(); !refused.empty()) say_(refused);
    ViewLoop loop(session_, source_, {this}, stopped_);
    told_ = clock_.now();
    while (loop.step() != SourceState::ended && advance()) {
    }
    // The robot comes to rest by itself as set-points end.
    seat_.stop();
    const SeatStatus status = seat_.status();
    end_.stop();
    return finish(status);
  }

  ~ServedTrial() override {
    seat_.stop();
    motion_.look_by({});
  }

 private:
  ViewSetup view_setup(const Rig& rig) const {
    ViewSetup out = live_view_setup(*scene_, rig.name, options_.textures, options_.levels);
    rehearse_for_real_time(out, say_, stopped_);
    return out;
  }
  PredictedSourceOptions source_options(const Rig& rig) const {
    PredictedSourceOptions out;
    out.rate_hz = options_.pictures_hz;
    out.image_period = seconds(1 / rig.cameras->camera(Side::left).settings.rate);
    return out;
  }
  static ViewTrustOptions trust_options(const ServedTrialOptions& options) {
    ViewTrustOptions out;
    out.fall_back = options.fall_back;
    out.remember_every = Duration{0};
    out.wait = true;  // pictures are read back in any case
    return out;
  }
  void arrived(const PosedFrame& frame) override { trust_.saw(frame); }
  void stepped(const ViewStep& step, FrameSource& /*source*/, ViewSession& session) override {
    if (!step.drawn) return;
    const ViewPlace place = source_.place();
    seen_.show(place.scene);
    trust_.drew(source_, place, TrustMarks::hatch);
    trust_.judge(source_.why_invalid());
    if (!task_.under_way()) return;
    const link::LineFrame& newest = *source_.newest();
    measures_.show({step.instant.time,
                    newest.image[0].captured,
                    step.instant.name,
                    session.read(),
                    newest.image[0].bgr,
                    {},
                    source_.robot().status == StateStatus::invalid,
                    trust_.doubt(),
                    trust_.exact(),
                    trust_.why()});
  }

  // False: there is nothing left to be done.
  bool advance() {
    const RobotTime now = clock_.now();
    const auto said = end_.robot_state();
    task_.see(now, driver_.state(), said ? said->state.hold : "");
    if (task_.failed()) return false;
    tell(now);
    tell_news(now);
    const bool waits = measures_.waits() || (things_ && !things_->seen_at_rest(options_.thing));
    return !task_.ended() || (waits && now - *task_.ended() < kTruthComesWithin);
  }

  void tell(RobotTime now) {
    constexpr Duration kTellEvery = 5s;
    if (now - told_ < kTellEvery) return;
    told_ = now;
    if (task_.began()) say_(fmt::format("{:.0f} s: {} pictures", task_.seconds(now), measures_.measured()));
  }

  void tell_news(RobotTime now) {
    if (now < news_due_) return;
    news_due_ = now + kNewsEvery;
    std::vector<SeatLine> lines = seat_lines(seat_.status(), joints_, source_.fault());
    lines.push_back({"shown", trust_.falls_back() ? "the newest image: " + trust_.why() : "the view", ""});
    for (const std::string& news : log_.news(lines)) say_(news);
  }

  ThingLies where_the_thing_lies() const {
    return things_ ? where_it_lies(*things_, *scene_, source_.robot().time, options_.thing, options_.tray)
                   : ThingLies::in_place;
  }

  SeatTrialFigures finish(const SeatStatus& status) {
    SeatTrialFigures out;
    out.task = task_.outcome(clock_.now(), status.control.words, [this] { return where_the_thing_lies(); });
    if (things_) out.seen_in_tray = where_the_thing_lies() == ThingLies::in_place;
    out.delay_s = status.delay.seconds;
    out.joints_p95 = status.outlook.error.value_or(0);
    out.line = status.line;
    out.losses = driver_.state().losses;
    out.fidelity = measures_.finish();
    return out;
  }

  const ServedTrialOptions& options_;
  const std::function<bool()>& stopped_;
  const std::function<void(const std::string&)>& say_;
  MonotonicClock clock_;
  link::Participant participant_;
  std::shared_ptr<const LiveScene> scene_;
  ViewSetup setup_;
  link::OperatorEnd end_;
  ScriptedMotion& motion_;
  SeenNodes seen_;
  WatchedDriver driver_;
  Seat seat_;
  std::unique_ptr<gl::Context> context_;
  ViewSession session_;
  PredictedSource source_;
  ViewTrust trust_;
  std::optional<ThingsOutlook> things_;
  TaskWatch task_;
  SeatMeasures measures_;
  SeatLog log_;
  const std::vector<std::string> joints_;
  RobotTime told_, news_due_;
};

}  // namespace

SeatTrialFigures try_served_seat(const Rig& rig, std::shared_ptr<const LiveScene> scene,
                                 const ServedTrialOptions& options, ScriptedMotion& motion,
                                 const std::function<bool()>& stopped,
                                 const std::function<void(const std::string&)>& say) {
  return ServedTrial(rig, std::move(scene), options, motion, stopped, say).run();
}

}  // namespace foresight
