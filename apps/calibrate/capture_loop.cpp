#include "apps/calibrate/capture_loop.hpp"

#include <atomic>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <thread>

#include "calibration/target/capture_picture.hpp"
#include "common/counted.hpp"
#include "common/error.hpp"
#include "common/latest_value.hpp"
#include "common/stop_signal.hpp"
#include "display/view_window.hpp"
#include "gl/glfw_window.hpp"

namespace foresight {
namespace {

using namespace std::chrono_literals;

constexpr Duration kShowTaken = 1s, kShowEnd = 3s;
constexpr Duration kRedraw = 40ms;  // at least, so that a moved or uncovered window is drawn again

struct Running {  // stops also where something throws
  explicit Running(CaptureSource& of) : source(of) { source.start(); }
  ~Running() { source.stop(); }
  Running(const Running&) = delete;
  Running& operator=(const Running&) = delete;
  CaptureSource& source;
};

void say(const CaptureMoment& moment, std::string& last) {
  const CaptureSession::Outcome& outcome = moment.outcome;
  std::string text =
      outcome.verdict.taken ? "taken, " + counted(moment.progress.views, "view") : outcome.verdict.reason;
  const std::string& wish = moment.progress.wish.text;
  if (!moment.progress.enough) text += "; next: " + (wish.empty() ? "another view, turned or moved" : wish);
  std::string kind = text;  // not again because a number changed, but for a view that was taken
  if (!outcome.verdict.taken) std::erase_if(kind, [](char c) { return (c >= '0' && c <= '9') || c == '.'; });
  if (kind == last) return;
  std::fprintf(stderr, "capture: %s\n", text.c_str());
  last = std::move(kind);
}

/// Session and now.png; one thread.
class Judge {
 public:
  Judge(CaptureSession& session, std::filesystem::path pictures) : session_(session), pictures_(std::move(pictures)) {
    if (!pictures_.empty()) std::filesystem::create_directories(pictures_);
  }
  CaptureMoment look(const CaptureImages& images, bool at_once) {
    CaptureMoment moment{images.left, images.right, session_.show(images.left, images.right, at_once), {}};
    moment.progress = session_.progress();
    say(moment, said_);
    if (!pictures_.empty()) write_picture(pictures_ / "now.png", capture_picture(moment));
    return moment;
  }

 private:
  CaptureSession& session_;
  std::filesystem::path pictures_;
  std::string said_;
};

/// A judge with a thread of its own: a slow one misses images, the window does not wait.
class JudgeThread {
 public:
  JudgeThread(CaptureSession& session, const std::filesystem::path& pictures)
      : judge_(session, pictures), thread_([this](const std::stop_token& stop) { run(stop); }) {}

  void look(CaptureImages images) {
    busy_ = true;
    images_.put(std::move(images));
  }
  void take_next() { at_once_ = true; }  ///< whatever it is worth
  bool busy() const { return busy_; }
  std::optional<CaptureMoment> news() { return news_.take(); }
  void rethrow() const {
    if (failed_) std::rethrow_exception(failure_);
  }

 private:
  void run(const std::stop_token& stop) {
    try {
      while (!stop.stop_requested()) {
        const auto images = images_.take(50ms);
        if (!images) continue;
        news_.put(judge_.look(*images, at_once_.exchange(false)));
        busy_ = false;
      }
    } catch (...) {
      failure_ = std::current_exception();
      failed_ = true;
    }
  }

  Judge judge_;
  LatestValue<CaptureImages> images_;
  LatestValue<CaptureMoment> news_;
  std::atomic<bool> at_once_ = false, busy_ = false, failed_ = false;
  std::exception_ptr failure_;  // written before failed_
  std::jthread thread_;
};

/// Why to end, apart from the user and from being enough.
class Patience {
 public:
  Patience(const CaptureSource& source, const Clock& clock, const CaptureLoopOptions& options)
      : source_(source), clock_(clock), options_(options), begin_(clock.now()), heard_(begin_) {}

  void hear() { heard_ = clock_.now(), any_ = true; }
  std::optional<CaptureEnd> over() const {
    if (stop_requested()) return CaptureEnd::interrupted;
    const RobotTime now = clock_.now();
    if (now - begin_ >= options_.longest) return CaptureEnd::late;
    if (source_.at_end()) return CaptureEnd::no_more_images;
    if (now - heard_ <= options_.silent_after) return std::nullopt;
    if (any_) return CaptureEnd::silent;
    const std::string why = source_.silent_because();
    throw RuntimeFailure("no image came" + (why.empty() ? "" : ": " + why), "check the cables, and `foresight doctor`");
  }

