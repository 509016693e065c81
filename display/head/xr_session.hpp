// An OpenXR session: two eyes, panels, controllers, frame by frame.
#pragma once

#include <deque>
#include <memory>
#include <optional>

#include "common/clock.hpp"
#include "display/head/controllers.hpp"
#include "display/head/head_painter.hpp"
#include "display/head/picture_swapchain.hpp"
#include "display/head/session_steps.hpp"
#include "display/head/xr_instance.hpp"

namespace foresight::head {

struct SessionOptions {
  bool stage = false;  ///< the room's floor is the origin, where the runtime knows it; else the head's first place
  double scale = 1;    ///< of the pixels that the runtime recommends, per axis
  int most_px = 8192;  ///< an eye is not drawn larger, whatever the runtime recommends
};

struct FrameCounts {
  std::uint64_t frames = 0, drawn = 0;  ///< ended; with eyes in them
  std::uint64_t without_pose = 0;       ///< were to be drawn, and nobody knew where the head is
  std::uint64_t time_jumps = 0;         ///< display times that went back, or a second and more ahead
  Duration period{0};                   ///< of the display
};

/// Belongs to the context that is current when it is made. One thread. All throw CallFailed.
class Session {
 public:
  Session(const Instance& instance, XrSystemId headset, const GraphicsBinding& graphics, const SessionOptions& options);
  ~Session();
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;

  /// What events say.
  SessionStep take(XrSessionState state);
  void space_moves(XrReferenceSpaceType type, XrTime when);
  const SessionSteps& steps() const { return steps_; }

  /// Waits until the runtime wants a frame, asks where head and hands will be when it is seen, has it drawn, and hands
  /// it in. Between begin and end only. `now` stamps the hands.
  void frame(const Clock& clock, HeadPainter& painter, HeldControllers& hands);
  /// The same with nothing in it.
  void empty_frame();
  void request_exit();

  const FrameCounts& counts() const { return counts_; }
  const std::string& headset() const { return name_; }

 private:
  struct Waited {
    XrTime display_time = 0;
    bool draw = false, moved = false, jumped = false;
  };
  struct Layers {
    std::array<XrCompositionLayerProjectionView, 2> eyes{};
    XrCompositionLayerProjection projection{};
    std::array<XrCompositionLayerQuad, 8> quads{};
    std::vector<const XrCompositionLayerBaseHeader*> all;
  };
  void make_spaces(bool stage);
  void make_eyes(const Instance& instance, XrSystemId headset, const SessionOptions& options);
  Waited wait();
  void end(XrTime display_time, const std::vector<const XrCompositionLayerBaseHeader*>& layers);
  std::optional<Pose> head_at(XrTime time) const;
  bool locate_eyes(XrTime time, HeadFrame& frame);
  void draw_eyes(const HeadFrame& frame, HeadPainter& painter, Layers& layers);
  void draw_panels(HeadPainter& painter, bool head_known, Layers& layers);

  XrSession session_ = XR_NULL_HANDLE;
  XrSpace base_ = XR_NULL_HANDLE, view_ = XR_NULL_HANDLE;
  XrReferenceSpaceType base_type_ = XR_REFERENCE_SPACE_TYPE_LOCAL;
  XrEnvironmentBlendMode blend_ = XR_ENVIRONMENT_BLEND_MODE_OPAQUE;
  std::string name_;
  std::int64_t format_ = 0;
  SessionSteps steps_;
  std::optional<Controllers> controllers_;
  std::array<std::unique_ptr<PictureSwapchain>, 2> eyes_;
  std::array<std::optional<EyeFov>, 2> fovs_;  // that eyes are drawn with
  std::array<XrView, 2> views_{};              // as the runtime told them
  std::array<std::unique_ptr<PictureSwapchain>, 8> panels_;
  std::deque<XrTime> moves_;  // of the space, from then on
  XrTime last_ = 0;
  FrameCounts counts_;
};

}  // namespace foresight::head
