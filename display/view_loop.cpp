#include "display/view_loop.hpp"

#include <algorithm>

#include "texture_gpu/stage_clock.hpp"

namespace foresight {
namespace {

double milliseconds(std::chrono::steady_clock::duration d) {
  return std::chrono::duration<double, std::milli>(d).count();
}

}  // namespace

ViewLoop::ViewLoop(ViewSession& session, FrameSource& source, std::vector<ViewObserver*> observers,
                   std::function<bool()> stopped)
    : session_(session), source_(source), observers_(std::move(observers)), stopped_(std::move(stopped)) {}

bool ViewLoop::done() const {
  return stopped_() || !std::ranges::all_of(observers_, [](const ViewObserver* o) { return o->wants_more(); });
}

SourceState ViewLoop::step() {
  if (done()) return SourceState::ended;
  const SourceState state = source_.advance();
  if (state == SourceState::waiting) {
    session_.give_back();
    for (ViewObserver* observer : observers_) observer->waiting(source_, session_);
  }
  if (state != SourceState::ready) return state;
  ViewStep step{source_.instant()};
  if (!step.instant.late) {
    feed(step);
    if (done()) return SourceState::ended;
    if (!step.instant.blind) draw(step);
    follow(step);
  }
  for (ViewObserver* observer : observers_) observer->stepped(step, source_, session_);
  return SourceState::ready;
}

void ViewLoop::feed(ViewStep& step) {
  while (!done()) {
    std::optional<PosedFrame> frame = source_.arrived();
    if (!frame) break;
    for (ViewObserver* observer : observers_) observer->arrived(*frame);
    if (source_.real_time()) {
      submit(std::move(*frame));
      continue;
    }
    follow(step);
    arrival_ = Arrival{Clock::now(), process_cpu_ms()};
    session_.show(std::move(*frame));
  }
  if (!source_.real_time()) return;
  if (auto report = session_.take_report()) {
    step.arrival_to_publish_ms = latency(*report);
    step.reports.push_back(std::move(*report));
  }
}

/// The textures of the frame that was shown last, if they did not follow yet.
void ViewLoop::follow(ViewStep& step) {
  if (!arrival_) return;
  if (auto report = session_.follow()) {
    step.arrival_to_publish_ms = milliseconds(report->published_at - arrival_->time);
    step.reports.push_back(std::move(*report));
  }
  arrival_.reset();
}

void ViewLoop::submit(PosedFrame frame) {
  submitted_.emplace_back(Clock::now(), frame.left.time);
  session_.submit(std::move(frame));
}

std::optional<double> ViewLoop::latency(const ExtractionReport& report) {
  while (!submitted_.empty() && submitted_.front().second < report.newest_image) submitted_.pop_front();
  if (submitted_.empty() || submitted_.front().second != report.newest_image) return std::nullopt;
  return milliseconds(report.published_at - submitted_.front().first);
}

void ViewLoop::draw(ViewStep& step) {
  const double before = process_cpu_ms();
  const ViewPlace place = source_.place();
  step.drawn = session_.draw(place.T_world_camera, place.scene);
  if (arrival_) {
    session_.finish();
    step.arrival_to_visible_ms = milliseconds(Clock::now() - arrival_->time);
    step.arrival_to_visible_cpu_ms = process_cpu_ms() - arrival_->cpu_ms;
  }
  step.draw_cpu_ms = process_cpu_ms() - before;
}

}  // namespace foresight
