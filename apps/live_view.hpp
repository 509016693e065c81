// `foresight robot --view`: the live scene, textured from images that are as old as a line would make them, beside what
// the camera sees.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "apps/view_outputs.hpp"
#include "common/clock.hpp"
#include "session/live_frames.hpp"
#include "session/live_scene.hpp"

namespace foresight {

struct LiveViewOptions {
  std::string rig;      ///< its name
  double delay_ms = 0;  ///< of images on their way to the textures
  ViewOutputs outputs;
  bool window = true;
  bool stepped = false;  ///< step() in place of run()
  /// What the window's title shall say besides, such as what holds the robot back; "" for nothing. The view's thread.
  std::function<std::string()> notice = {};
};

/// All in one thread; with a window, the main one (gl::Window). It only takes frames, and holds up nobody who makes
/// them. A view that fails (a full disk, a lost context) ends, and tells in finish().
class LiveView {
 public:
  /// What the frames are of, the frames, and what is wrong with the cameras (for the window). Blocks some seconds:
  /// shaders, charts. `clock`: the frames'; must outlive this. Throws InputError where the lenses or the model are not
  /// known; RuntimeFailure (no window, no OpenGL), or no folder for pictures.
  LiveView(const LiveScene& scene, std::shared_ptr<FrameQueue> frames, std::function<std::string()> trouble,
           const Clock& clock, const LiveViewOptions& options);
  ~LiveView();

  /// Shows and measures all that has come. False: it ended, as somebody closed the window or it failed.
  bool step() noexcept;
  /// In real time, until the frames' queue is closed or `stopped`. False as above.
  bool run(const std::function<bool()>& stopped) noexcept;
  /// In stepped time, takes what still came before the queue was closed. Writes the reports and prints the summary.
  /// `complete`: false after Ctrl-C; `note`: one more for the report, or "". Throws RuntimeFailure, also what ended the
  /// view.
  void finish(bool complete, const std::string& note = "");

 private:
  struct Work;
  std::unique_ptr<Work> work_;
};

}  // namespace foresight
