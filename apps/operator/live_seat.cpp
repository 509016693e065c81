#include "apps/operator/live_seat.hpp"

#include <fmt/core.h>

#include <cstdlib>

#include "apps/operator/seat_begin.hpp"
#include "apps/operator/seat_head.hpp"
#include "apps/operator/seat_window.hpp"
#include "common/error.hpp"
#include "common/patient_output.hpp"
#include "common/stop_signal.hpp"
#include "display/head/runtime_offer.hpp"
#include "input/open_tracker.hpp"
#include "link/line/line_spec.hpp"
#include "seat/hand_driver.hpp"
#include "seat/panel_lens.hpp"
#include "seat/seat_ending.hpp"
#include "seat/seat_keys.hpp"
#include "seat/seat_options.hpp"
#include "seat/seat_sounds.hpp"
#include "seat/view_setup.hpp"

namespace foresight {
namespace {

// Without a look at what the operator does: the switch is let go of between pictures, too.
constexpr Duration kLongestWait = std::chrono::milliseconds(20);
constexpr double kUnpaced = 1000;  // Hz, of the source: FramePacer decides
constexpr int kWindowWidth = 1280, kWindowHeight = 800;
constexpr std::size_t kUnderWay = 16;  // instants of what the robot will do as it was sent already

// A head display's runtime that takes contexts of GLX only gets one.
gl::Window::ContextApi context_api(const LiveSeatOptions& options) {
  if (options.head_display != HeadDisplayKind::openxr) return gl::Window::ContextApi::egl;
  const head::RuntimeOffer offer = head::ask_runtime();
  return offer.opengl && !offer.egl ? gl::Window::ContextApi::native : gl::Window::ContextApi::egl;
}

std::vector<std::unique_ptr<Tracker>> open_devices(const LiveSeatOptions& options,
                                                   const std::shared_ptr<head::HeldControllers>& controllers) {
  std::vector<std::unique_ptr<Tracker>> out;
  if (!options.device.empty()) out.push_back(open_tracker(options.device));
  if (options.head_display == HeadDisplayKind::openxr) out.push_back(std::make_unique<head::HeadHands>(controllers));
  return out;
}

std::unique_ptr<gl::Window> open_seat_window(const std::string& title, gl::Window::ContextApi api) {
  try {
    return std::make_unique<gl::Window>(kWindowWidth, kWindowHeight, title, api);
  } catch (const gl::NoWindow& error) {
    throw RuntimeFailure(error.what(), "`--scripted` operates without a window");
  }
}

/// Everything of a seat; what is above outlives what is below.
class LiveSeat {
 public:
  LiveSeat(const Rig& rig, const LiveSeatOptions& options)
      : rig_(rig),
        options_(options),
        line_(begin_line(options.line ? std::optional(read_line_spec(*options.line)) : std::nullopt, clock_)),
        participant_(rig.link, options.name, link::Role::operating, line_),
        scene_(std::make_shared<const LiveScene>(
            live_scene_of(rig, options.mock_cameras, options.scene, options.physics, options.layout))),
        gate_(std::make_shared<FrameGate>(clock_)),
        setup_(view_setup(rig, options)),
        end_(participant_, seat_end_options(rig, seat_identity(rig, options.rig_file, *scene_, options.name), *scene_),
             clock_),
        driver_(rig, open_devices(options, controllers_), scene_->model()),
        seat_(rig, end_, driver_, clock_),
        window_(open_seat_window("Foresight: " + rig.name + " is getting ready", context_api(options))),
        session_(*window_, setup_),
        things_(rig, scene_, things_about(options.rig_file, *scene_, options.physics), true),
        source_(rig, scene_, end_, seat_, clock_, source_options()),
        trust_(session_, setup_, clock_, options.trust),
        hand_(rig, driver_.options()),
        pacer_(clock_, {.rate_hz = options.rate_hz}, gate_),
        sounds_(options.sounds),
        shown_(*window_, seat_, source_, window_options()) {
    window_->set_title("Foresight: " + rig.name);
    for (const std::string& remark : session_.level_remarks()) patient_stderr().say(remark + "\n");
    if (options.head_display == HeadDisplayKind::openxr)
      head_.emplace(*window_, session_, setup_, source_, shown_, controllers_,
                    options.second_eye_of_first ? head::SecondEyeFrom::first_eye : head::SecondEyeFrom::own_view,
                    clock_);
    source_.show_things(&things_);
    driver_.may_push(things_.names());
    source_.listen([this](const link::LineFrame& frame, const PosedFrame* posed) {
      trust_.heard(frame.image[0], posed, seat_.was_surprised(frame.image[0].captured));
    });
  }

