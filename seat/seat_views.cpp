#include "seat/seat_views.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "seat/view_through.hpp"
#include "seat/words_areas.hpp"

namespace foresight {
namespace {

constexpr int kBetweenPictures = 4;  // px around pictures
constexpr int kInset = 4;            // share of the width that the newest image takes in its corner
constexpr int kInsetRows = 2;        // of the height, in a low window
constexpr double kReadable = 0.7;    // tangent: farther aside, words behind a lens are hard to read

/// What programs differ by.
struct Look {
  ViewMode mode;
  ViewPaint paint;
};
constexpr Look kLooks[] = {
    {ViewMode::split, ViewPaint::colours},    {ViewMode::predicted, ViewPaint::wireframe},
    {ViewMode::predicted, ViewPaint::age},    {ViewMode::predicted, ViewPaint::confidence},
    {ViewMode::two_eyes, ViewPaint::colours}, {ViewMode::interlaced, ViewPaint::colours},
    {ViewMode::anaglyph, ViewPaint::colours}, {ViewMode::anaglyph_colours, ViewPaint::colours},
    {ViewMode::observer, ViewPaint::colours}, {ViewMode::stereogram, ViewPaint::colours},
};

/// An area of a part of a window as a target of its own.
ViewTarget target_of(const HudArea& area, const ViewTarget& part) {
  ViewTarget out = part;
  out.width = std::max(1, static_cast<int>(area.width));
  out.height = std::max(1, static_cast<int>(area.height));
  out.x = part.x + static_cast<int>(area.left);
  out.y = part.y + part.height - static_cast<int>(area.top) - out.height;
  return out;
}

/// Of a window's part, from the window's top.
int top_of(const ViewTarget& part, const ViewTarget& whole) {
  return whole.height - part.y - part.height;
}

/// Of pictures through such a lens.
HudRows rows_side_by_side(const ViewTarget& whole, const Lens& lens) {
  const ViewTarget picture = fitted(column(whole, 0, 2, kBetweenPictures), lens.width(), lens.height());
  const int top = top_of(picture, whole);
  return {static_cast<double>(top), static_cast<double>(top + picture.height)};
}

}  // namespace

ViewTarget inset_place(const ViewTarget& place, int width, int height) {
  ViewTarget most = place;
  most.width = std::max(1, place.width / kInset);
  most.height = std::max(1, place.height / kInsetRows);
  ViewTarget out = fitted(most, std::max(1, width), std::max(1, height));
  out.x = place.x + place.width - out.width - kBetweenPictures;
  out.y = place.y + place.height - out.height - kBetweenPictures;  // windows begin at the bottom
  return out;
}

bool begins_at_odd_row(int window_top, const ViewTarget& whole, const ViewTarget& part) {
  return (window_top + top_of(part, whole)) % 2 != 0;
}

SeatViews::SeatViews(const SeatViewsSetup& setup)
    : setup_(setup),
      mode_(setup.mode),
      size_(setup.left, setup.most_drawing_ms, setup.few_pixels),
      overlay_(setup.left),
      beside_(setup.left, setup.right),
      newest_{UploadedPicture("newest left image"), UploadedPicture("newest right image")} {
  if (!setup_.panels) return;  // else what stands in for a prediction is not to wait for programs
  bent_[0][0].emplace(setup_.left);
  bent_[1][setup_.right ? 1 : 0].emplace(setup_.right.value_or(setup_.left));
}

void SeatViews::next_main() {
  const int mode = static_cast<int>(mode_);
  mode_ = static_cast<ViewMode>(mode < kMainModes ? (mode + 1) % kMainModes : 0);
}

void SeatViews::next_stereo() {
  if (!has_two_eyes(mode_))
    mode_ = ViewMode::two_eyes;
  else if (mode_ == ViewMode::anaglyph_colours)
    mode_ = ViewMode::predicted;
  else
    mode_ = static_cast<ViewMode>(static_cast<int>(mode_) + 1);
}

void SeatViews::toggle_observer() {
  mode_ = mode_ == ViewMode::observer ? ViewMode::predicted : ViewMode::observer;
}

void SeatViews::toggle_stereogram() {
  mode_ = mode_ == ViewMode::stereogram ? ViewMode::predicted : ViewMode::stereogram;
}

void SeatViews::next_paint() {
  paint_ = static_cast<ViewPaint>((static_cast<int>(paint_) + 1) % kViewPaints);
}

// Without trust, what shows both still does, side by side and told apart.
ViewMode SeatViews::mode_now(bool trusted) const {
  const bool has_newest = !newest_[0].empty();
  if (!trusted && (mode_ == ViewMode::predicted || mode_ == ViewMode::stereogram || mode_ == ViewMode::observer))
    return ViewMode::newest;
  if (mode_ == ViewMode::stereogram && !has_stereogram_) return ViewMode::predicted;
  if (mode_ == ViewMode::observer && !has_beside_) return ViewMode::predicted;
  if (mode_ == ViewMode::split && !has_newest) return ViewMode::predicted;
  if (has_two_eyes(mode_) && trusted && !has_eyes_) return ViewMode::predicted;
  return mode_;
}

std::string SeatViews::words(bool trusted) const {
  std::string out = to_string(mode_);
  const bool shows_both = mode_ == ViewMode::both || mode_ == ViewMode::split;
  if (!trusted && newest_[0].empty()) return "no image has come yet";
  if (!trusted && shows_both)
    out += " (as prediction cannot be trusted, look at the newest image)";
  else if (!trusted && mode_ != ViewMode::newest)
    return "the newest image, as prediction cannot be trusted";
  if (mode_ == ViewMode::stereogram) return out + ": " + stereogram_look_.words();
  if (eyes_swapped_ && has_two_eyes(mode_)) out += ", eyes swapped";
  if (paint_ == ViewPaint::doubt && !is_one_eyes())
    out += "; errors are shown to one eye only";
  else if (paint_ != ViewPaint::colours && mode_ != ViewMode::newest)
    out += std::string("; ") + to_string(paint_);
  return out;
}

void SeatViews::take_mouse(gl::WindowInput& input, const ViewTarget& whole) {
  bool ours = mode_ == ViewMode::observer;
  if (ours) {
    beside_.take_mouse(input, whole.height);
  } else if (mode_ == ViewMode::split) {
    const ViewTarget place = fitted(whole, setup_.left.width(), setup_.left.height());
    ours = border_.drag(input.x - place.x, place.width, input.pressed, input.left);
  }
  keeps_mouse_ = (keeps_mouse_ || ours) && (input.left || input.other);
  if (!ours && !keeps_mouse_) return;
  input.left = input.other = input.pressed = false;
  input.moved_x = input.moved_y = input.scrolled = 0;
}

Pose SeatViews::looks_from(const Pose& T_world_operator) const {
  return mode_ == ViewMode::observer && beside_.eye() ? beside_.eye()->T_world_eye() : T_world_operator;
}

void SeatViews::upload_newest(const cv::Mat& left, const cv::Mat& right) {
  newest_[0].upload(left);
  if (!right.empty()) newest_[1].upload(right);
}

void SeatViews::draw(ViewSession& session, const ViewPlace& place, const ViewTarget& whole, double drawing_ms) {
  drawn_ = place;
  shows_again_ = has_eyes_ = has_beside_ = has_stereogram_ = false;
  if (whole.width < 1 || whole.height < 1) return;  // minimised
  if (has_two_eyes(mode_)) {
    draw_eyes(session, place, whole, drawing_ms);
  } else if (mode_ == ViewMode::stereogram) {
    const ViewTarget part = fitted(whole, setup_.left.width(), setup_.left.height());
    if (!stereogram_) stereogram_.emplace(session.make_depth_pass());
    stereogram_->draw(stereogram_look_, place.T_world_camera, place.scene, setup_.left, part.width, part.height);
    has_stereogram_ = true;
  } else if (mode_ == ViewMode::observer) {
    has_beside_ = beside_.draw(session, place, whole, paint_of_views());
  } else {
    draw_again(session, place, whole, drawing_ms);
  }
  session.set_lens(size_.own());  // from the next picture on
}

bool SeatViews::warm_up(ViewSession& session, const ViewTarget& whole) {
  if (!drawn_ || warm_ == std::size(kLooks)) return false;
  const Look look = kLooks[warm_++];
  const ViewMode mode = std::exchange(mode_, look.mode);
  const ViewPaint paint = std::exchange(paint_, look.paint);
  const std::optional<Eye> eye = beside_.eye();
  draw(session, ViewPlace(*drawn_), whole, 0);
  show(session, whole, {});
  glFinish();
  mode_ = mode;
  paint_ = paint;
  beside_.stand(eye);
  shows_again_ = false;  // it may be painted now
  return true;
}

// Panels have more pixels than there are in a window's half, and than can be drawn in time.
std::array<Lens, 2> SeatViews::eye_lenses(const ViewTarget& whole) const {
  if (!shows_panels()) return {setup_.left, setup_.left};
  const ViewTarget half = column(whole, 0, 2, 0);
  const auto fits = [&](const Lens& panel) { return fitted_lens(panel, half.width, half.height); };
  return {fits((*setup_.panels)[0]), fits((*setup_.panels)[1])};
}

void SeatViews::draw_eyes(ViewSession& session, const ViewPlace& place, const ViewTarget& whole, double drawing_ms) {
  std::array<Lens, 2> lenses = eye_lenses(whole);
  size_.choose_for(lenses, whole.width, whole.height, drawing_ms);
  for (Lens& lens : lenses) lens = scaled_lens(lens, size_.scale());
  std::optional<EyePair>& pair = shows_panels() ? panels_ : eyes_;
  if (!pair) pair.emplace(session, lenses, setup_.eyes_apart);
  pair->set_lenses(lenses);
  pair->set_paint(paint_of_views());
  pair->show_vignetting(!shows_panels());
  has_eyes_ = pair->draw(place.T_world_camera, place.scene);
}

// The operator's eye with more pixels, or painted.
void SeatViews::draw_again(ViewSession& session, const ViewPlace& place, const ViewTarget& whole, double drawing_ms) {
  if (mode_ == ViewMode::newest) return;
  const ViewTarget part = mode_ == ViewMode::both ? column(whole, 1, 2, kBetweenPictures) : whole;
  size_.choose(part.width, part.height, drawing_ms);
  if (!size_.lens() && paint_of_views() == ViewPaint::colours) return;
  PredictedView& view = view_through(again_, session, size_.lens().value_or(size_.own()));
  view.set_paint(paint_of_views());
  view.show_vignetting(true);
  shows_again_ = session.draw(view, place.T_world_camera, place.scene);
}

SeatViews::Sight SeatViews::predicted(const ViewSession& session, const SeatPicture& what) {
  if (!drawn_) return {};
  // Whatever its size, it is seen through the same lens: lines lie by the session's own depths.
  Sight out{&session.picture(), &session.faces(), &session.view().lens(), drawn_->T_world_camera};
  if (what.doubt && what.risks && shows_doubt()) {
    if (!doubt_) doubt_.emplace();
    out.picture = &(*doubt_)(session.picture(), *what.doubt, *what.risks);
  } else if (what.marked && shows_marks()) {
    out.picture = what.marked;
  } else if (shows_again_) {
    out.picture = &again_->picture();
  }
  return out;
}

SeatViews::Sight SeatViews::newest(std::size_t eye) const {
  const UploadedPicture& picture = newest_[eye == 1 && !newest_[1].empty() ? 1 : 0];
  return picture.empty() ? Sight{} : Sight{&picture.texture()};
}

SeatViews::Sight SeatViews::newest_on_panel(std::size_t eye, const Lens& panel) {
  const std::size_t camera = eye == 1 && !newest_[1].empty() ? 1 : 0;
  if (newest_[camera].empty()) return {};
  std::optional<BentImage>& bent = bent_[eye][camera];
  if (!bent) bent.emplace(camera == 1 ? setup_.right.value_or(setup_.left) : setup_.left);
  return {&(*bent)(newest_[camera].texture(), panel)};
}

SeatViews::Sight SeatViews::eye(std::size_t index, bool trusted, const ViewTarget& whole) {
  if (!trusted || !has_eyes_) return shows_panels() ? newest_on_panel(index, eye_lenses(whole)[index]) : newest(index);
  const EyePair& pair = shows_panels() ? *panels_ : *eyes_;
  return {&pair.picture(index), &pair.faces(index), &pair.lens(index), drawn_->T_world_camera * pair.T_view_eye(index)};
}

// The picture, and over it what there is to see of the hand, whose words go beside it.
void SeatViews::put(const Sight& sight, const ViewTarget& place, const SeatPicture& what, std::vector<HudLabel>& labels,
                    const ViewTarget& whole) {
  if (!sight.picture) return;
  const ViewTarget view = fitted(place, sight.picture->width(), sight.picture->height());
  copy_(*sight.picture, view);
  if (!sight.faces || !what.hand || !what.trusted) return;
  overlay_.set_lens(*sight.lens);
  overlay_.draw(what.hand->lines, sight.T_world_eye, *sight.faces, view);
  for (const WorldLabel& label : what.hand->labels)
    if (const auto at = seen_at(label.at, *sight.lens, sight.T_world_eye, view, whole.height))
      labels.push_back({at->x(), at->y(), label.words, label.urgency});
}

const ViewTarget& SeatViews::canvas(std::size_t index, const ViewTarget& place) {
  Canvas& canvas = canvas_[index];
  if (!canvas.target || canvas.picture.width() != place.width || canvas.picture.height() != place.height) {
    canvas.target.reset();
    canvas.picture = gl::Texture(GL_RGBA8, place.width, place.height, 0, 1, "eye's canvas");
    canvas.target.emplace(canvas.picture.name(), place.width, place.height);
  }
  fill(canvas.target->whole(), 0, 0, 0);  // pictures may leave a row or a column by rounding
  return canvas.target->whole();
}

// Mixed at the place's own size: its rows are the screen's. Words of the hand stand where the second picture has them:
// in a split, it is the one that is predicted. For two eyes, what is kWordsAway from them lies in the screen, as all
// words do; else the screen would be infinitely far, and they behind all that they cover.
void SeatViews::put_mixed(const Sight& first, const Sight& second, const ViewTarget& place, const ViewTarget& whole,
                          PictureMix::Way way, const SeatPicture& what, std::vector<HudLabel>& labels) {
  if (!first.picture || !second.picture) return;
  const ViewTarget part = fitted(place, setup_.left.width(), setup_.left.height());
  std::vector<HudLabel> of_first;
  const bool for_eyes = way != PictureMix::Way::split, swaps = eyes_swapped_ && for_eyes;
  const Lens::Parameters& p = setup_.left.parameters();
  const double apart = for_eyes ? setup_.eyes_apart * p.fx * part.width / (p.width * kWordsAway) : 0;  // px
  ViewTarget of_left = canvas(swaps ? 1 : 0, part), of_right = canvas(swaps ? 0 : 1, part);
  of_left.x -= static_cast<int>(std::lround(0.5 * apart));
  of_right.x += static_cast<int>(std::lround(0.5 * apart));
  put(first, of_left, what, swaps ? labels : of_first, whole);
  put(second, of_right, what, swaps ? of_first : labels, whole);
  for (HudLabel& label : labels) label.x += part.x, label.y += top_of(part, whole);
  if (way == PictureMix::Way::split)
    std::erase_if(labels, [&](const HudLabel& label) { return label.x < part.x + border_.at() * part.width; });
  const bool odd = begins_at_odd_row(what.window_top, whole, part);
  copy_(mix_(canvas_[0].picture, canvas_[1].picture, part.width, part.height, {way, border_.at(), odd}), part);
}

void SeatViews::put_inset(const ViewTarget& place) const {
  if (newest_[0].empty()) return;
  const gl::Texture& picture = newest_[0].texture();
  copy_(picture, inset_place(place, picture.width(), picture.height()));
}

// Words and the newest image's corner stand at one place before both eyes.
void SeatViews::show_two_eyes(const ViewTarget& whole, const ViewTarget& place, const SeatPicture& what,
                              std::vector<Part>& parts) {
  parts = {{column(place, 0, 2, 0)}, {column(place, 1, 2, 0)}};
  std::array<Lens, 2> lenses = eye_lenses(whole);
  if (eyes_swapped_) std::swap(lenses[0], lenses[1]);
  const auto areas =
      words_areas(lenses, {parts[0].place, parts[1].place}, eyes_swapped_ ? -setup_.eyes_apart : setup_.eyes_apart,
                  shows_panels() ? kReadable : std::numeric_limits<double>::infinity());
  for (std::size_t i = 0; i < parts.size(); ++i) {
    Part& part = parts[i];
    put(eye(eyes_swapped_ ? 1 - i : i, what.trusted, whole), part.place, what, part.labels, whole);
    part.words_area = areas[i];
    if (what.trusted) put_inset(target_of(areas[i], part.place));
  }
}

std::vector<SeatViews::Part> SeatViews::show(const ViewSession& session, const ViewTarget& whole,
                                             const SeatPicture& what) {
  const ViewMode mode = mode_now(what.trusted);
  // What is not to be trusted has a frame around it, of what is behind the pictures.
  const ViewTarget place = what.trusted ? whole : column(whole, 0, 1, kBetweenPictures);
  std::vector<Part> parts{{whole}};
  std::vector<HudLabel>& labels = parts.front().labels;
  const auto mixed_eyes = [&](PictureMix::Way way) {
    put_mixed(eye(0, what.trusted, whole), eye(1, what.trusted, whole), place, whole, way, what, labels);
    if (what.trusted) put_inset(place);
  };
  switch (mode) {
    case ViewMode::predicted:
      put(predicted(session, what), place, what, labels, whole);
      put_inset(place);
      break;
    case ViewMode::newest: put(newest(0), column(whole, 0, 1, kBetweenPictures), what, labels, whole); break;
    case ViewMode::both:
      put(newest(0), column(whole, 0, 2, kBetweenPictures), what, labels, whole);
      put(predicted(session, what), column(whole, 1, 2, kBetweenPictures), what, labels, whole);
      parts.front().compared = rows_side_by_side(whole, setup_.left);
      break;
    case ViewMode::split:
      put_mixed(newest(0), predicted(session, what), place, whole, PictureMix::Way::split, what, labels);
      break;
    case ViewMode::two_eyes: show_two_eyes(whole, place, what, parts); break;
    case ViewMode::interlaced: mixed_eyes(PictureMix::Way::rows); break;
    case ViewMode::anaglyph: mixed_eyes(PictureMix::Way::anaglyph); break;
    case ViewMode::anaglyph_colours: mixed_eyes(PictureMix::Way::anaglyph_colours); break;
    case ViewMode::stereogram:
      put({&stereogram_->picture()}, place, what, labels, whole);
      put_inset(place);
      break;
    case ViewMode::observer:
      put({&beside_.view().picture(), &beside_.view().faces(), &beside_.view().lens(), beside_.eye()->T_world_eye()},
          place, what, labels, whole);
      break;
  }
  for (Part& part : parts)
    for (HudLabel& label : part.labels) {
      label.x -= part.place.x;
      label.y -= top_of(part.place, whole);
    }
  return parts;
}

}  // namespace foresight
