#include "apps/operator/seat_trial.hpp"

#include <fmt/core.h>

#include <deque>
#include <map>
#include <opencv2/imgproc.hpp>

#include "apps/operator/stepped_sides.hpp"
#include "apps/view_measures.hpp"
#include "apps/view_outputs.hpp"
#include "common/error.hpp"
#include "display/view_session.hpp"
#include "seat/predicted_source.hpp"
#include "seat/seat.hpp"
#include "seat/seat_options.hpp"
#include "seat/view_setup.hpp"
#include "sim/lab_task.hpp"
#include "texture_gpu/stage_clock.hpp"

namespace foresight {
namespace {

using namespace std::chrono_literals;
namespace fs = std::filesystem;

constexpr double kMoved = 10;             // grey levels between two true images
constexpr std::size_t kLeastMoved = 100;  // pixels that are worth a figure
constexpr Duration kTruthKept = 20s;
constexpr Duration kSameInstant = 1ms;
constexpr Duration kLongest = 1200s;

class Mean {
 public:
  void add(std::optional<double> value) {
    if (!value) return;
    sum_ += *value;
    ++count_;
  }
  std::optional<double> mean() const {
    return count_ ? std::optional(sum_ / static_cast<double>(count_)) : std::nullopt;
  }

 private:
  double sum_ = 0;
  std::size_t count_ = 0;
};

Identity named(Identity identity) {
  identity.name = "the operator's program";
  return identity;
}

/// 255 where two images differ by more than kMoved in any channel.
cv::Mat moved_mask(const cv::Mat& one, const cv::Mat& other, const cv::Mat& seen) {
  cv::Mat difference, out;
  cv::absdiff(one, other, difference);
  std::vector<cv::Mat> channels;
  cv::split(difference, channels);
  for (std::size_t i = 1; i < channels.size(); ++i) channels[0] = cv::max(channels[0], channels[i]);
  cv::threshold(channels[0], out, kMoved, 255, cv::THRESH_BINARY);
  return out & seen;
}

/// A view, with a context of its own.
class HeadlessView {
 public:
  explicit HeadlessView(const ViewSetup& setup)
      : context_(gl::create_headless_context()), session_(std::make_unique<ViewSession>(*context_, setup)) {}
  ViewSession& session() {
    context_->make_current();
    return *session_;
  }

 private:
  std::unique_ptr<gl::Context> context_;
  std::unique_ptr<ViewSession> session_;
};

struct Shown {
  RobotTime instant, newest;
  std::string stem;
  cv::Mat predicted, delayed;  // BGRA; BGR
  bool invalid = false;
  FrameRecord record;
};

/// The whole of it.
class Trial {
 public:
  Trial(const Rig& rig, std::shared_ptr<const LiveScene> scene, const SeatTrialOptions& options, ScriptedMotion& motion)
      : rig_(rig),
        options_(options),
        robot_(rig, options.rig_file, clock_, options.line, options.physics),
        here_(robot_.participant(), "operator " + rig.name),
        scene_(std::move(scene)),
        end_(here_, seat_end_options(rig, named(robot_.identity()), *scene_), clock_),
        driver_(motion),
        seat_(rig, end_, driver_, clock_),
        setup_(live_view_setup(*scene_, rig.name)),
        view_(setup_),
        period_(seconds(1 / mock_options(as_mock(*rig.cameras)).rate)),
        source_(rig, scene_, end_, seat_, clock_, source_options()),
        truth_(robot_.cameras().frames().subscribe(1000)) {
    if (options.zero_delay) near_.emplace(setup_);
    if (options.physics) {
      things_.emplace(rig, scene_, mock_things());
      source_.show_things(&*things_);
      clock_.every(20ms, [this](RobotTime) { things_->advance(seat_.look_ahead()); });
    }
    driver_.listen_to([this]() -> std::optional<link::RobotState> {
      auto heard = end_.robot_state();
      return heard ? std::optional(std::move(heard->state)) : std::nullopt;
    });
    clock_.every(5ms, [this](RobotTime) {
      end_.step();
      seat_.step();
    });
    for (const char* folder : {"shown", "delayed", "true"})
      if (options.out) make_folder(*options.out / folder);
    figures_.record = describe(view_.session(), setup_);
    figures_.record.run = rig.name;
    add_texture_options(figures_.record, setup_.textures);
  }

