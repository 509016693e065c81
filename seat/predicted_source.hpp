// Frames that come over the line, shown as the robot will be: a source for ViewLoop whose instants lie in the future.
#pragma once

#include <functional>

#include "display/frame_source.hpp"
#include "seat/predicted_place.hpp"
#include "seat/seat.hpp"
#include "seat/things_outlook.hpp"

namespace foresight {

struct PredictedSourceOptions {
  bool real_time = true;
  double rate_hz = 30;     ///< of pictures, at most; > 0
  double margin_px = 1.5;  ///< LiveFrameOptions::margin_px
  /// Above 0, pictures are of the instants of the robot's own images, which are so far apart: who measures compares
  /// like with like.
  Duration image_period{0};
  Duration silent_after = std::chrono::milliseconds(1000);  ///< without an image: fault() says so
};

/// Why an image has no pose, by what its joints told: ": pan tells no position any more", or that joints have to be
/// homed; "" where all were known. `homed_since`: all were homed after it was taken, and nothing is to be done.
std::string why_no_pose(const link::LineJoints& joints, bool homed_since);

/// One thread. In stepped time, advance() does not wait.
class PredictedSource final : public FrameSource {
 public:
  /// All must outlive this.
  PredictedSource(const Rig& rig, std::shared_ptr<const LiveScene> scene, link::OperatorEnd& end, Seat& seat,
                  Clock& clock, const PredictedSourceOptions& options);

  bool real_time() const override { return options_.real_time; }
  SourceState advance() override;
  const ShownInstant& instant() const override { return instant_; }
  std::optional<PosedFrame> arrived() override;
  ViewPlace place() override;
  /// What the camera saw last, as far as it has come.
  cv::Mat actual() override { return newest_ ? newest_->image[0].bgr : cv::Mat(); }
  std::uint64_t overtaken() const override { return overtaken_; }
  std::string fault() const override;

  /// From now on things are where these say, which are told of the robot and shown all images; null: where the model
  /// has them. Outlives this.
  void show_things(ThingsOutlook* things) { things_ = things; }
  /// Of every frame that comes, in this source's thread; the other is null where its poses are not known.
  using Listener = std::function<void(const link::LineFrame&, const PosedFrame*)>;
  void listen(Listener heard) { listener_ = std::move(heard); }
  /// The robot as it is shown.
  const PredictedRobot& robot() const { return robot_; }
  /// Why it cannot be trusted, in words; "" where it can.
  std::string why_invalid() const;
  /// What stands in for a prediction is to warn whoever looks at it: there was one before, or images have ended. Before
  /// the first one, as while joints are not homed, there is a reason, but nothing to be warned of.
  bool lost() const { return predicted_ || (newest_ && silent()); }
  const PredictedPlaces& places() const { return places_; }
  /// The newest frame; null before the first.
  const link::LineFramePtr& newest() const { return newest_; }

 private:
  static constexpr Duration kThingsEvery = std::chrono::milliseconds(20);
  static constexpr std::size_t kLookedAt = 2;  // frames between two pictures, of more the newest

  bool homed_since_newest() const;
  /// Images that came while a picture was drawn are no silence.
  Duration silence() const { return looked_ - heard_; }
  bool silent() const { return silence() > options_.silent_after; }
  void take_frames();
  void let_things_see(const link::LineFramePtr& frame, PosedFrame& posed);
  void advance_things();
  std::optional<RobotTime> next_instant(RobotTime until);

  const Rig& rig_;
  std::shared_ptr<const LiveScene> scene_;
  link::OperatorEnd& end_;
  Seat& seat_;
  Clock& clock_;
  PredictedSourceOptions options_;
  PredictedPlaces places_;
  ThingsOutlook* things_ = nullptr;
  RobotTime things_due_;
  Listener listener_;
  link::LineFramePtr newest_;
  std::optional<PosedFrame> waiting_;
  bool posed_ = true, any_posed_ = false;
  std::string why_none_;    // no image comes
  bool predicted_ = false;  // once
  RobotTime due_, heard_, looked_;
  std::uint64_t pictures_ = 0, overtaken_ = 0;
  std::optional<RobotTime> last_;
  ShownInstant instant_;
  PredictedRobot robot_;
};

}  // namespace foresight
