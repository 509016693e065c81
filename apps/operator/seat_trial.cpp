#include "apps/operator/seat_trial.hpp"

#include <fmt/core.h>

#include <map>

#include "apps/operator/line_video.hpp"
#include "apps/operator/seat_begin.hpp"
#include "apps/operator/stepped_sides.hpp"
#include "apps/operator/thing_lies.hpp"
#include "apps/view_outputs.hpp"
#include "common/error.hpp"
#include "display/view_session.hpp"
#include "seat/predicted_source.hpp"
#include "seat/seat.hpp"
#include "seat/seat_options.hpp"
#include "seat/seen_nodes.hpp"
#include "seat/task_watch.hpp"
#include "seat/tool_script.hpp"
#include "seat/view_setup.hpp"
#include "seat/view_trust.hpp"
#include "sim/physics/rests_in_tray.hpp"
#include "texture_gpu/stage_clock.hpp"

namespace foresight {
namespace {

using namespace std::chrono_literals;
namespace fs = std::filesystem;

constexpr double kLongest = 1200;           // s, and as long as the motion may last
constexpr Duration kThingSeenWithin = 10s;  // after the end
constexpr std::size_t kFramesKept = 1000;   // that come between two pictures: none is to be missed

Identity named(Identity identity) {
  identity.name = "the operator's program";
  return identity;
}

link::OperatorEndOptions end_options(const Rig& rig, const Identity& identity, const LiveScene& scene) {
  link::OperatorEndOptions out = seat_end_options(rig, named(identity), scene);
  out.room = kFramesKept;
  return out;
}

/// A script, whose wishes others are told of.
class ToldDriver final : public SeatDriver {
 public:
  ToldDriver(ScriptedMotion& motion, const SeatTrialOptions& options)
      : script_(motion, {.most_losses = options.most_losses}), hand_(options.hand), told_(options.asked) {}
  SeatWish tick(const SeatView& view) override {
    SeatWish wish = script_.tick(view);
    if (hand_) wish = hand_(view, wish);
    if (told_) told_(view.now, wish);
    return wish;
  }
  ScriptedDriver& script() { return script_; }

 private:
  ScriptedDriver script_;
  const std::function<SeatWish(const SeatView&, const SeatWish&)>& hand_;
  const std::function<void(OperatorTime, const SeatWish&)>& told_;
};

/// A view, with a context of its own.
class HeadlessView {
 public:
  explicit HeadlessView(const ViewSetup& setup)
      : context_(gl::create_headless_context()), session_(std::make_unique<ViewSession>(*context_, setup)) {}
  ~HeadlessView() {
    context_->make_current();
    session_.reset();
  }
  ViewSession& session() {
    context_->make_current();
    return *session_;
  }

 private:
  std::unique_ptr<gl::Context> context_;
  std::unique_ptr<ViewSession> session_;
};

/// The whole of it.
class Trial {
 public:
  Trial(const Rig& rig, std::shared_ptr<const LiveScene> scene, const SeatTrialOptions& options, ScriptedMotion& motion)
      : rig_(rig),
        options_(options),
        robot_(rig, options.rig_file, clock_, options.line, options.physics, options.layout),
        here_(robot_.participant(), "operator " + rig.name),
        scene_(std::move(scene)),
        end_(here_, end_options(rig, robot_.identity(), *scene_), clock_),
        motion_(motion),
        seen_(scene_->model()),
        driver_(motion, options),
        seat_(rig, end_, driver_, clock_),
        setup_(live_view_setup(*scene_, rig.name, options.textures, options.levels)),
        view_(setup_),
        period_(seconds(1 / mock_options(as_mock(*rig.cameras)).rate)),
        source_(rig, scene_, end_, seat_, clock_, source_options()),
        trust_(view_.session(), setup_, clock_, trust_options()),
        truth_(options.scored ? robot_.cameras().frames().subscribe(kFramesKept) : nullptr),
        task_(options.most_s, options.physics ? TaskWatch::OverTime::fails : TaskWatch::OverTime::ends),
        measures_(describe_seat(rig, view_.session(), setup_), options.out) {
    if (options.scored && options.zero_delay) {
      near_.emplace(setup_);
      measures_.compare_without_line([this](RobotTime instant) { return without_line(instant); });
    }
    if (options.physics) {
      things_.emplace(rig, scene_, things_about(options.rig_file, *scene_, true), false);
      source_.show_things(&*things_);
    }
    driver_.script().listen_to(robot_says(end_));
    motion_.look_by([this](const std::string& node) { return seen_.at(node); });
    source_.listen([this](const link::LineFrame& frame, const PosedFrame* posed) {
      const RobotTime captured = frame.image[0].captured;
      trust_.heard(frame.image[0], posed, seat_.was_surprised(frame.image[0].captured));
      if (const cv::Mat seen = measures_.image_at(captured); !seen.empty()) video_.add(captured, seen, frame.bytes);
    });
    clock_.every(5ms, [this](RobotTime) {
      if (options_.stands_still && options_.stands_still()) return;
      end_.step();
      seat_.step();
    });
  }