  SeatTrialFigures run(const std::function<bool()>& stopped, const std::function<void(const std::string&)>& say) {
    const RobotTime begin = clock_.now();
    RobotTime told = begin;
    std::optional<RobotTime> pressed, ended;
    while (!stopped() && clock_.now() - begin < kLongest) {
      robot_.cycle();
      const RobotTime now = clock_.now();
      if (!pressed && driver_.driving()) pressed = now;
      if (pressed && !ended && (driver_.done() || to_seconds(now - *pressed) > options_.most_s)) ended = now;
      if (!driver_.failure().empty()) break;
      look(pressed && !ended);
      learn_truth();
      if (ended && shown_.empty()) break;
      if (now - told < 10s) continue;
      told = now;
      say(fmt::format("{:.0f} s: {}", to_seconds(now - begin),
                      pressed ? fmt::format("{} pictures", measured_) : words()));
    }
    figures_.failure = driver_.failure();
    if (!pressed && figures_.failure.empty()) figures_.failure = "it never drove: " + words();
    figures_.succeeded = figures_.failure.empty() && ended && (!options_.physics || in_tray());
    if (figures_.failure.empty() && !figures_.succeeded) figures_.failure = "the thing is not in the tray";
    if (pressed) figures_.task_s = to_seconds((ended ? *ended : clock_.now()) - *pressed);
    return finish();
  }

 private:
  // In truth, which the operator's side does not know.
  bool in_tray() {
    sim::PhysicalLab& lab = *robot_.cameras().physics();
    const Eigen::Vector3d thing = lab.thing_at(options_.thing, clock_.now()).translation();
    const JointPositions rest = [](std::string_view) { return std::nullopt; };
    const auto& nodes = scene_->model()->nodes();
    const auto tray = std::ranges::find(nodes, options_.tray, &Node::name);
    const Eigen::Vector3d middle = scene_->state_at({}, rest, StateStatus::predicted)
                                       .T_world_node[static_cast<std::size_t>(tray - nodes.begin())]
                                       .translation();
    return (thing - middle).head<2>().cwiseAbs().maxCoeff() < sim::kTraySide / 2 && thing.z() < sim::kTrayHeight;
  }
  PredictedSourceOptions source_options() const {
    PredictedSourceOptions out;
    out.real_time = false;
    out.rate_hz = options_.pictures_hz;
    out.image_period = period_;
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
      frame->left.pixels.copyTo(delayed_);
      session.process(std::move(*frame));
    }
    const ViewPlace place = source_.place();
    if (!session.draw(place.T_world_camera, place.scene) || !counts) return;
    Shown shown{source_.instant().time, newest_, source_.instant().name, session.read(), delayed_.clone()};
    shown.invalid = source_.robot().status == StateStatus::invalid;
    shown.record.stem = shown.stem;
    shown_.push_back(std::move(shown));
  }

  void learn_truth() {
    while (const auto frame = truth_->take(Duration{0})) {
      const RobotTime time = (*frame)->pair.left.time;
      truths_[time] = *frame;
      while (truths_.begin()->first < time - kTruthKept) truths_.erase(truths_.begin());
    }
    while (!shown_.empty() && !truths_.empty()) {
      const LiveFramePtr truth = true_frame_at(shown_.front().instant);
      if (!truth && shown_.front().instant > truths_.rbegin()->first) break;  // not taken yet
      if (truth) measure(shown_.front(), *truth);
      shown_.pop_front();
    }
  }

  LiveFramePtr true_frame_at(RobotTime time) const {
    const auto found = truths_.lower_bound(time - kSameInstant);
    return found != truths_.end() && found->first <= time + kSameInstant ? found->second : nullptr;
  }

  // With all images but this instant's own, as they would come without a line.
  std::optional<double> without_line(const LiveFrame& live, const ImageComparison& all) {
    if (!near_ || !live.posed) return std::nullopt;
    ViewSession& session = near_->session();
    for (auto next = truths_.upper_bound(fed_); next != truths_.end() && next->first < live.pair.left.time; ++next) {
      const bool last = std::next(next) == truths_.end() || std::next(next)->first >= live.pair.left.time;
      // Images between two pictures change little: the last one counts, and one now and then for what the head passes.
      if (!last && next->first < fed_ + seconds(0.5 / options_.pictures_hz)) continue;
      fed_ = next->first;
      if (next->second->posed) session.process(*next->second->posed);
    }
    if (!session.draw(live.posed->left.T_world_camera, live.posed->left.scene)) return std::nullopt;
    return all.psnr_db(session.read());
  }

