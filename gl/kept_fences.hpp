// What keeps Mesa's software renderer from freeing a fence that one of its threads is still at.
//
// Each framebuffer that is drawn into makes a scene, and each scene has a fence, which the rendering threads count up.
// Who draws looks at the count without the fence's lock (lp_fence_signalled of version 22.3), and takes a scene that is
// complete for the next drawing: its fence is freed while the last thread, if it was interrupted just there, has yet to
// wake those who wait and to let the lock go. It then writes into whatever has got that memory.
#pragma once

#include <deque>

#include "gl/objects.hpp"

namespace foresight::gl {

/// Of a pass that draws into framebuffers. One context. Nothing on other renderers.
class KeptFences {
 public:
  KeptFences();

  /// Before another framebuffer is drawn into: the fence of the scene that this ends lives as long as any thread may
  /// be at it.
  void operator()() const;

 private:
  bool keeps_ = false;
  mutable std::deque<Fence> fences_;  // of what was drawn: who keeps them stays as it is
};

}  // namespace foresight::gl