  ~Trial() {
    motion_.look_by({});
    view_.session();  // its context is that of what is given back first
  }

  SeatTrialFigures run(const std::function<bool()>& stopped, const std::function<void(const std::string&)>& say) {
    const RobotTime begin = clock_.now();
    RobotTime told = begin;
    while (!stopped() && clock_.now() - begin < seconds(kLongest + options_.most_s)) {
      robot_.cycle();
      const RobotTime now = clock_.now();
      const auto said = end_.robot_state();
      task_.see(now, driver_.script().state(), said ? said->state.hold : "");
      if (task_.failed()) break;
      look(task_.under_way());
      learn_truth();
      if (options_.each) options_.each({now, robot_, end_, seat_, source_, pictures_, texture_bytes_});
      if (task_.ended() && !measures_.waits() && !waits_for_the_thing(now - *task_.ended())) break;
      if (now - told < 10s) continue;
      told = now;
      say(fmt::format("{:.0f} s: {}", to_seconds(now - begin),
                      task_.began() ? fmt::format("{} pictures", measures_.measured()) : words()));
    }
    return finish();
  }

 private:
  // In truth, which the operator's side does not know.
  bool in_tray() {
    return sim::rests_in_tray(*robot_.cameras().physics(), options_.thing, place_at_rest(*scene_, options_.tray),
                              clock_.now());
  }
  // By what images show at the operator's side.
  bool waits_for_the_thing(Duration since_end) const {
    return things_ && !things_->seen_at_rest(options_.thing) && since_end < kThingSeenWithin;
  }
  PredictedSourceOptions source_options() const {
    PredictedSourceOptions out;
    out.real_time = false;
    out.rate_hz = options_.pictures_hz;
    if (options_.scored) out.image_period = period_;
    return out;
  }
  ViewTrustOptions trust_options() const {
    ViewTrustOptions out;
    out.fall_back = options_.fall_back;
    out.remember_every = Duration{0};
    out.wait = true;
    return out;
  }
  std::string words() const {
    const SeatStatus status = seat_.status();
    return status.control.words + (status.robot ? "; " + status.robot->doing.name : "");
  }

  // A picture, where one is due, as ViewLoop makes it.
  void look(bool counts) {
    if (source_.advance() != SourceState::ready) return;
    ViewSession& session = view_.session();
    if (auto frame = source_.arrived()) {
      newest_ = frame->left.time;
      trust_.saw(*frame);
      frame->left.pixels.copyTo(delayed_);
      video_.newest().copyTo(as_video_);  // of the same instant
      texture_bytes_ = session.process(std::move(*frame)).bytes_reserved;
    }
    const ViewPlace place = source_.place();
    if (!session.draw(place.T_world_camera, place.scene)) return;
    seen_.show(place.scene);
    ++pictures_;
    trust_.drew(source_, place, TrustMarks::hatch);
    trust_.judge(source_.why_invalid());
    if (!counts || !options_.scored) return;
    const ShownInstant& instant = source_.instant();
    measures_.show({instant.time, newest_, instant.name, session.read(), delayed_.clone(), as_video_.clone(),
                    source_.robot().status == StateStatus::invalid, trust_.doubt(), trust_.exact(), trust_.why()});
  }

