#include "apps/live_view.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cstdio>
#include <exception>

#include "apps/view_measures.hpp"
#include "common/error.hpp"
#include "common/patient_output.hpp"
#include "common/stop_signal.hpp"
#include "display/live_source.hpp"
#include "display/view_window.hpp"
#include "seat/view_setup.hpp"
#include "session/joint_tracks.hpp"

namespace foresight {
namespace {

namespace fs = std::filesystem;

constexpr int kLiveWindowWidth = 1280;

LiveFeed feed_from(std::shared_ptr<FrameQueue> frames, std::function<std::string()> trouble) {
  return {[frames](Duration timeout) -> std::optional<LiveImage> {
            const auto frame = frames->take(timeout);
            if (!frame) return std::nullopt;
            const LiveFrame& of = **frame;
            if (of.posed) return LiveImage{of.number, of.posed};
            return LiveImage{of.number, std::nullopt, of.pair.left.bgr, unknown_joints(of.joints.known, 'h')};
          },
          [frames] { return frames->closed(); }, std::move(trouble)};
}

std::unique_ptr<gl::Window> open_live_window(const Lens& lens) {
  const int height = std::max(kLiveWindowWidth * lens.height() / (2 * lens.width()), 120);
  try {
    return std::make_unique<gl::Window>(kLiveWindowWidth, height, "Foresight");
  } catch (const gl::NoWindow& error) {
    throw RuntimeFailure(std::string("--view: ") + error.what(), "or do without a window: give --out or --report");
  }
}

RunRecord described(const ViewSession& session, const ViewSetup& setup, const LiveViewOptions& options) {
  RunRecord record = describe(session, setup);
  record.run = options.rig;
  record.options.push_back({"delay_ms", options.delay_ms});
  add_texture_options(record, setup.textures);
  record.options.push_back({"real_time", !options.stepped});
  record.options.push_back({"refine", false});
  return record;
}

void say_of_view(const std::string& words) {
  patient_stderr().say("robot: view: " + words + "\n");
}

void remove_old_pictures(const fs::path& out) {
  std::error_code ignored;  // what cannot be removed cannot be written either, which is told then
  fs::remove(out / "contact_sheet.png", ignored);
  fs::remove_all(out / "predicted", ignored);
}

}  // namespace

struct LiveView::Work {
  /// Says on stderr when images stop and when they come again.
  class StallLog final : public ViewObserver {
   public:
    void stepped(const ViewStep& /*step*/, FrameSource& /*source*/, ViewSession& /*session*/) override {
      if (!fault_.empty()) say_of_view("images again; it was: " + fault_);
      fault_.clear();
      began_ = true;
    }
    void waiting(FrameSource& source, ViewSession& /*session*/) override {
      const std::string fault = source.fault();
      if (fault.empty()) return;
      if (fault_.empty()) {
        stalls_ += began_ ? 1 : 0;
        say_of_view(fault);
      }
      fault_ = fault;
    }
    /// Since the first image: before, joints that are not homed tell no poses.
    int stalls() const { return stalls_; }

   private:
    std::string fault_;
    bool began_ = false;
    int stalls_ = 0;
  };

  LiveViewOptions options;
  std::shared_ptr<FrameQueue> frames;
  ViewSetup setup;
  std::unique_ptr<gl::Window> window;
  std::unique_ptr<gl::Context> headless;
  std::unique_ptr<ViewSession> session;
  LiveSource source;
  StallLog stalls;
  std::optional<ViewMeasures> measures;
  std::optional<ViewWindow> shown;
  std::function<bool()> stopped = [] { return false; };
  std::optional<ViewLoop> loop;
  std::exception_ptr failure;

  static ViewSetup view_setup(const LiveScene& scene, const LiveViewOptions& options) {
    ViewSetup out = live_view_setup(scene, "--view", {.awaits_lamp = options.stepped});
    if (!options.stepped) rehearse_for_real_time(out, say_of_view, [] { return stop_requested(); });
    return out;
  }

  Work(const LiveScene& scene, std::shared_ptr<FrameQueue> queue, std::function<std::string()> trouble,
       const Clock& clock, const LiveViewOptions& given)
      : options(given),
        frames(std::move(queue)),
        setup(view_setup(scene, options)),
        window(options.window ? open_live_window(setup.left) : nullptr),
        headless(window ? nullptr : gl::create_headless_context()),
        session(std::make_unique<ViewSession>(window ? static_cast<gl::Context&>(*window) : *headless, setup)),
        source(feed_from(frames, std::move(trouble)), clock,
               {.delay = seconds(options.delay_ms * 1e-3), .real_time = !options.stepped}) {
    std::vector<ViewObserver*> observers{&stalls};
    if (options.outputs.any()) {
      if (options.outputs.out) remove_old_pictures(*options.outputs.out);
      measures.emplace(described(*session, setup, options), options.outputs, setup.textures);
      observers.push_back(&*measures);
    }
    if (window) {
      shown.emplace(*window, ViewWindowOptions{.title = [this](const ViewStep&) { return title(); }});
      observers.push_back(&*shown);
    }
    loop.emplace(*session, source, std::move(observers), [this] { return stopped(); });
  }

  std::string title() const {
    const std::string notice = options.notice ? options.notice() : "";
    return fmt::format("Foresight {}: {}{}camera, {:.0f} ms ago | predicted view", options.rig, notice,
                       notice.empty() ? "" : " | ", options.delay_ms);
  }

  /// False: the view has ended.
  template <typename Action>
  bool guarded(const Action& action) noexcept {
    try {
      if (!failure) action();
    } catch (...) {
      failure = std::current_exception();
    }
    return !failure && (!shown || shown->wants_more());
  }

  void note() {
    RunRecord& record = measures->record();
    const auto add = [&](std::uint64_t count, const char* what) {
      if (count > 0) record.notes.push_back(std::to_string(count) + what);
    };
    add(source.counts().unposed, " images had no pose: they were neither shown nor used.");
    add(source.counts().forgotten, " images were given up on their way: the delay is too long.");
    add(frames->dropped(), " images came while the view was busy, and were left out.");
    if (stalls.stalls() > 0)
      record.notes.push_back(
          fmt::format("Images with a pose stayed away for a while (occasions: {}).", stalls.stalls()));
    record.drops += frames->dropped() + source.counts().forgotten;
  }
};

LiveView::LiveView(const LiveScene& scene, std::shared_ptr<FrameQueue> frames, std::function<std::string()> trouble,
                   const Clock& clock, const LiveViewOptions& options)
    : work_(std::make_unique<Work>(scene, std::move(frames), std::move(trouble), clock, options)) {}

LiveView::~LiveView() = default;

bool LiveView::step() noexcept {
  return work_->guarded([&] {
    while (work_->loop->step() == SourceState::ready) {
    }
  });
}

bool LiveView::run(const std::function<bool()>& stopped) noexcept {
  return work_->guarded([&] {
    work_->stopped = stopped;
    work_->loop->run();
    work_->stopped = [] { return false; };
  });
}

void LiveView::finish(bool complete, const std::string& note) {
  if (work_->options.stepped) step();
  if (work_->measures) {
    work_->note();
    if (!note.empty()) work_->measures->record().notes.push_back(note);
    work_->measures->record().complete = complete && !work_->failure;
    work_->measures->finish(work_->source, *work_->session, "Foresight, live view of " + work_->options.rig);
    print_summary(work_->measures->record());
  }
  if (work_->failure) std::rethrow_exception(work_->failure);
}

}  // namespace foresight
