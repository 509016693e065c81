// A display beside the extraction, on one machine: how punctual the frames are, and what is left for the textures.
#pragma once

#include <atomic>
#include <functional>
#include <memory>
#include <thread>
#include <vector>

#include "display/frame_source.hpp"
#include "display/predicted_view.hpp"
#include "gl/context.hpp"
#include "scene/posed_frame.hpp"
#include "texture_gpu/texture_thread.hpp"

namespace foresight {

/// What is looked at.
struct DisplayScene {
  std::shared_ptr<const SceneModel> model;
  std::shared_ptr<const SurfacePatches> surface;
  Lens camera;  ///< of images
};

/// Extracts images one after the other, as quickly as it is let, in threads of its own. As at the seat, each is
/// published before its textures.
class BusyTextures {
 public:
  /// `context`: of the display, current. `gate` as TextureThread::Setup::gate. Rests at first.
  BusyTextures(gl::Context& context, const DisplayScene& scene, std::shared_ptr<FrameGate> gate);
  ~BusyTextures();

  /// While it rests: from now on it gets these in turn, and has got all of them when this returns. Not empty; they must
  /// outlive that.
  void take(const std::vector<PosedFrame>& images);
  void run(bool works) { works_ = works; }
  bool runs() const { return works_; }
  std::uint64_t finished() const { return finished_; }  ///< images
  void finish(std::size_t images);                      ///< waits for so many more, then rests
  void check() const;                                   ///< throws what ended the extraction
  const LatestTextures& textures() const { return thread_.textures(); }
  const LatestImages& images() const { return thread_.images(); }

 private:
  PosedFrame next();
  void feed(const std::stop_token& stop);
  TextureThread thread_;
  const std::vector<PosedFrame>* images_ = nullptr;
  std::atomic<bool> works_ = false, busy_ = false, failed_ = false;
  std::exception_ptr error_;  // once it failed
  std::atomic<std::uint64_t> finished_ = 0;
  std::size_t next_ = 0;
  std::jthread feeder_;  // last
};

struct DisplayRound {
  double rate_hz = 25;  ///< asked for
  double seconds = 5;
  bool paced = true;  ///< else as without pacing: a frame each interval, whatever else goes on
  ViewPlace place;
};

/// Times in ms.
struct DisplayFigures {
  std::size_t frames = 0;
  double interval_p50 = 0, interval_p99 = 0;  ///< from swap to swap
  double drawing_p50 = 0, drawing_p99 = 0;    ///< from the look at what is newest to the swap
  double input_to_swap_p99 = 0;               ///< of inputs at any instant
  double input_beyond_drawing_p99 = 0;        ///< the same, less its own frame's drawing
  double late_share = 0;                      ///< of frames later than 3 intervals
  double late_share_own = 0;                  ///< the same without time that other programs took
  double images_per_s = 0;                    ///< extracted meanwhile
};

/// Draws a place with textures and newest images, leased; `drawing_ms`: what the last drawing took; 0: not known.
using DrawFrame = std::function<void(const ViewPlace&, const TextureLease&, const ImagesLease&, double drawing_ms)>;

/// Draws with the newest image and `textures` for a while, which is longer where they run and have not got an image by
/// then: up to ten times as long, on a busy machine. Each frame ends when the GPU has finished it. `gate`: of
/// `textures`, where the round is paced.
DisplayFigures show_frames(const DrawFrame& draw, const DisplayRound& round, BusyTextures& textures,
                           const std::shared_ptr<FrameGate>& gate);

}  // namespace foresight