  void measure(Shown& shown, const LiveFrame& live) {
    const cv::Mat& truth = live.pair.left.bgr;
    const cv::Mat seen = seen_mask(shown.predicted);
    const ImageComparison all(truth, seen);
    FrameRecord& record = shown.record;
    record.time_s = 1e-9 * static_cast<double>(shown.instant.ns);
    record.delay_s = to_seconds(shown.instant - shown.newest);
    record.predicted = all.measure(shown.predicted);
    record.delayed = all.measure(shown.delayed);
    record.coverage = measure_coverage(shown.predicted);
    ages_.add(record.delay_s);
    invalid_ += shown.invalid ? 1 : 0;
    ++measured_;
    if (const LiveFramePtr before = true_frame_at(shown.newest))
      measure_moved(shown, truth, before->pair.left.bgr, seen);
    zero_.add(without_line(live, all));
    keeper_.offer(record, shown.delayed, shown.predicted, truth);
    write_pictures(shown, truth);
    figures_.record.frames.push_back(record);
  }

  void measure_moved(const Shown& shown, const cv::Mat& truth, const cv::Mat& before, const cv::Mat& seen) {
    const cv::Mat moved = moved_mask(truth, before, seen);
    const auto count = static_cast<std::size_t>(cv::countNonZero(moved));
    moved_share_.add(static_cast<double>(count) / std::max(1, cv::countNonZero(seen)));
    if (count < kLeastMoved) return;
    const ImageComparison there(truth, moved);
    moving_predicted_.add(there.psnr_db(shown.predicted));
    moving_delayed_.add(there.psnr_db(shown.delayed));
  }

  void write_pictures(const Shown& shown, const cv::Mat& truth) const {
    if (!options_.out) return;
    const std::string name = shown.stem + ".png";
    write_png(*options_.out / "shown" / name, shown.predicted);
    write_png(*options_.out / "delayed" / name, shown.delayed);
    write_png(*options_.out / "true" / name, truth);
  }

  SeatTrialFigures finish() {
    const Summary all = summarise(figures_.record);
    if (all.frames > 0) {
      figures_.predicted_db = all.predicted.psnr_db.mean;
      figures_.delayed_db = all.delayed.psnr_db.mean;
    }
    figures_.zero_delay_db = zero_.mean();
    figures_.moving_predicted_db = moving_predicted_.mean();
    figures_.moving_delayed_db = moving_delayed_.mean();
    figures_.moving_share = moved_share_.mean();
    figures_.image_age_s = ages_.mean();
    figures_.invalid_share = measured_ ? static_cast<double>(invalid_) / static_cast<double>(measured_) : 1;
    const SeatStatus status = seat_.status();
    figures_.delay_s = status.delay.seconds;
    figures_.joints_p95 = status.outlook.error.value_or(0);
    figures_.losses = driver_.losses();
    figures_.instants = keeper_.instants();
    return std::move(figures_);
  }

  const Rig& rig_;
  const SeatTrialOptions& options_;
  SteppedClock clock_;
  SteppedRobotSide robot_;
  link::Participant here_;
  std::shared_ptr<const LiveScene> scene_;
  link::OperatorEnd end_;
  ScriptedDriver driver_;
  Seat seat_;
  ViewSetup setup_;
  HeadlessView view_;
  std::optional<HeadlessView> near_;
  Duration period_;
  PredictedSource source_;
  std::optional<ThingsOutlook> things_;
  std::shared_ptr<FrameQueue> truth_;

  cv::Mat delayed_;
  RobotTime newest_, fed_;
  std::deque<Shown> shown_;
  std::map<RobotTime, LiveFramePtr> truths_;
  std::uint64_t measured_ = 0, invalid_ = 0;
  Mean zero_, moving_predicted_, moving_delayed_, moved_share_, ages_;
  InstantKeeper keeper_{4};
  SeatTrialFigures figures_;
};

}  // namespace

SeatTrialFigures try_seat(const Rig& rig, std::shared_ptr<const LiveScene> scene, const SeatTrialOptions& options,
                          ScriptedMotion& motion, const std::function<bool()>& stopped,
                          const std::function<void(const std::string&)>& say) {
  return Trial(rig, std::move(scene), options, motion).run(stopped, say);
}

}  // namespace foresight
