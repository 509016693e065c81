#include "texture_gpu/thesis/thesis_pipeline.hpp"

#include "common/error.hpp"
#include "gl/context.hpp"

namespace foresight::thesis {
namespace {

constexpr double kGpuTimeout = 120;  // seconds; slow ways to fill holes on a software renderer included

}  // namespace

Pipeline::Pipeline(std::shared_ptr<const SceneModel> scene, const Lens& left, const std::optional<Lens>& right,
                   const Options& options, bool software_renderer)
    : scene_(std::move(scene)),
      options_(options),
      textures_(find_polygons(*scene_), options.texels_per_metre, options.max_texture),
      buffers_(std::make_shared<const PolygonBuffers>(std::make_shared<const gl::SceneBuffers>(*scene_),
                                                      textures_.polygons())),
      occlusion_(buffers_),
      normalisation_(textures_.max_texture()),
      pyramid_(textures_.max_texture()),
      shader_(textures_.max_texture()),
      clock_(software_renderer) {
  for (const Lens* lens : {&left, right ? &*right : nullptr}) {
    if (!lens) continue;
    if (!CameraFrame::can_undistort(*lens))
      throw InputError("--pipeline thesis", "the lens sees more than one picture plane can hold",
                       "use the core's pipeline, or a lens of less than 120 degrees");
    cameras_.push_back(std::make_unique<Camera>(*lens, buffers_->scene()));
  }
}

ExtractionReport Pipeline::process(const PosedFrame& frame) {
  ExtractionReport report;
  clock_.start();
  process_image(frame.left, *cameras_[0], report);
  if (frame.right && cameras_.size() > 1) process_image(*frame.right, *cameras_[1], report);
  gl::Fence::insert().wait(kGpuTimeout);
  gl::check_errors("the thesis' pipeline");
  clock_.mark(options_.profile ? "other" : "all steps");
  report.published = true;
  report.number = ++number_;
  report.newest_image = frame.left.time;
  report.published_at = std::chrono::steady_clock::now();
  report.stages = clock_.read();
  report.bytes_in_use = report.bytes_reserved = textures_.bytes();
  report.texels_resident = textures_.bytes() / 4;
  return report;
}

void Pipeline::process_image(const PosedImage& image, Camera& camera, ExtractionReport& report) {
  camera.frame.upload(image);
  camera.frame.load(drawing_);
  mark("upload");
  camera.frame.draw_depth(image, drawing_);
  mark("occlusion");
  const gl::Faces& plane = camera.frame.plane();
  const Pose T_camera_world = image.T_world_camera.inverse();
  for (std::size_t i = 0; i < textures_.polygons().size(); ++i) {
    const Polygon& polygon = textures_.polygons()[i];
    const PolygonFrame& texture = textures_.frame(i);
    const Pose T_camera_node = T_camera_world * image.scene.T_world_node[static_cast<std::size_t>(polygon.node)];
    const auto box = bounding_box(polygon, T_camera_node, plane);
    if (!box) continue;
    ++report.pages;

    mark_occlusion(camera.frame, i, T_camera_node);
    mark("occlusion");
    camera.perspective.copy(camera.frame, *box);
    camera.frame.reset_alpha(box->x, box->y, box->width, box->height);
    mark("perspective texture");
    camera.expansion(camera.perspective, *box, options_.expansion, options_.iterations, drawing_);
    mark("expansion");
    if (options_.clean_borders)
      normalisation_(camera.perspective, *box, texture, T_camera_node, plane, drawing_);
    else
      normalisation_.polygon_only(camera.perspective, *box, polygon, texture, T_camera_node, plane, drawing_);
    mark("normalisation");
    fusion_(normalisation_, i, textures_, drawing_);
    mark("fusion");
    fill(i);
    mark("hole filling");
  }
}

void Pipeline::mark_occlusion(const CameraFrame& frame, std::size_t polygon, const Pose& T_camera_node) const {
  if (options_.occlusion)
    occlusion_.mark(frame, polygon, T_camera_node, options_.clean_borders);
  else
    occlusion_.mark_all_visible(frame, polygon, T_camera_node);
}

void Pipeline::fill(std::size_t polygon) {
  const PolygonFrame& frame = textures_.frame(polygon);
  const gl::Texture& texture = textures_.writable(polygon);
  switch (options_.hole_filling) {
    case HoleFilling::none: break;
    case HoleFilling::pyramid: pyramid_(texture, frame.s, frame.t, drawing_); break;
    case HoleFilling::shader_one_stage: shader_(texture, frame.s, frame.t, {false, true}, drawing_); break;
    case HoleFilling::shader: shader_(texture, frame.s, frame.t, {true, false}, drawing_); break;
    case HoleFilling::shader_query: shader_(texture, frame.s, frame.t, {true, true}, drawing_); break;
  }
}

/// Ends a stage of the profile.
void Pipeline::mark(const char* stage) {
  if (options_.profile) clock_.mark(stage);
}

cv::Mat Pipeline::alpha_mask(const PosedImage& image, std::size_t index, Expansion method, int iterations) {
  Camera& camera = *cameras_[0];
  const Polygon& polygon = textures_.polygons()[index];
  const Pose T_camera_node =
      image.T_world_camera.inverse() * image.scene.T_world_node[static_cast<std::size_t>(polygon.node)];
  const auto box = bounding_box(polygon, T_camera_node, camera.frame.plane());
  if (!box) return {};
  camera.frame.upload(image);
  camera.frame.load(drawing_);
  camera.frame.draw_depth(image, drawing_);
  mark_occlusion(camera.frame, index, T_camera_node);
  camera.perspective.copy(camera.frame, *box);
  camera.expansion(camera.perspective, *box, method, iterations, drawing_);
  cv::Mat texels(box->height, box->width, CV_8UC4);
  glGetTextureSubImage(camera.perspective.texture().name(), 0, 0, 0, 0, box->width, box->height, 1, GL_BGRA,
                       GL_UNSIGNED_BYTE, static_cast<GLsizei>(texels.total() * 4), texels.data);
  cv::Mat alpha;
  cv::extractChannel(texels, alpha, 3);
  return alpha;
}

}  // namespace foresight::thesis
