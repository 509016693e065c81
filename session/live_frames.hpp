// Live pairs with the poses of their instants, for everyone who wants them.
//
//   cameras --pair--> LiveFrames --frame--> FrameQueue --> recorder
//                         |            +--> FrameQueue --> texture thread
//   control loop --> PoseSource        +--> FrameQueue --> the line
#pragma once

#include <atomic>
#include <condition_variable>
#include <deque>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "common/bounded_queue.hpp"
#include "common/clock.hpp"
#include "drivers/camera/stereo_pairing.hpp"
#include "scene/posed_frame.hpp"
#include "session/joint_tracks.hpp"

namespace foresight {

/// What is known of where cameras and scene were when a pair was taken.
struct PairPoses {
  /// Of left and right, each at its own image's instant; nothing where it is not known.
  std::optional<std::array<Pose, 2>> T_world_camera;
  std::array<SceneState, 2> scene;     ///< at the instants of left and right; empty without a model
  JointState joints;                   ///< at the left image's instant
  std::string quality = "none";        ///< "tags", "held", "encoders" (RegistrationQuality), "given"; "lost", "none"
  std::optional<double> predicted_px;  ///< expected error of the left camera's pose, RMS over the image
  std::string missing;                 ///< joints of the scene that are not known then: they stand where last heard of
};

/// Tells poses of pairs. All but what an implementation says otherwise on the thread that registers.
class PoseSource {
 public:
  virtual ~PoseSource() = default;
  /// Has it heard of the pair's instant, or will it never know more? False: better ask again a little later.
  virtual bool is_ready(const StereoPair&) { return true; }
  /// Pairs in the order of their times, each once. Throws nothing that concerns one pair only.
  virtual PairPoses poses_of(const StereoPair& pair) = 0;
};

/// A pair, where everything was when it was taken, and how well that is known. Never changes.
struct LiveFrame {
  std::uint64_t number = 0;  ///< of the pairs that came in, from 1 on; one that is missing was dropped
  StereoPair pair;
  /// Pixels are the pair's. Nothing where the registration has no pose, or there is none. A right image whose instant
  /// is another one has its own pose and scene.
  std::optional<PosedFrame> posed;
  std::array<SceneState, 2> scene;  ///< PairPoses::scene: may be known where the cameras' poses are not
  JointState joints;
  std::string quality;                 ///< PairPoses::quality
  std::optional<double> predicted_px;  ///< from which PosedImage::margin_px follows
  RobotTime came, registered;          ///< when it was handed in, and when its poses were found
};
using LiveFramePtr = std::shared_ptr<const LiveFrame>;

/// What one subscriber has not taken yet.
using FrameQueue = BoundedQueue<LiveFramePtr>;

struct LiveFrameOptions {
  double margin_px = 1.5;   ///< TextureOptions::margin_px, that of exact poses
  std::size_t waiting = 4;  ///< pairs before the registration, at most; > 0. The oldest is dropped for a new one.
  /// So long after its coming a pair waits for encoders of its instant; after that it is registered with what is known.
  Duration patience = std::chrono::milliseconds(40);
};

/// Registers each pair once, on a thread of its own (start()) or, in stepped time, in the caller's (step()), and hands
/// the result to all subscribers in the order of the pairs. add() and subscribe() from any thread; none of them, no
/// subscriber and no slow registration ever holds up another, the cameras or the control loop.
class LiveFrames {
 public:
  /// `poses` is only called by the registering thread. `clock` must outlive this.
  LiveFrames(std::shared_ptr<PoseSource> poses, const Clock& clock, const LiveFrameOptions& options = {});
  ~LiveFrames() { stop(); }

  /// Gets every frame from now on, as long as somebody holds it. After stop() it is closed already.
  std::shared_ptr<FrameQueue> subscribe(std::size_t room, bool waits = false);

  void add(const StereoPair& pair) noexcept;
  void start();
  /// Registers what is ready, without waiting.
  void step() noexcept;
  /// Registers what still waits with what is known, then closes all subscribers' queues.
  void stop() noexcept;

  std::uint64_t dropped() const noexcept;  ///< pairs for which the registration was too slow
  std::string fault() const;               ///< why the newest pair could not be registered at all; "" where it could
  std::string missing() const;             ///< PairPoses::missing of the newest pair

 private:
  struct Waiting {
    std::uint64_t number;
    StereoPair pair;
    RobotTime came;
  };
  void run(const std::stop_token& stop) noexcept;
  void take_next() noexcept;
  bool is_due() noexcept;
  /// False: nothing to do, yet. `all`: what is not ready too.
  bool process(bool all) noexcept;
  LiveFramePtr registered(const Waiting& waiting) noexcept;
  void hand_out(const LiveFramePtr& frame) noexcept;

  const std::shared_ptr<PoseSource> poses_;
  const Clock& clock_;
  const LiveFrameOptions options_;
  std::optional<Waiting> current_;  // of the registering thread

  mutable std::mutex mutex_;  // all below
  std::condition_variable_any arrived_;
  std::deque<Waiting> waiting_;
  std::uint64_t number_ = 0, dropped_ = 0;
  std::string fault_, missing_;
  bool stopped_ = false;
  std::vector<std::weak_ptr<FrameQueue>> subscribers_;
  std::jthread thread_;
};

}  // namespace foresight
