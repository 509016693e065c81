#include "display/head/eye_warper.hpp"

#include <algorithm>
#include <cmath>

namespace foresight::head {
namespace {

constexpr double kFrameTimeout = 20;  // s
constexpr int kOwnFrames = 90;        // until the right eye's frame is tried again from the left one's
constexpr double kSideGuard = 0.14;   // rad: what the right eye sees beyond the left one's border, 65 mm at 0.45 m

Lens lens_of(const EyeAim& aim) {
  return aim.panel ? *aim.panel : eye_lens(aim.fov, aim.width, aim.height);
}

/// The same with more columns at its right.
Lens with_side(const EyeAim& aim) {
  Lens::Parameters p = lens_of(aim).parameters();
  p.width += static_cast<int>(std::lround(kSideGuard * p.fx));
  return Lens(p);
}

}  // namespace

EyeWarper::EyeWarper(DrawnViews& views, Clock& clock, SecondEyeFrom second)
    : views_(views), clock_(clock), from_(second) {}

void EyeWarper::begin(const SceneState& state) {
  const RobotTime now = clock_.now();
  if (began_) interval_ = now - *began_;
  began_ = now;
  views_.frame_begins();
  newest_ = views_.newest();
  aim_.state = state;
  ++counts_.frames;
}

DepthWarp& EyeWarper::warp_through(std::size_t eye, const Lens& lens, bool tells) {
  auto& own = warps_[eye];
  if (!own || !alike(own->lens(), lens) || (tells && !own->tells())) own.emplace(views_.parts(), lens, tells);
  return *own;
}

const gl::Texture* EyeWarper::warp(std::size_t eye, const Lens& lens, const EyeAim& aim) {
  if (!newest_ || !newest_->eyes[eye]) return nullptr;
  DepthWarp& own = warp_through(eye, lens, from_ == SecondEyeFrom::first_eye || newest_->behind[eye]);
  own(*newest_->eyes[eye], aim.T_world_eye, aim_.state.T_world_node);
  if (newest_->behind[eye]) own.mend(*newest_->behind[eye], aim.T_world_eye, aim_.state.T_world_node);
  return &own.picture();
}

// Of the first eye's frame where that fits and has not torn lately, else of a view of its own.
const gl::Texture* EyeWarper::make_second(const EyeAim& aim) {
  const Lens& lens = lenses_[1](aim, lens_of);
  if (own_frames_ == 0 && newest_) {
    const Pose T_first_second = aim_.eyes[0].T_world_eye.inverse() * aim.T_world_eye;
    if (newest_->eyes[0] && SecondEye::fits(warps_[0]->lens(), lens, T_first_second))
      return make_of_first(lens, aim, T_first_second.translation().x());
    tear();
  }
  own_frames_ = std::max(own_frames_ - 1, 0);
  return warp(1, lens, aim);
}

const gl::Texture* EyeWarper::make_of_first(const Lens& lens, const EyeAim& aim, double apart) {
  const DepthWarp& first = *warps_[0];
  if (!second_ || !alike(second_->lens(), lens)) second_ = std::make_unique<SecondEye>(first.lens(), lens);
  (*second_)(first.picture(), first.depth(), apart);
  ++counts_.of_first;
  double unseen = second_->unseen();
  if (newest_->behind[0]) {
    DepthWarp& mender = warp_through(1, lens, true);
    mender.mend(*newest_->behind[0], aim.T_world_eye, aim_.state.T_world_node, second_->picture(), second_->holes());
    unseen -= mender.mended();
  }
  if (unseen > kMostTorn) tear();
  return &second_->picture();
}

void EyeWarper::tear() {
  own_frames_ = kOwnFrames;
  ++counts_.torn;
}

const gl::Texture* EyeWarper::operator()(std::size_t eye, const EyeAim& aim) {
  aim_.eyes[eye] = aim;
  const bool of_first = from_ == SecondEyeFrom::first_eye;
  const gl::Texture* out = nullptr;
  if (eye == 1 && of_first)
    out = make_second(aim);
  else
    out = warp(eye, lenses_[eye](aim, of_first ? with_side : lens_of), aim);
  if (!out) ++counts_.nothing;
  return out;
}

void EyeWarper::end() {
  aim_.second_eye = from_ == SecondEyeFrom::own_view || own_frames_ > 0;
  if (aim_.eyes[0].width > 0 && aim_.eyes[1].width > 0) views_.aim(aim_);
  if (newest_) views_.shown();
  gl::Fence::insert().wait(kFrameTimeout);
  views_.frame_ends(*began_ + interval_);
}

}  // namespace foresight::head
