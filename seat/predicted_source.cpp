#include "seat/predicted_source.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "link/operator_view/line_feed.hpp"
#include "rig/rig_scene.hpp"
#include "session/joint_tracks.hpp"

namespace foresight {
namespace {

constexpr Duration kLongestWait = std::chrono::milliseconds(50);  // FrameSource::advance()

JointPositions positions_of(const link::LineJoints& joints) {
  return [&joints](std::string_view name) { return joints.position(name); };
}

}  // namespace

PredictedSource::PredictedSource(const Rig& rig, std::shared_ptr<const LiveScene> scene, link::OperatorEnd& end,
                                 Seat& seat, Clock& clock, const PredictedSourceOptions& options)
    : rig_(rig),
      scene_(std::move(scene)),
      end_(end),
      seat_(seat),
      clock_(clock),
      options_(options),
      places_(rig, scene_),
      due_(clock.now()),
      heard_(clock.now()),
      looked_(heard_) {}

void PredictedSource::take_frames() {
  looked_ = clock_.now();
  std::vector<link::LineFramePtr> came;
  while (auto frame = end_.frames().take(Duration{0})) came.push_back(std::move(*frame));
  for (std::size_t i = 0; i < came.size(); ++i) {
    heard_ = looked_;
    newest_ = came[i];
    const auto at = [this](RobotTime time, const link::LineJoints& joints) {
      SceneState state = link::scene_at(rig_, *scene_, time, joints);
      if (things_) things_->place(state);
      return state;
    };
    auto posed = link::posed_frame(*newest_, at, options_.margin_px);
    const bool is_looked_at = i + kLookedAt >= came.size();
    if (posed && is_looked_at) {
      any_posed_ = true;
      places_.saw(posed->left, positions_of(newest_->joints));
      if (things_) let_things_see(newest_, *posed);
    }
    if (listener_) listener_(*newest_, posed ? &*posed : nullptr);
    if (!is_looked_at) {
      ++overtaken_;
      continue;
    }
    posed_ = posed.has_value();
    if (!posed) continue;
    if (waiting_) ++overtaken_;
    waiting_ = std::move(posed);
  }
}

// What the image itself says of where things were in it counts for its own textures, too.
void PredictedSource::let_things_see(const link::LineFramePtr& frame, PosedFrame& posed) {
  things_->saw(posed, [frame](std::string_view name) { return frame->joints.position(name); });
  things_->place(posed.left.scene);
  if (posed.right) things_->place(posed.right->scene);
}

// Often enough for what is gripped and falls, whatever the rate of pictures.
void PredictedSource::advance_things() {
  if (!things_ || clock_.now() < things_due_) return;
  things_due_ = clock_.now() + kThingsEvery;
  things_->advance(seat_.look_ahead());
}

// Of the grid of the robot's own images the newest instant that may be shown, if it was not yet.
std::optional<RobotTime> PredictedSource::next_instant(RobotTime until) {
  if (options_.image_period.count() > 0) {
    const Duration past = until - newest_->image[0].captured;
    if (past.count() < 0) return std::nullopt;
    until = newest_->image[0].captured + options_.image_period * (past / options_.image_period);
  }
  if (last_ && until <= *last_ && *last_ - until < kClockJump) return std::nullopt;
  return until;
}

SourceState PredictedSource::advance() {
  advance_things();
  if (options_.real_time) {
    clock_.sleep_until(std::min(due_, clock_.now() + kLongestWait));
    if (clock_.now() < due_) return SourceState::waiting;
    due_ = std::max(due_ + seconds(1 / options_.rate_hz), clock_.now());
  } else if (clock_.now() < due_) {
    return SourceState::waiting;
  }
  const bool closed = end_.frames().closed();
  take_frames();
  why_none_ = silent() ? link::why_no_images(end_) : "";
  if (closed) return SourceState::ended;
  const auto until = seat_.instant_to_show();
  if (!any_posed_) return SourceState::waiting;
  // Of a robot that has just come no clock is known before the first round trip, which a bad line may take seconds for.
  // Pictures go on meanwhile, of where the robot was shown last: the view still follows the head.
  const auto instant = until ? next_instant(*until) : last_;
  if (!instant) return SourceState::waiting;
  if (!options_.real_time) due_ = std::max(due_ + seconds(1 / options_.rate_hz), clock_.now());
  last_ = instant;
  robot_ = seat_.show(*instant);
  predicted_ = predicted_ || robot_.status != StateStatus::invalid;
  instant_ = {fmt::format("{:06}", static_cast<unsigned long long>(++pictures_)), *instant};
  return SourceState::ready;
}

ViewPlace PredictedSource::place() {
  ViewPlace out = places_.place(robot_);
  if (things_) things_->place(out.scene);
  return out;
}

std::string PredictedSource::why_invalid() const {
  if (const std::string images = fault(); !images.empty()) return images;
  if (robot_.status != StateStatus::invalid) return "";
  return to_words(robot_, rig_.joint_names());
}

std::optional<PosedFrame> PredictedSource::arrived() {
  return std::exchange(waiting_, std::nullopt);
}

std::string PredictedSource::fault() const {
  if (silent())
    return fmt::format("NO IMAGE for {:.1f} s{}{}", to_seconds(silence()), why_none_.empty() ? "" : ": ", why_none_);
  if (posed_) return "";
  return "NO POSE for the newest image" + why_no_pose(newest_->joints, homed_since_newest());
}

// What the robot says of itself is on its way for less long than an image.
bool PredictedSource::homed_since_newest() const {
  const auto heard = end_.robot_state();
  return heard && heard->state.all_homed && heard->state.time_ns > newest_->image[0].captured.ns;
}

// Whose drive told its position before is homed: looking for home again would not bring its word back.
std::string why_no_pose(const link::LineJoints& joints, bool homed_since) {
  std::vector<std::string> silent;
  for (std::size_t i = 0; i < joints.known.size(); ++i)
    if (!joints.known[i] && std::isfinite(joints.positions.at(i))) silent.push_back(joints.names.at(i));
  if (!silent.empty())
    return fmt::format(": {} {} no position any more", fmt::join(silent, ", "), silent.size() == 1 ? "tells" : "tell");
  const std::string why = unknown_joints(joints.known, 'H');
  if (!why.empty() && homed_since) return ": it was taken before all joints were homed; later ones are on their way";
  return why.empty() ? "" : ": " + why;
}

}  // namespace foresight