 private:
  const CaptureSource& source_;
  const Clock& clock_;
  const CaptureLoopOptions& options_;
  RobotTime begin_, heard_;
  bool any_ = false;
};

/// What the window shows: the newest images of a film, or the stills last judged; what was found last, and for a moment
/// that a view was taken.
class Scene {
 public:
  Scene(CaptureProgress progress, bool stills) : stills_(stills) { moment_.progress = std::move(progress); }

  void show(const CaptureImages& images) { moment_.left = images.left, moment_.right = images.right; }
  void show(CaptureMoment news, RobotTime now) {
    if (news.outcome.verdict.taken) taken_until_ = now + kShowTaken;
    if (stills_ || empty()) moment_.left = news.left, moment_.right = news.right;
    moment_.outcome = std::move(news.outcome);
    moment_.progress = std::move(news.progress);
    moment_.outcome.verdict.taken |= now < taken_until_;
  }
  bool empty() const { return moment_.left.empty(); }
  bool enough() const { return moment_.progress.enough; }
  cv::Mat picture() const { return capture_picture(moment_); }

 private:
  CaptureMoment moment_;
  bool stills_;
  RobotTime taken_until_{INT64_MIN};
};

class LiveWindow {
 public:
  LiveWindow()
      : window_(kCapturePictureWidth, kCapturePictureHeight, "Foresight capture - Space: take it, Esc: end"),
        picture_("capture") {}

  /// Blocks for one display frame at most.
  void draw(const Scene& scene) {
    const ViewTarget whole = window_target(window_);
    clear_behind_pictures(whole);
    if (!scene.empty()) {
      picture_.upload(scene.picture());
      copy_(picture_.texture(), fitted(whole, picture_.texture().width(), picture_.texture().height()));
    }
    window_.present();
  }
  gl::Window& window() { return window_; }

 private:
  gl::Window window_;
  UploadedPicture picture_;
  PictureCopy copy_;
};

void linger(LiveWindow& live, const Scene& scene, const Clock& clock) {
  const RobotTime end = clock.now() + kShowEnd;
  while (clock.now() < end && !stop_requested() && !live.window().should_close()) {
    live.draw(scene);
    live.window().wait_events(to_seconds(kRedraw));
  }
}

}  // namespace

const char* to_string(CaptureEnd end) {
  switch (end) {
    case CaptureEnd::enough: return "enough";
    case CaptureEnd::closed: return "the window was closed";
    case CaptureEnd::interrupted: return "interrupted";
    case CaptureEnd::late: return "the time is up (--seconds)";
    case CaptureEnd::silent: return "no more images come";
    case CaptureEnd::no_more_images: return "no more images";
  }
  return "";
}

bool has_display() {
  for (const char* name : {"DISPLAY", "WAYLAND_DISPLAY"})
    if (const char* value = std::getenv(name); value && *value != '\0') return true;
  return false;
}

CaptureEnd capture_with_pictures(CaptureSource& source, CaptureSession& session, const Clock& clock,
                                 const CaptureLoopOptions& options) {
  poll_stop_signals();
  Judge judge(session, options.pictures);
  const Running running(source);
  Patience patience(source, clock, options);
  while (true) {
    const auto images = source.take(100ms);
    if (images) {
      patience.hear();
      if (judge.look(*images, false).progress.enough) return CaptureEnd::enough;
    }
    if (const auto end = patience.over()) return *end;
  }
}

CaptureEnd capture_with_window(CaptureSource& source, CaptureSession& session, const Clock& clock,
                               const CaptureLoopOptions& options) {
  LiveWindow live;
  std::fprintf(stderr, "capture: in a window; Space takes a view, Escape ends\n");
  poll_stop_signals();
  JudgeThread judge(session, options.pictures);
  const Running running(source);
  Patience patience(source, clock, options);
  Scene scene(session.progress(), source.stills());
  RobotTime drawn = clock.now();
  while (true) {
    judge.rethrow();
    bool changed = false, busy = judge.busy();
    if (!source.stills() || !busy)
      if (auto images = source.take(5ms)) {
        patience.hear();
        if (!source.stills()) scene.show(*images);
        judge.look(std::move(*images));
        changed = busy = true;
      }
    if (auto news = judge.news()) scene.show(std::move(*news), clock.now()), changed = true;
    if (live.window().take_space()) judge.take_next();
    if (changed || clock.now() - drawn > kRedraw) {
      live.draw(scene);
      drawn = clock.now();
    } else {
      live.window().wait_events(0.005);
    }
    if (live.window().should_close()) return CaptureEnd::closed;
    if (scene.enough()) break;
    if (const auto end = patience.over(); end && !(source.stills() && busy)) return *end;
  }
  linger(live, scene, clock);
  return CaptureEnd::enough;
}

}  // namespace foresight