  int run() {
    end_.start();
    if (const std::string refused = seat_.start(); !refused.empty()) say(refused);
    show_pictures();
    shown_.finish_saving();
    end_.stop();
    tell_responses();
    if (head_ && !head_->stop()) end_with_runtime_hanging();
    return stop_requested() ? kStopped : 0;
  }

 private:
  static void say(const std::string& words) { patient_stderr().say("operator: " + words + "\n"); }

  void show_pictures() {
    const SeatEnd end(seat_, clock_);
    window_->close_by_keys(false);
    std::vector<ViewObserver*> observers{&shown_};
    if (head_) observers.push_back(&*head_);
    ViewLoop loop(session_, source_, observers, [] { return stop_requested(); });
    for (SourceState state = SourceState::ready; state != SourceState::ended; state = loop.step()) {
      while (!pacer_.wait(kLongestWait) && shown_.wants_more() && !stop_requested()) shown_.take_input();
      shown_.take_input();
      const SeatStatus status = seat_.status();
      ending_.see(status);
      sounds_.hear(status, driver_.sight(), shown_.trusted(), 1e-9 * static_cast<double>(clock_.now().ns));
      // A window that stands lets go of a switch: before one is held.
      if (!status.held && shown_.warm_up(session_)) pacer_.held_up();
    }
  }

  // Whoever has them in the rig file need not wait for them to be learnt.
  void tell_responses() const {
    const std::vector<std::string> learnt = seat_.learnt_responses();
    if (learnt.empty()) return;
    say("how the drives followed, for the joints' lines of the rig file:");
    for (const std::string& line : learnt) patient_stderr().say("  " + line + "\n");
  }

  ViewSetup view_setup(const Rig& rig, const LiveSeatOptions& options) const {
    ViewSetup out = live_view_setup(*scene_, rig.name, options.textures, options.levels);
    out.gate = gate_;
    // The window is there by then, and is to answer.
    rehearse_for_real_time(out, say, [this] {
      clear_behind_pictures(window_target(*window_));
      window_->present();
      return window_->should_close() || stop_requested();
    });
    return out;
  }
  PredictedSourceOptions source_options() const {
    PredictedSourceOptions out;
    out.rate_hz = kUnpaced;
    return out;
  }
  SeatWindowOptions window_options() {
    SeatWindowOptions out;
    out.title = rig_.name;
    out.joints = rig_.joint_names();
    out.font_scale = options_.font_scale;
    out.pacer = &pacer_;
    out.trust = &trust_;
    out.keys = key_words(keys_of(options_.device), driven_parts(rig_));
    out.input = [this](const gl::WindowInput& input) { take(input); };
    out.log = say;
    out.more_lines = [this] {
      std::vector<SeatLine> lines = driver_.lines();
      for (std::string& words : things_.lines()) lines.push_back({"things", std::move(words), "", Urgency::fine});
      if (head_)
        for (SeatLine& line : head_->lines()) lines.push_back(std::move(line));
      for (SeatLine& line : sounds_.lines()) lines.push_back(std::move(line));
      for (SeatLine& line : ending_.lines()) lines.push_back(std::move(line));
      return lines;
    };
    out.views.left = setup_.left;
    out.views.right = setup_.right;
    out.views.most_drawing_ms = kDrawingShare * 1e3 / options_.rate_hz;
    if (options_.head_display == HeadDisplayKind::side_by_side) out.views.mode = ViewMode::two_eyes;
    if (!options_.display_lenses.empty())
      out.views.panels = {read_panel_lens(options_.display_lenses.front()),
                          read_panel_lens(options_.display_lenses.back())};
    out.input_took = [this] { return driver_.input_took(); };
    out.hand = [this] { return hand_.draw(driver_.sight(), seat_.under_way(kUnderWay)); };
    return out;
  }

