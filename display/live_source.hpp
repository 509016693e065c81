// Frames of live cameras as a source: shown when they come, and turned into textures as late as a line would bring
// them.
#pragma once

#include <deque>
#include <functional>

#include "common/clock.hpp"
#include "display/frame_source.hpp"

namespace foresight {

/// An image of live cameras that has come.
struct LiveImage {
  std::uint64_t number = 0;         ///< of the images
  std::optional<PosedFrame> frame;  ///< nothing where its pose is not known: it is neither shown nor used
  cv::Mat left = {};                ///< then: the left camera's picture, for FrameSource::unposed(); or empty
  std::string lacks = {};           ///< then: why it is not known, in words; or ""
};

/// Where live images come from. The functions are called in the source's thread.
struct LiveFeed {
  /// The oldest image not taken yet, waiting so long at most.
  std::function<std::optional<LiveImage>(Duration)> take;
  /// No more come; what is there can still be taken.
  std::function<bool()> closed;
  /// What is wrong with the cameras, in words; "" where all is well.
  std::function<std::string()> trouble;
};

struct LiveSourceOptions {
  Duration delay{0};  ///< of frames on their way to the textures
  bool real_time = true;
  std::size_t most_frames = 1000;                          ///< on their way at once; > 0. The oldest goes for a new one
  Duration silent_after = std::chrono::milliseconds(500);  ///< without an image: fault() says so
};

struct LiveCounts {
  std::uint64_t frames = 0;     ///< with a pose
  std::uint64_t unposed = 0;    ///< without
  std::uint64_t forgotten = 0;  ///< of the first, those that went for newer ones: the delay is too long
};

/// A frame's own instant is shown, from the frames that are at least the delay older. One thread.
class LiveSource final : public FrameSource {
 public:
  /// `clock`: of the frames' times; must outlive this.
  LiveSource(LiveFeed feed, const Clock& clock, const LiveSourceOptions& options);

  bool real_time() const override { return options_.real_time; }
  SourceState advance() override;
  const ShownInstant& instant() const override { return instant_; }
  std::optional<PosedFrame> arrived() override;
  ViewPlace place() override { return {shown_.T_world_camera, shown_.scene}; }
  cv::Mat actual() override { return shown_.pixels; }
  cv::Mat unposed() override { return silent() ? cv::Mat() : unposed_; }
  std::uint64_t overtaken() const override { return overtaken_; }
  std::string fault() const override;
  const LiveCounts& counts() const { return counts_; }

 private:
  struct Instant {
    std::uint64_t number;
    PosedImage image;
  };
  /// Images that came while a picture was drawn are no silence.
  Duration silence() const { return looked_ - heard_; }
  bool silent() const { return silence() > options_.silent_after; }
  void take_all();
  void take_in(LiveImage image);

  LiveFeed feed_;
  const Clock& clock_;
  LiveSourceOptions options_;
  std::deque<Instant> instants_;       // to be shown
  std::deque<PosedFrame> travelling_;  // to become textures
  LiveCounts counts_;
  RobotTime heard_, looked_;
  bool posed_ = true;  // the newest image
  cv::Mat unposed_;    // that one, where it is not
  std::string lacks_;
  ShownInstant instant_;
  PosedImage shown_;
  bool handed_out_ = false;  // any frame
  std::uint64_t overtaken_ = 0;
};

}  // namespace foresight
