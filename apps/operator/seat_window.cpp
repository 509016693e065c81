#include "apps/operator/seat_window.hpp"

#include <fmt/core.h>

#include <opencv2/imgproc.hpp>

#include "apps/view_outputs.hpp"
#include "display/view_window.hpp"

namespace foresight {
namespace {

constexpr int kGap = 4;    // px around pictures
constexpr int kInset = 4;  // share of the window's width that the delayed image takes in its corner

ViewTarget corner_of(const ViewTarget& whole, int width, int height) {
  ViewTarget out = whole;
  out.width = std::max(1, whole.width / kInset);
  out.height = std::max(1, out.width * height / std::max(1, width));
  out.x = whole.x + whole.width - out.width - kGap;
  out.y = whole.y + whole.height - out.height - kGap;  // windows begin at the bottom
  return out;
}

cv::Mat read_window(const ViewTarget& whole) {
  cv::Mat out(whole.height, whole.width, CV_8UC3);
  glPixelStorei(GL_PACK_ALIGNMENT, 1);
  glReadPixels(0, 0, whole.width, whole.height, GL_BGR, GL_UNSIGNED_BYTE, out.data);
  glPixelStorei(GL_PACK_ALIGNMENT, 4);
  cv::flip(out, out, 0);
  return out;
}

}  // namespace

const char* to_string(SeatPicture picture) {
  switch (picture) {
    case SeatPicture::predicted: return "as it will be";
    case SeatPicture::delayed: return "the newest image";
    case SeatPicture::both: return "newest image | as it will be";
  }
  return "";
}

SeatWindow::SeatWindow(gl::Window& window, ViewSession& session, const Lens& lens, Seat& seat, PredictedSource& source,
                       SeatWindowOptions options)
    : window_(window),
      seat_(seat),
      source_(source),
      options_(std::move(options)),
      hud_(options_.font_scale),
      lens_(lens),
      overlay_(lens),
      delayed_("newest image") {
  if (options_.eyes_apart) eyes_.emplace(session, lens, *options_.eyes_apart);
}

void SeatWindow::next_picture() {
  options_.picture = static_cast<SeatPicture>((static_cast<int>(options_.picture) + 1) % 3);
}

void SeatWindow::take_input() {
  window_.wait_events(0);
  if (options_.input) options_.input(window_.take_input());
}

void SeatWindow::swap() {
  if (options_.pacer) options_.pacer->drawn();
  window_.present();
  if (options_.pacer) options_.pacer->swapped();
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
  if (options_.trust) options_.trust->saw(frame);
}

void SeatWindow::stepped(const ViewStep& step, FrameSource& source, ViewSession& session) {
  drawn_ = drawn_ || step.drawn;
  if (step.drawn) {
    const ViewPlace place = source.place();
    T_world_camera_ = place.T_world_camera;
    faces_ = &session.faces();
    if (eyes_) eyes_->draw(place.T_world_camera, place.scene);
  }
  if (step.drawn && options_.trust) options_.trust->drew(source_, source_.place(), marks_);
  present(drawn_ ? &session.picture() : nullptr);
}

void SeatWindow::waiting(FrameSource& /*source*/, ViewSession& session) {
  present(drawn_ ? &session.picture() : nullptr);
}

SeatWindow::DrawnView SeatWindow::drawn_view(const gl::Texture* predicted, std::size_t eye) const {
  if (!eyes_ || !predicted) return {predicted, T_world_camera_, faces_};
  return {&eyes_->picture(eye), T_world_camera_ * eyes_->T_view_eye(eye), &eyes_->faces(eye)};
}

// The view, and over it what there is to see of the hand, whose words go beside it.
std::vector<HudLabel> SeatWindow::show_predicted(const DrawnView& predicted, const ViewTarget& place) {
  const ViewTarget view = fitted(place, predicted.picture->width(), predicted.picture->height());
  copy_(*predicted.picture, view);
  std::vector<HudLabel> labels;
  if (!options_.hand || !predicted.faces || !trusted()) return labels;
  const HandPicture hand = options_.hand();
  overlay_.draw(hand.lines, predicted.T_world_camera, *predicted.faces, view);
  const int height = window_target(window_).height;
  for (const WorldLabel& label : hand.labels)
    if (const auto at = seen_at(label.at, lens_, predicted.T_world_camera, view, height))
      labels.push_back({at->x(), at->y(), label.words, label.urgency});
  return labels;
}

HudContent SeatWindow::words(bool is_trusted) const {
  const SeatStatus status = seat_.status();
  HudContent out;
  out.title = fmt::format("{}: {}", options_.title,
                          is_trusted || options_.picture == SeatPicture::delayed
                              ? to_string(options_.picture)
                              : "the newest image, as prediction cannot be trusted");
  if (marks_ != TrustMarks::none) out.title += fmt::format(" ({})", to_string(marks_));
  out.next = next_step(status);
  out.lines = seat_lines(status, options_.joints, source_.fault());
  if (options_.trust) out.lines.push_back(fidelity_line(*options_.trust));
  if (options_.more_lines)
    for (SeatLine& line : options_.more_lines()) out.lines.push_back(std::move(line));
  if (help_) out.keys = options_.keys;
  return out;
}

void SeatWindow::save(const ViewTarget& whole) {
  if (!save_) return;
  write_png(*save_, read_window(whole));
  if (options_.log) options_.log("wrote " + save_->string());
  save_.reset();
}

void SeatWindow::log(const HudContent& content) {
  if (!options_.log) return;
  std::vector<SeatLine> lines = content.lines;
  lines.push_back(content.next);
  lines.push_back({"shown", content.title, ""});
  for (const std::string& news : log_.news(lines)) options_.log(news);
}

std::vector<HudLabel> SeatWindow::show_pictures(const ViewTarget& place, const DrawnView& predicted, bool is_trusted) {
  const auto show = [&](const gl::Texture& picture, const ViewTarget& part) {
    copy_(picture, fitted(part, picture.width(), picture.height()));
  };
  std::vector<HudLabel> labels;
  SeatPicture picture = options_.picture;
  if (!is_trusted && picture == SeatPicture::predicted) picture = SeatPicture::delayed;
  if (picture == SeatPicture::both) {
    if (!delayed_.empty()) show(delayed_.texture(), column(place, 0, 2, kGap));
    if (predicted.picture) labels = show_predicted(predicted, column(place, 1, 2, kGap));
  } else if (picture == SeatPicture::delayed) {
    if (!delayed_.empty()) show(delayed_.texture(), column(place, 0, 1, kGap));
  } else if (predicted.picture) {
    labels = show_predicted(predicted, column(place, 0, 1, 0));
    if (!delayed_.empty()) {
      const gl::Texture& texture = delayed_.texture();
      copy_(texture, corner_of(place, texture.width(), texture.height()));
    }
  }
  return labels;
}

void SeatWindow::present(const gl::Texture* predicted) {
  if (const auto& newest = source_.newest(); newest && newest != uploaded_) {
    delayed_.upload(newest->image[0].bgr);
    uploaded_ = newest;
  }
  const ViewTarget whole = window_target(window_);
  if (whole.width < 1 || whole.height < 1) {  // minimised
    swap();
    return;
  }
  const bool is_trusted = trusted();
  if (predicted && marks_ != TrustMarks::none) predicted = &options_.trust->marked();
  clear_behind_pictures(whole, !is_trusted && drawn_);
  HudContent content = words(is_trusted);
  log(content);
  const int eyes = eyes_ ? 2 : 1;
  for (int eye = 0; eye < eyes; ++eye) {
    const ViewTarget part = column(whole, eye, eyes, 0);
    content.labels = show_pictures(part, drawn_view(predicted, static_cast<std::size_t>(eye)), is_trusted);
    for (HudLabel& label : content.labels) {
      label.x -= part.x;
      label.y -= whole.height - part.y - part.height;
    }
    hud_.draw(content, part);
  }
  save(whole);
  swap();
}

}  // namespace foresight
