// Where a view's images come from, and which instants are shown: a recorded run, live cameras, the line.
//
//            instants to show        t0     t1     t2     t3 ...
//            frames that arrive      -      -      f0     f1         here with a delay of two images
//
// What is shown at an instant is drawn from frames that have arrived by then, and from nothing else.
#pragma once

#include <opencv2/core.hpp>
#include <optional>
#include <string>

#include "scene/posed_frame.hpp"

namespace foresight {

enum class SourceState {
  ready,    ///< there is an instant
  waiting,  ///< not yet: ask again
  ended,    ///< there will be none
};

struct ShownInstant {
  std::string name;    ///< of its pictures' files, without folder and extension
  RobotTime time;      ///< capture instant of the image that the view is to foretell
  bool late = false;   ///< has passed before it could be drawn: it is skipped, and no frames are handed out for it
  bool blind = false;  ///< no frame has arrived by then: there is nothing to show
};

/// From where, and with every node where, the view of an instant is drawn.
struct ViewPlace {
  Pose T_world_camera = Pose::Identity();
  SceneState scene;
};

/// For each instant: advance(), then arrived() until it has no more, then place() and, by who wants it, actual().
/// One thread, unless a source says otherwise.
class FrameSource {
 public:
  virtual ~FrameSource() = default;

  /// Instants come when the clock says so, and only the newest frame counts; else every frame counts, and an instant
  /// waits until its frames have become textures.
  virtual bool real_time() const = 0;

  /// Goes on to the next instant. In real time it waits for it, 50 ms at most; else it does not wait.
  virtual SourceState advance() = 0;
  /// The instant that advance() went to.
  virtual const ShownInstant& instant() const = 0;

  /// The next frame that has arrived by the instant, in the order of their times. In real time the newest only.
  /// Throws InputError where it cannot be read.
  virtual std::optional<PosedFrame> arrived() = 0;

  /// As it can be known from the frames that were handed out; not of an instant that is late or blind.
  virtual ViewPlace place() = 0;
  /// What the left camera saw at the instant: CV_8UC1, or CV_8UC3 (BGR). Throws InputError where it cannot be read.
  virtual cv::Mat actual() = 0;

  /// The newest image of the left camera where its pose is not known, so that it can only be looked at: as actual().
  /// Empty: it is known, or no image comes.
  virtual cv::Mat unposed() { return {}; }

  /// Frames that were never handed out, because newer ones had come.
  virtual std::uint64_t overtaken() const = 0;
  /// Why no instants come, in words; "" where all is well.
  virtual std::string fault() const { return {}; }
};

}  // namespace foresight