  // A head display that goes away takes its picture from who looks through it, whatever he drives with.
  void heed_head() {
    if (!head_) return;
    const bool shows = head_->shows();
    if (head_shown_ && !shows) driver_.interrupt("the headset has gone", "look at the window; press the switch anew");
    head_shown_ = shows;
    driver_.look_within(shows ? head_->T_world_space() : std::nullopt);
  }
  // Its thread may never come back, and uses what would be destroyed now. The robot is at rest, and nothing is open.
  [[noreturn]] static void end_with_runtime_hanging() {
    say("the headset's runtime does not answer; ended without it: start it again");
    patient_stderr().finish(std::chrono::seconds(1));
    std::_Exit(1);
  }

  void take(const gl::WindowInput& input) {
    if (window_->take_space()) driver_.ask(LineRequest::emergency_stop);
    for (const auto& event : input.key_events) {
      if (!event.down) continue;
      if (const auto key = seat_key(event.code)) press(*key);
      if (head_ && hand_key(event.code) == HandKey::recentre) head_->centre();
    }
    const ViewPlace place = source_.place();
    driver_.look_from(shown_.views().looks_from(place.T_world_camera));
    driver_.scene_stands(place.scene.T_world_node);
    heed_head();
    driver_.take(input, {clock_.now().ns});
    if (input.asked_to_end && ending_.press(seat_.status())) window_->close();
  }
  void press(SeatKey key) {
    SeatViews& views = shown_.views();
    switch (key) {
      case SeatKey::stop:
      case SeatKey::end: return;  // take() has them
      case SeatKey::enable: return driver_.ask(LineRequest::enable);
      case SeatKey::home: return driver_.ask(LineRequest::home);
      case SeatKey::reset: return driver_.ask(LineRequest::reset);
      case SeatKey::set_up: return driver_.ask(LineRequest::set_up);
      case SeatKey::control: return driver_.toggle_control();
      case SeatKey::hand_over: return driver_.hand_over();
      case SeatKey::main_view: return views.next_main();
      case SeatKey::stereo: return views.next_stereo();
      case SeatKey::swap_eyes: return views.swap_eyes();
      case SeatKey::stereogram: return views.toggle_stereogram();
      case SeatKey::stereogram_depth: return views.stereogram().next_depth();
      case SeatKey::stereogram_pattern: return views.stereogram().next_pattern();
      case SeatKey::stereogram_variant: return views.stereogram().next_variant();
      case SeatKey::beside: return views.toggle_observer();
      case SeatKey::paint: return views.next_paint();
      case SeatKey::marks: return shown_.next_marks();
      case SeatKey::help: return shown_.next_words();
      case SeatKey::sounds: return sounds_.toggle();
      case SeatKey::screenshot: return shown_.save_next();
    }
  }

  const Rig& rig_;
  const LiveSeatOptions& options_;
  MonotonicClock clock_;
  std::shared_ptr<link::PretendedLine> line_;
  link::Participant participant_;
  std::shared_ptr<const LiveScene> scene_;
  std::shared_ptr<FrameGate> gate_;
  ViewSetup setup_;
  link::OperatorEnd end_;
  std::shared_ptr<head::HeldControllers> controllers_ = std::make_shared<head::HeldControllers>();
  HandDriver driver_;
  Seat seat_;
  std::unique_ptr<gl::Window> window_;
  ViewSession session_;
  ThingsOutlook things_;
  PredictedSource source_;
  ViewTrust trust_;
  HandOverlay hand_;
  FramePacer pacer_;
  SeatSounds sounds_;
  SeatEnding ending_;
  SeatWindow shown_;
  std::optional<SeatHead> head_;
  bool head_shown_ = false;
};

}  // namespace

int run_live_seat(const Rig& rig, const LiveSeatOptions& options) {
  const WaitsForReaders waits;
  poll_stop_signals();
  return LiveSeat(rig, options).run();
}

}  // namespace foresight
