#include "display/still_edges.hpp"

#include <array>

#include "display/shaders.hpp"
#include "gl/camera_block.hpp"
#include "gl/faces.hpp"

namespace foresight {
namespace {

// As in still_edges.comp.
constexpr GLuint kImageBlock = 1, kImageUnit = 16, kTilesUnit = 5, kDepthUnit = 11, kImagePixels = 3;
constexpr unsigned kInvocationsPerTile = 16;
/// px m: beyond, only what is less than a decimetre behind something a metre away would look the same.
constexpr double kMostParallax = 5, kNothingIsSeen = 1e6;

gl::Program still_edges_program(const Lens& view, const Lens& image, bool levels) {
  auto defines = gl::camera_defines(std::array{view, image});
  for (const char* define : {"CASES 0", "LISTED 1", "BLENDED 1", "BEFORE 0", "HOMOGRAPHIES 0", "KEPT 0"})
    defines.emplace_back(define);
  defines.push_back("LEVELS " + std::to_string(levels));
  return gl::Program::compute(display_and_lookup_shaders(), "still_edges.comp", defines);
}

/// Pixels of the image by which a point at 1 m lies aside of one that is infinitely far, at most, seen from the view.
double parallax(const PublishedImage& image, const Pose& T_world_view) {
  const double aside = (image.image.T_world_camera.translation() - T_world_view.translation()).norm();
  const auto& p = image.camera->lens().parameters();
  return aside * std::max(p.fx, p.fy);
}

}  // namespace

StillEdges::StillEdges(const Lens& view, const Lens& image, bool levels)
    : program_(still_edges_program(view, image, levels)) {}

bool StillEdges::may_be_seen(const PublishedImage& image, const Pose& T_world_view) {
  return parallax(image, T_world_view) < kMostParallax;
}

void StillEdges::operator()(const PublishedImage& image, const SeenInputs& inputs, const Pose& T_world_view,
                            const gl::Texture& view_depth, const WorkList& tiles) const {
  tiles.finish(program_, kTilesUnit, kInvocationsPerTile);
  inputs.bind(program_, image.depth_tolerance, kImageBlock, kImageUnit);
  inputs.bind_pixels(kImagePixels);
  glBindTextureUnit(kDepthUnit, view_depth.name());
  program_.set("sharp", image.sharp);
  program_.set("white_balance", image.white_balance);
  program_.set("T_view_image", (T_world_view.inverse() * image.image.T_world_camera).matrix().cast<float>().eval());
  const double most = may_be_seen(image, T_world_view) ? parallax(image, T_world_view) : kNothingIsSeen;
  program_.set("parallax", static_cast<float>(most / gl::kNearPlane));
  tiles.dispatch(program_);
}

}  // namespace foresight
