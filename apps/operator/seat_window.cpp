#include "apps/operator/seat_window.hpp"

#include <fmt/core.h>

#include <utility>

namespace foresight {
namespace {

/// From its lowest row on.
cv::Mat read_window(const ViewTarget& whole) {
  cv::Mat out(whole.height, whole.width, CV_8UC3);
  glPixelStorei(GL_PACK_ALIGNMENT, 1);
  glReadPixels(0, 0, whole.width, whole.height, GL_BGR, GL_UNSIGNED_BYTE, out.data);
  glPixelStorei(GL_PACK_ALIGNMENT, 4);
  return out;
}

}  // namespace

SeatWindow::SeatWindow(gl::Window& window, Seat& seat, PredictedSource& source, SeatWindowOptions options)
    : window_(window),
      seat_(seat),
      source_(source),
      options_(std::move(options)),
      views_(options_.views),
      hud_(options_.font_scale) {
  if (options_.views.mode != ViewMode::two_eyes) first_key_ = 0;  // who wears a head display sees no keyboard
}

void SeatWindow::take_input() {
  window_.wait_events(0);
  gl::WindowInput input = window_.take_input();
  views_.take_mouse(input, window_target(window_));
  if (options_.input) options_.input(input);
}

void SeatWindow::swap() {
  if (options_.pacer) options_.pacer->drawn();
  window_.present();
  if (options_.pacer) options_.pacer->swapped();
  image_way_.swapped(clock_.now());
}

void SeatWindow::next_marks() {
  if (options_.trust) marks_ = static_cast<TrustMarks>((static_cast<int>(marks_) + 1) % 3);
}

bool SeatWindow::trusted() const {
  const std::string why = source_.why_invalid();
  if (!options_.trust) return why.empty();
  options_.trust->judge(why);
  return !options_.trust->falls_back();
}

void SeatWindow::arrived(const PosedFrame& frame) {
  views_.arrived(frame);
  const auto& newest = source_.newest();
  const bool is_newest = newest && newest->image[0].captured == frame.left.time;
  image_way_.came(frame.left.time, is_newest ? RobotTime{newest->decoded.ns} : clock_.now());
  if (options_.trust) options_.trust->saw(frame);
}

TrustMarks SeatWindow::marks_to_draw() const {
  if (views_.shows_doubt()) return TrustMarks::hatch;  // these need as much to be known
  return views_.shows_marks() ? marks_ : TrustMarks::none;
}

void SeatWindow::stepped(const ViewStep& step, FrameSource& source, ViewSession& session) {
  if (step.arrival_to_publish_ms) to_textures_ = seconds(1e-3 * *step.arrival_to_publish_ms);
  if (!step.reports.empty()) image_costs_ = step.reports.back().stages;
  if (step.drawn) {
    if (const ImagesLease images = session.images()) image_way_.drawn(images->newest->image.time);
    const ViewPlace place = source.place();
    if (options_.trust) options_.trust->drew(source_, place, marks_to_draw());
    const double drawing_ms = options_.pacer ? 1e3 * to_seconds(options_.pacer->figures().last) : 0;
    views_.draw(session, place, window_target(window_), drawing_ms);
  }
  present(session);
}

void SeatWindow::waiting(FrameSource& /*source*/, ViewSession& session) {
  present(session);
}

StageTimes SeatWindow::stage_times() const {
  StageTimes out;
  if (const auto& newest = source_.newest(); newest && source_.fault().empty()) {
    out.ages = newest->ages;
    out.to_view = image_way_.to_view();
    out.to_textures = to_textures_;
    out.costs = image_costs_;
  }
  if (options_.pacer) out.drawing = options_.pacer->figures().cost;
  if (options_.input_took) out.to_set_point = options_.input_took();
  return out;
}

void SeatWindow::next_words() {
  const bool were_no_keys = !first_key_ && !few_lines_;
  few_lines_ = were_no_keys;
  if (!were_no_keys) first_key_ = keys_after(first_key_, hud_.next_key(), options_.keys.size());
}

HudContent SeatWindow::words(bool is_trusted) const {
  const SeatStatus status = seat_.status();
  HudContent out;
  out.title = fmt::format("{}: {}", options_.title, views_.words(is_trusted));
  if (marks_ != TrustMarks::none && is_trusted)
    out.title += fmt::format(" ({})", views_.shows_marks() ? to_string(marks_) : "no stripes in this view");
  if (views_.scale() < 1)
    out.title += fmt::format(" (at {:.0f} % of its size, to be drawn in time)", 1e2 * views_.scale());
  out.next = next_step(status);
  out.lines = seat_lines(status, options_.joints, source_.fault());
  if (options_.trust) out.lines.push_back(fidelity_line(*options_.trust, source_.fault()));
  for (SeatLine& line : stage_lines(stage_times())) out.lines.push_back(std::move(line));
  if (options_.more_lines)
    for (SeatLine& line : options_.more_lines()) out.lines.push_back(std::move(line));
  if (!save_trouble_.empty()) out.lines.push_back({"screenshot", save_trouble_, "", Urgency::note});
  if (!first_key_) return out;
  out.keys = options_.keys;
  out.first_key = *first_key_;
  return out;
}

void SeatWindow::save(const ViewTarget& whole) {
  tell_saved();
  if (!std::exchange(save_, false)) return;
  if (!screenshots_.take(read_window(whole)))
    save_trouble_ = "not taken: the disk still writes those before it; press P again later";
}

void SeatWindow::tell_saved() {
  while (const std::optional<Screenshot> saved = screenshots_.done()) {
    save_trouble_ = saved->trouble;
    if (save_trouble_.empty() && options_.log) options_.log("wrote " + saved->file.string());
  }
}

void SeatWindow::finish_saving() {
  screenshots_.finish();
  tell_saved();
  if (!save_trouble_.empty() && options_.log) options_.log("screenshot: " + save_trouble_);
}

void SeatWindow::log(const HudContent& content) {
  if (!options_.log) return;
  std::vector<SeatLine> lines = content.lines;
  lines.push_back(content.next);
  lines.push_back({"shown", content.title, ""});
  for (const std::string& news : log_.news(lines)) options_.log(news);
}

void SeatWindow::present(const ViewSession& session) {
  if (const auto& newest = source_.newest(); newest && newest != uploaded_) {
    views_.upload_newest(newest->image[0].bgr, newest->image[1].bgr);
    uploaded_ = newest;
  }
  const ViewTarget whole = window_target(window_);
  if (whole.width < 1 || whole.height < 1) {  // minimised
    swap();
    return;
  }
  const bool is_trusted = trusted();
  clear_behind_pictures(whole, !is_trusted && source_.lost());
  HudContent content = words(is_trusted);
  log(content);
  if (few_lines_) leave_out_fine(content.lines);
  SeatPicture picture;
  picture.trusted = is_trusted;
  if (options_.trust && marks_ != TrustMarks::none) picture.marked = &options_.trust->marked();
  if (options_.trust) picture.doubt = &options_.trust->doubt_picture();
  if (options_.trust) picture.risks = &options_.trust->risks();
  if (views_.mode() == ViewMode::interlaced) picture.window_top = window_.top_on_screen();
  const HandPicture hand = options_.hand && is_trusted ? options_.hand() : HandPicture{};
  picture.hand = &hand;
  for (SeatViews::Part& part : views_.show(session, whole, picture)) {
    content.labels = std::move(part.labels);
    content.area = part.words_area;
    content.clear = part.compared;
    hud_.draw(content, part.place);
  }
  save(whole);
  swap();
}

}  // namespace foresight
