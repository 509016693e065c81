#include "display/head/head_display.hpp"

#include "display/head/xr_session.hpp"

namespace foresight::head {
namespace {

constexpr int kMostEvents = 100;  // in a round
constexpr Duration kLongestEnd = std::chrono::seconds(1);
constexpr int kMostEndingRounds = 500;
constexpr const char* kGone = "the headset has gone";
constexpr const char* kPutOn = "let go of the switch; when the headset shows the scene again, press it anew";

}  // namespace

struct HeadDisplay::Open {
  explicit Open(GraphicsBinding binding) : graphics(std::move(binding)), instance(graphics.kind) {}
  GraphicsBinding graphics;
  Instance instance;
  std::unique_ptr<Session> session;
};

bool stands_still(const HeadStatus& status, OperatorTime now, Duration most) {
  return status.shown && status.last_frame && now - *status.last_frame > most;
}

HeadDisplay::HeadDisplay(const HeadDisplayOptions& options, const Clock& clock, std::shared_ptr<HeldControllers> hands)
    : options_(options), clock_(clock), hands_(std::move(hands)) {}

HeadDisplay::~HeadDisplay() = default;

bool HeadDisplay::step(HeadPainter& painter) {
  if (over_) return false;
  try {
    if (!open()) return false;
    poll();
    if (!open_ || !open_->session || !open_->session->steps().running()) return false;
    open_->session->frame(clock_, painter, *hands_);
    count();
    return true;
  } catch (const CallFailed& failure) {
    const bool had_session = open_ && open_->session;
    // A runtime without its headset is asked again; one that failed is left, and found anew.
    if (open_ && !had_session && failure.result == XR_ERROR_FORM_FACTOR_UNAVAILABLE)
      note(words_for(failure.result), cure_for(failure.result));
    else
      close(failure.words, cure_for(failure.result), had_session);
    return false;
  }
}

// A session, where it is time to look for one.
bool HeadDisplay::open() {
  if (open_ && open_->session) return true;
  const RobotTime now = clock_.now();
  if (next_try_ && now < *next_try_) return false;
  next_try_ = now + options_.try_again;
  if (!open_) open_ = std::make_unique<Open>(current_graphics_binding());
  const XrSystemId headset = open_->instance.headset();
  SessionOptions options;
  options.stage = options_.stage;
  options.scale = options_.scale;
  open_->session = std::make_unique<Session>(open_->instance, headset, open_->graphics, options);
  const std::lock_guard lock(mutex_);
  status_.runtime = open_->instance.runtime();
  status_.headset = open_->session->headset();
  return true;
}

void HeadDisplay::poll() {
  for (int i = 0; i < kMostEvents && open_ && open_->session; ++i) {
    XrEventDataBuffer event{};
    event.type = XR_TYPE_EVENT_DATA_BUFFER;
    const XrResult result = xrPollEvent(open_->instance.get(), &event);
    check(result, "xrPollEvent");
    if (result == XR_EVENT_UNAVAILABLE) break;
    take_event(&event);
  }
  if (open_ && open_->session) count();
}

void HeadDisplay::take_event(const void* event) {
  const auto* const header = static_cast<const XrEventDataBaseHeader*>(event);
  if (header->type == XR_TYPE_EVENT_DATA_INSTANCE_LOSS_PENDING) throw CallFailed(XR_ERROR_INSTANCE_LOST, "xrPollEvent");
  if (header->type == XR_TYPE_EVENT_DATA_REFERENCE_SPACE_CHANGE_PENDING) {
    const auto* const change = static_cast<const XrEventDataReferenceSpaceChangePending*>(event);
    return open_->session->space_moves(change->referenceSpaceType, change->changeTime);
  }
  if (header->type != XR_TYPE_EVENT_DATA_SESSION_STATE_CHANGED) return;
  const bool was_focused = open_->session->steps().focused();
  const SessionStep step = open_->session->take(static_cast<const XrEventDataSessionStateChanged*>(event)->state);
  // Without frames nobody renews what the controllers said.
  if (was_focused && !open_->session->steps().focused()) hands_->gone(kGone, kPutOn);
  if (step == SessionStep::leave) throw CallFailed(XR_ERROR_SESSION_LOST, "loss pending");
  if (step != SessionStep::quit) return;
  over_ = true;
  close("the head display was closed in the runtime's menu", "start again to have it back", false);
}

void HeadDisplay::close(const std::string& trouble, const std::string& cure, bool lost) {
  hands_->gone(kGone, kPutOn);
  if (open_ && open_->session) {
    const FrameCounts& counts = open_->session->counts();
    counted_.frames += counts.frames;
    counted_.drawn += counts.drawn;
    counted_.without_pose += counts.without_pose;
    counted_.time_jumps += counts.time_jumps;
  }
  open_.reset();
  if (lost) ++counted_.losses;
  next_try_ = clock_.now() + options_.try_again;
  note(trouble, cure);
}

void HeadDisplay::note(const std::string& trouble, const std::string& cure) {
  const std::lock_guard lock(mutex_);
  status_.trouble = trouble;
  status_.cure = cure;
  status_.shown = status_.focused = false;
  status_.ended = over_;
  status_.losses = counted_.losses;
}

void HeadDisplay::count() {
  const SessionSteps& steps = open_->session->steps();
  const FrameCounts& counts = open_->session->counts();
  const std::lock_guard lock(mutex_);
  const bool new_frame = counted_.frames + counts.frames != status_.frames;
  status_.frames = counted_.frames + counts.frames;
  status_.drawn = counted_.drawn + counts.drawn;
  status_.without_pose = counted_.without_pose + counts.without_pose;
  status_.time_jumps = counted_.time_jumps + counts.time_jumps;
  status_.rate_hz = counts.period.count() > 0 ? 1e9 / static_cast<double>(counts.period.count()) : 0;
  if (new_frame) status_.last_frame = OperatorTime{clock_.now().ns};
  status_.shown = steps.visible();
  status_.focused = steps.focused();
  status_.trouble = status_.shown ? "" : "nobody wears the headset";
  status_.cure = status_.shown ? "" : "put it on";
}

HeadStatus HeadDisplay::status() const {
  const std::lock_guard lock(mutex_);
  return status_;
}

void HeadDisplay::finish() {
  try {
    if (open_ && open_->session && open_->session->steps().running()) {
      open_->session->request_exit();
      const RobotTime end = clock_.now() + kLongestEnd;
      for (int i = 0; i < kMostEndingRounds && !over_ && clock_.now() < end; ++i) {
        poll();
        if (open_ && open_->session && open_->session->steps().running()) open_->session->empty_frame();
      }
    }
  } catch (const CallFailed&) {
    // It has gone by itself.
  }
  over_ = true;
  close("the head display was closed", "", false);
}

}  // namespace foresight::head
