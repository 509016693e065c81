// A pair of images as it has come over the line, decoded and checked.
#pragma once

#include <array>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "link/clocks/clock_tracker.hpp"
#include "link/control/control_seat.hpp"
#include "link/messages/foresight_messages.hpp"
#include "scene/coding_loss.hpp"
#include "scene/posed_frame.hpp"

namespace foresight::link {

struct LineImage {
  cv::Mat bgr;                         ///< CV_8UC3, raw
  RobotTime captured;                  ///< middle of the exposure of the centre row, on the robot's clock
  Duration uncertainty{0};             ///< of it, half width
  std::optional<Pose> T_world_camera;  ///< at `captured`; nothing where the robot side does not know it
  cv::Mat lost = {};                   ///< what coding took away from it (scene/coding_loss.hpp); empty: not known
  LossShares loss_shares = even_loss_shares();  ///< of its pixels
};

/// Where the joints were when the left image was taken.
struct LineJoints {
  StateStatus status = StateStatus::invalid;  ///< of the worst
  std::vector<std::string> names;
  std::vector<double> positions;  ///< rad or m; not a number where it was never known
  std::vector<bool> known;        ///< else the position is the last that its drive told

  std::optional<double> position(std::string_view name) const;
};

/// How old the left image was at each stage. On the robot's side by one clock; from the arrival on by both, with what
/// is not known of them. Nothing: was not stamped, or the clocks have not met yet.
struct FrameAges {
  std::optional<Duration> paired, registered, taken, coded;  ///< StageStamps
  std::optional<BoundedDelay> arrived;                       ///< whole, in this program
  std::optional<BoundedDelay> decoded;                       ///< and ready to be used
};

/// Never changes.
struct LineFrame {
  std::uint64_t session = 0;                           ///< of the robot's program: another one is another start of it
  std::uint64_t number = 0;                            ///< of the robot's pairs; grows within a session
  std::array<LineImage, 2> image;                      ///< left, right
  std::optional<BoundedTime<OperatorClock>> captured;  ///< the left one, on our clock
  OperatorTime arrived, decoded;
  LineJoints joints;
  std::string quality;                 ///< PairPoses::quality
  std::optional<double> predicted_px;  ///< expected error of the left pose, RMS over the image
  std::string lenses_revision;         ///< StereoFrame::lenses_revision
  FrameAges ages;
  std::size_t bytes = 0;  ///< that it took, coded
};
using LineFramePtr = std::shared_ptr<const LineFrame>;

/// All but the pictures, of a checked message. `clock`: what is known of the robot's.
LineFrame line_frame(const StereoFrame& message, const RobotClockTracker& clock, OperatorTime arrived,
                     OperatorTime decoded);

/// As textures take it; nothing where a pose is missing. `scene_at`: where everything stood at an instant, by joints.
/// `margin_px`: of exact poses (LiveFrameOptions).
std::optional<PosedFrame> posed_frame(const LineFrame& frame,
                                      const std::function<SceneState(RobotTime, const LineJoints&)>& scene_at,
                                      double margin_px);

}  // namespace foresight::link