  void learn_truth() {
    if (!truth_) return;
    while (const auto frame = truth_->take(Duration{0})) {
      const RobotTime time = (*frame)->pair.left.time;
      if (near_) truths_[time] = *frame;
      while (!truths_.empty() && truths_.begin()->first < time - SeatMeasures::kTruthKept)
        truths_.erase(truths_.begin());
      const cv::Mat& seen = (*frame)->pair.left.bgr;
      measures_.saw(time, options_.truth ? options_.truth(seen) : seen);
    }
  }

  // With all images but this instant's own, as they would come without a line.
  cv::Mat without_line(RobotTime instant) {
    const auto live = truths_.lower_bound(instant - SeatMeasures::kSameInstant);
    if (live == truths_.end() || !live->second->posed) return {};
    ViewSession& session = near_->session();
    for (auto next = truths_.upper_bound(fed_); next != truths_.end() && next->first < live->first; ++next) {
      // Images between two pictures change little: the last one counts, and one now and then for what the head passes.
      if (std::next(next) != live && next->first < fed_ + seconds(0.5 / options_.pictures_hz)) continue;
      fed_ = next->first;
      if (next->second->posed) session.process(*next->second->posed);
    }
    const PosedImage& left = live->second->posed->left;
    return session.draw(left.T_world_camera, left.scene) ? session.read() : cv::Mat();
  }

  SeatTrialFigures finish() {
    figures_.task = task_.outcome(clock_.now(), words(), [this] {
      return !options_.physics || in_tray() ? ThingLies::in_place : ThingLies::elsewhere;
    });
    if (things_)
      figures_.seen_in_tray =
          where_it_lies(*things_, *scene_, source_.robot().time, options_.thing, options_.tray) == ThingLies::in_place;
    figures_.fidelity = measures_.finish();
    const SeatStatus status = seat_.status();
    figures_.delay_s = status.delay.seconds;
    figures_.joints_p95 = status.outlook.error.value_or(0);
    figures_.line = status.line;
    figures_.losses = driver_.script().state().losses;
    return std::move(figures_);
  }

  const Rig& rig_;
  const SeatTrialOptions& options_;
  SteppedClock clock_;
  SteppedRobotSide robot_;
  link::Participant here_;
  std::shared_ptr<const LiveScene> scene_;
  link::OperatorEnd end_;
  ScriptedMotion& motion_;
  SeenNodes seen_;
  ToldDriver driver_;
  Seat seat_;
  ViewSetup setup_;
  HeadlessView view_;
  std::optional<HeadlessView> near_;
  Duration period_;
  PredictedSource source_;
  ViewTrust trust_;
  std::optional<ThingsOutlook> things_;
  std::shared_ptr<FrameQueue> truth_;  // null: nothing is scored
  TaskWatch task_;
  SeatMeasures measures_;
  LineVideo video_;

  cv::Mat delayed_, as_video_;
  RobotTime newest_, fed_;
  std::uint64_t pictures_ = 0, texture_bytes_ = 0;
  std::map<RobotTime, LiveFramePtr> truths_;  // where views without a line are wanted
  SeatTrialFigures figures_;
};

}  // namespace

SeatTrialFigures try_seat(const Rig& rig, std::shared_ptr<const LiveScene> scene, const SeatTrialOptions& options,
                          ScriptedMotion& motion, const std::function<bool()>& stopped,
                          const std::function<void(const std::string&)>& say) {
  return Trial(rig, std::move(scene), options, motion).run(stopped, say);
}

}  // namespace foresight
