// Single steps of the thesis' pipeline on single images of a run.
#pragma once

#include <memory>

#include "display/thesis_view.hpp"
#include "gl/context.hpp"
#include "scene/run_folder.hpp"

namespace foresight {

/// Textures of one image, and a view of them. Belongs to its lab's context.
struct FigureTextures {
  FigureTextures(const RunFolder& run, const thesis::Options& options, bool software);
  thesis::Pipeline pipeline;
  ThesisView view;
};

/// A run (its left camera) and an OpenGL context of its own, current as long as this lives. One thread.
class FigureLab {
 public:
  explicit FigureLab(const RunFolder& run);

  const RunFolder& run() const { return run_; }

  /// Throws InputError.
  PosedImage load(std::size_t frame) const;

  /// Textures from `image` alone.
  std::unique_ptr<FigureTextures> extract(const PosedImage& image, const thesis::Options& options) const;

  /// Those textures from the pose of image `frame`, the scene as it is at its instant; CV_8UC4.
  cv::Mat look(FigureTextures& textures, std::size_t frame) const;

 private:
  const RunFolder& run_;
  std::unique_ptr<gl::Context> context_;
  bool software_ = false;
};

/// The options of the figures: all steps that come after chapter 4 switched off, and textures so
/// fine that the images limit what is seen.
thesis::Options figure_options();

/// `image` with a wrong pose: turned so that what the camera sees shifts by `mean_px` on average
/// over the image, towards `direction` (0 right, 1 down, 2 left, 3 up).
PosedImage misregistered(PosedImage image, const Lens& lens, double mean_px, int direction);

}  // namespace foresight
