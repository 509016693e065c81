// Images that are kept, blended over what a view shows of the newest one, where they saw from the eye's side.
#pragma once

#include <deque>
#include <functional>
#include <string>
#include <vector>

#include "display/image_choice.hpp"
#include "gl/program.hpp"
#include "texture_gpu/seen_inputs.hpp"

namespace foresight {

/// Colours change only where the newest image is shown, and the surface has looked the same since the older one was
/// taken (PublishedImage::still); what has moved since is never taken from it. One context.
class KeptPass {
 public:
  /// `levels`: of a scene that is drawn with levels.
  explicit KeptPass(bool levels) : levels_(levels) {}

  /// Chooses for an eye there that looks through `view`. The images must stay leased.
  void choose(const NewestImages& images, const Lens& view, const Pose& T_world_eye);
  /// Blends each that was chosen: `draw` runs the program for the pixels of the view, to which the newest image has
  /// been drawn. All else that view.glsl needs is bound, but for the image's pixels, which are to be at `pixels_image`.
  void operator()(GLuint pixels_image, const std::function<void(const gl::Program&)>& draw) const;

 private:
  struct Chosen {
    ChosenImage image;
    SeenInputs inputs;  // of it, and of the newest one
  };
  void compile(const NewestImages& images, const Lens& view);

  bool levels_;
  std::vector<std::string> defines_;  // of the program
  gl::Program program_;
  std::deque<Chosen> places_;
  std::size_t count_ = 0;  // of them are chosen
  GLuint still_ = 0;
  float sharp_ = 1;
  Eigen::Vector3f white_balance_{1, 1, 1};
};

}  // namespace foresight
