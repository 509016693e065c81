// The extraction on a thread and context of its own, so that the display never waits for it.
#pragma once

#include <condition_variable>
#include <exception>
#include <mutex>
#include <thread>

#include "gl/context.hpp"
#include "texture_gpu/texture_core.hpp"

namespace foresight {

/// Takes posed frames, newest first, and publishes textures. Construct and destroy on the thread
/// that owns the display's context; all other methods from any one thread.
class TextureThread {
 public:
  struct Setup {
    std::shared_ptr<const SceneModel> scene;
    std::shared_ptr<const SurfacePatches> surface;
    Lens left;
    std::optional<Lens> right;
    TextureOptions options;
    bool images = false;  ///< publish each image before its textures
    /// The display's: extraction goes on when its frames leave time. Null: whenever there is an image.
    std::shared_ptr<FrameGate> gate = nullptr;
    /// What comes until begin_anew() is one (TextureCore::rehearse()), of whose cost the gate is not told.
    bool rehearses = false;
  };

  /// `context`: shares objects with the display's context; used by this thread only from now on.
  /// Blocks until the core is built; rethrows what its construction throws.
  TextureThread(std::unique_ptr<gl::Context> context, const Setup& setup);
  ~TextureThread();
  TextureThread(const TextureThread&) = delete;
  TextureThread& operator=(const TextureThread&) = delete;

  const LatestTextures& textures() const { return latest_; }
  /// The newest image, published before its textures, and what it does not show of the one before; none where
  /// Setup::images is false. To be acquired before textures(): those of the images before these are then there.
  const LatestImages& images() const { return latest_images_; }

  /// Hands over a frame and returns at once. A frame that still waits is replaced and counted.
  /// Rethrows an error of the thread.
  void submit(PosedFrame frame);

  /// The report of the newest finished frame since the last call, if any. Rethrows an error.
  std::optional<ExtractionReport> take_report();

  /// submit(), then blocks until that frame is published (or dropped for lack of room). Throws
  /// RuntimeFailure after `timeout_s`.
  ExtractionReport process(PosedFrame frame, double timeout_s = 120);

  /// The same in two steps, of which the first returns when the image is published (the very first: its textures), the
  /// second when its textures are. The thread rests in between: whoever draws then gets the same picture in
  /// every run. follow() without show() returns nothing; show() first does what follow() would. Only with
  /// Setup::images.
  void show(PosedFrame frame, double timeout_s = 120);
  std::optional<ExtractionReport> follow(double timeout_s = 120);

  /// Ends the work on images as follow() does, forgets them all and what was learnt of them, and keeps the programs
  /// with all that was compiled for them. Waits; whoever holds leases of textures or images gives them back before.
  /// Rethrows an error of the thread.
  void begin_anew(double timeout_s = 120);

  std::uint64_t replaced() const;  ///< frames that were never extracted because a newer one came

 private:
  void run(const std::stop_token& stop, const Setup& setup);
  void run_core(const std::stop_token& stop, const Setup& setup, bool rehearses);
  void work(const std::stop_token& stop, TextureCore& core, bool images);
  std::uint64_t hand_over(PosedFrame frame, bool hold);
  template <typename Condition>
  void wait_until(std::unique_lock<std::mutex>& lock, double timeout_s, Condition&& condition);
  void rethrow_locked();

  std::unique_ptr<gl::Context> context_;
  LatestTextures latest_;
  LatestImages latest_images_;
  mutable std::mutex mutex_;
  std::condition_variable_any changed_;
  std::optional<PosedFrame> waiting_;
  std::optional<ExtractionReport> report_;
  std::exception_ptr error_;
  std::uint64_t replaced_ = 0, submitted_ = 0, looked_at_ = 0, finished_ = 0;
  bool ready_ = false, anew_ = false;
  bool hold_ = false;    // rest between an image and its textures
  std::jthread thread_;  // last: it uses all of the above
};

}  // namespace foresight
