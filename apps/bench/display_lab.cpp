#include "apps/bench/display_lab.hpp"

#include <cstdio>
#include <set>

#include "apps/bench/lab_pictures.hpp"
#include "display/view_session.hpp"
#include "gl/context.hpp"
#include "gl/raster_pass.hpp"
#include "sim/motion.hpp"
#include "sim/polygons.hpp"
#include "sim/synth_run.hpp"

namespace foresight {
namespace {

constexpr std::size_t kImagesOfView = 12;
constexpr double kNewestBefore = 0.5;  // s from the newest image to the view
constexpr double kImagesTake = (kImagesOfView - 1) / LabPictures::kPairsPerSecond;
constexpr int kViewsTried = 36;
constexpr double kSecondsTried = 1.0 / 3;  // between views that are tried

ViewPlace place_at(const sim::Lab& lab, double t) {
  return {sim::T_world_camera_at(t), {RobotTime{} + seconds(t), StateStatus::exact, sim::lab_state_at(lab, t)}};
}

/// Polygons of which something is seen from there.
std::size_t polygons_seen(const gl::RasterPass& raster, const gl::FaceImages& faces, const ViewPlace& place,
                          const std::vector<int>& polygon_of_triangle) {
  raster(place.T_world_camera, place.scene, faces);
  std::vector<std::uint32_t> triangles(static_cast<std::size_t>(faces.faces.width) *
                                       static_cast<std::size_t>(faces.faces.height) *
                                       static_cast<std::size_t>(faces.faces.count));
  glGetTextureImage(faces.surface.name(), 0, GL_RED_INTEGER, GL_UNSIGNED_INT,
                    static_cast<GLsizei>(triangles.size() * sizeof(std::uint32_t)), triangles.data());
  std::set<int> seen;
  for (const std::uint32_t t : triangles)
    if (t > 0 && t <= polygon_of_triangle.size()) seen.insert(polygon_of_triangle[t - 1]);
  return seen.size();
}

std::vector<PosedFrame> images_before(const sim::Lab& lab, double t, cv::Size size) {
  const double first = t - kNewestBefore - kImagesTake;
  const LabPictures pictures({.size = size, .count = kImagesOfView, .first_s = first, .right = false},
                             [](std::size_t, std::size_t) {});
  std::vector<PosedFrame> out;
  for (std::size_t i = 0; i < kImagesOfView; ++i) {
    const double passed = static_cast<double>(i) / LabPictures::kPairsPerSecond;
    ViewPlace place = place_at(lab, first + passed);
    out.push_back({{pictures.at(RobotTime{} + seconds(passed)).left, place.scene.time, place.T_world_camera,
                    std::move(place.scene)},
                   std::nullopt});
  }
  return out;
}

}  // namespace

Lens display_lens(cv::Size size) {
  return sim::synth_lens({.width = size.width, .height = size.height}, false);
}

// The lab's own pictures are of the same parts as this one, which is only the shape: its paint may be coarse.
DisplayLab make_display_lab(cv::Size image_size, cv::Size view_size) {
  gl::set_up_context();
  const sim::Lab lab = sim::make_lab(0.05, 1);
  const sim::Polygons polygons = sim::polygons_of(lab);
  DisplayLab out{{}, polygons.count, {"few", {}, {}, SIZE_MAX}, {"many", {}, {}, 0}};
  out.scene.model = std::make_shared<const SceneModel>(sim::nodes_of(lab, lab.at_rest()), sim::kLabAccuracy);
  out.scene.camera = display_lens(image_size);

  const gl::RasterPass raster(std::make_shared<const gl::SceneBuffers>(*out.scene.model), true);
  const gl::FaceImages faces(gl::faces_for(display_lens(view_size), 2), true);
  double few_at = 0, many_at = 0;
  for (int i = 0; i < kViewsTried; ++i) {
    const double t = kNewestBefore + kImagesTake + i * kSecondsTried;
    ViewPlace place = place_at(lab, t);
    const std::size_t count = polygons_seen(raster, faces, place, polygons.of_facet);
    if (count < out.few.polygons) out.few.place = place, out.few.polygons = count, few_at = t;
    if (count > out.many.polygons) out.many.place = std::move(place), out.many.polygons = count, many_at = t;
  }
  std::fprintf(stderr, "display: rendering %zu pictures of the lab\n", 2 * kImagesOfView);
  out.few.images = images_before(lab, few_at, image_size);
  out.many.images = images_before(lab, many_at, image_size);

  std::vector<ExpectedView> views;
  for (const DisplayView* view : {&out.few, &out.many})
    for (const PosedFrame& image : view->images) views.push_back({image.left.T_world_camera, image.left.scene});
  out.scene.surface = surface_for(*out.scene.model, out.scene.camera, views);
  return out;
}

}  // namespace foresight
