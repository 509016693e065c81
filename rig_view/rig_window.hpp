// A rig in a window: turned by the mouse, moved by sliders and keys, or as the running robot moves.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "rig_view/rig_body.hpp"

namespace foresight {

/// What a running robot says of itself.
struct LiveRig {
  std::vector<double> positions;  ///< of the rig's joints; nan: not known
  std::string state;              ///< one line
  bool is_bad = false;            ///< it is one of trouble
};

struct RigWindowOptions {
  std::string title;
  std::vector<double> positions;  ///< to begin with
  int width = 1320, height = 860;
  /// Of a running robot, called in the window's thread about thirty times a second; nothing new: nothing. Empty: joints
  /// are moved by hand.
  std::function<std::optional<LiveRig>()> live = {};
};

/// Main thread (gl::Window).
class RigWindow {
 public:
  /// `body` must outlive this. Throws RuntimeFailure: no desktop, no OpenGL.
  RigWindow(RigBody& body, RigWindowOptions options);
  ~RigWindow();

  /// Until the user closes it or `stopped`. Draws only what has changed.
  void run(const std::function<bool()>& stopped);

 private:
  struct Work;
  std::unique_ptr<Work> work_;
};

}  // namespace foresight
