// What the way from the camera to the screen takes, stage by stage, that from the hand to the line, and what images
// cost: for the head-up display.
//
//   captured --> paired, posed, taken, coded --line--> came --> decoded --> a picture shows it
//                                                                  '------> textures hold it
//   hand --> set-point sent
#pragma once

#include <optional>
#include <vector>

#include "common/time.hpp"
#include "link/operator_side/line_frame.hpp"
#include "seat/seat_words.hpp"
#include "texture_gpu/stage_clock.hpp"

namespace foresight {

/// Of the newest of each; nothing where it is not known yet.
struct StageTimes {
  link::FrameAges ages;                  ///< of an image, from its capture on
  std::optional<Duration> to_view;       ///< from decoded until a picture that shows it was swapped
  std::optional<Duration> to_textures;   ///< from there until textures hold it
  std::optional<Duration> drawing;       ///< of a picture
  std::optional<Duration> to_set_point;  ///< from an event of keyboard or mouse until it is in a set-point
  std::vector<StageCost> costs;          ///< of an image
};

/// Lines "times" and "costs", without those of which nothing is known.
std::vector<SeatLine> stage_lines(const StageTimes& times);

/// How long an image takes until a picture shows it. One thread; the display's clock.
class ImageWay {
 public:
  /// An image can be used since `decoded`, of the display's clock. Of several under way the first counts.
  void came(RobotTime captured, RobotTime decoded);
  /// A view was drawn in which this is the newest image.
  void drawn(RobotTime captured);
  void swapped(RobotTime now);

  const std::optional<Duration>& to_view() const { return to_view_; }

 private:
  struct Image {
    RobotTime captured, came;
  };
  std::optional<Image> under_way_;
  bool drawn_ = false;
  std::optional<Duration> to_view_;
};

}  // namespace foresight
