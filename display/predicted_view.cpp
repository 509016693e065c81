#include "display/predicted_view.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <span>
#include <stdexcept>
#include <utility>

#include "display/shaders.hpp"
#include "gl/lens_rays.hpp"
#include "pictures/view_alpha.hpp"

namespace foresight {
namespace {

// As in view.glsl and view.comp.
constexpr int kBand = 64;  // rows: fewer cost as much as these, as each band is waited for
constexpr GLuint kListUnit = 5, kPlanesUnit = 7, kHomographiesUnit = 8, kAgesUnit = 10;
constexpr GLuint kSeenBlock = 1, kSeenUnit = 16;
constexpr GLuint kPictureImage = 0, kSurfacesImage = 1, kLightImage = 2, kPixelsImage = 3;
constexpr unsigned kBeforeBlock = 2;

enum class Cases { image, usual, every };

struct Pixels {
  bool levels = false;   // of a scene that is drawn with levels
  bool listed = false;   // not all of them
  bool blended = false;  // with newer images, which the picture holds
  bool before = false;   // what the image before shows is left to it
  bool homographies = false;
};

std::vector<std::string> view_defines(std::span<const Lens> lenses, Cases cases, Pixels pixels) {
  auto defines = gl::camera_defines(lenses);
  defines.push_back("CASES " + std::to_string(static_cast<int>(cases)));
  defines.push_back("LEVELS " + std::to_string(pixels.levels));
  defines.push_back("LISTED " + std::to_string(pixels.listed));
  defines.push_back("BLENDED " + std::to_string(pixels.blended));
  defines.push_back("BEFORE " + std::to_string(pixels.before));
  defines.push_back("HOMOGRAPHIES " + std::to_string(pixels.homographies));
  defines.emplace_back("KEPT 0");
  return defines;
}

gl::Program view_program(std::span<const Lens> lenses, Cases cases, Pixels pixels) {
  return gl::Program::compute(display_and_lookup_shaders(), "view.comp", view_defines(lenses, cases, pixels));
}

/// No programs are compiled anew where the one takes the other's place (gl::no_power_of_two).
gl::Texture white_as(const Lens& lens) {
  const auto side = [](int of) { return std::has_single_bit(static_cast<unsigned>(of)) ? 1 : 3; };
  gl::Texture out(GL_RGBA8, side(lens.width()), side(lens.height()), 0, 1, "no shadows");
  const std::array<GLubyte, 4> white{255, 255, 255, 255};
  glClearTexImage(out.name(), 0, GL_RGBA, GL_UNSIGNED_BYTE, white.data());
  return out;
}

bool same_place(const Pose& a, const Pose& b) {
  return a.matrix() == b.matrix();
}

void set_tone(const gl::Program& program, float gain, const Eigen::Vector3f& white_balance, float sharp,
              const PublishedTextures& textures) {
  if (!program) return;
  program.set("gain", gain);
  program.set("white_balance", white_balance);
  program.set("sharp", sharp);
  program.set("light_age", textures.light_age);
}

}  // namespace

PredictedView::Projection::Projection(const Lens& view, const Lens& lens, bool levels, bool with_homographies)
    : newest(view_program(std::array{view, lens}, Cases::image, {.levels = levels, .homographies = with_homographies})),
      before(view_program(std::array{view, lens}, Cases::image, {.levels = levels, .listed = true, .blended = true})),
      usual(view_program(std::array{view, lens}, Cases::usual,
                         {.levels = levels, .listed = true, .blended = true, .before = true})),
      rest(view_program({&view, 1}, Cases::every, {.levels = levels, .listed = true, .blended = true})),
      unseen("pixels that the newest image does not see"),
      of_before("pixels that the image before shows") {
  if (with_homographies) homographies.emplace();
}

PredictedView::PredictedView(std::shared_ptr<const gl::SceneBuffers> scene,
                             std::shared_ptr<const SurfaceRecords> surface, const Lens& lens, ViewPrograms programs,
                             const std::optional<ViewLevels>& levels)
    : lens_(lens),
      surface_(std::move(surface)),
      scene_(std::move(scene)),
      raster_(scene_, levels),
      faces_(raster_.make_faces(gl::faces_for(lens, 2))),
      programs_(programs),
      all_(view_program({&lens, 1}, programs == ViewPrograms::two ? Cases::usual : Cases::every,
                        {.levels = raster_.has_levels()})),
      rest_("pixels of the view"),
      camera_(sizeof(gl::CameraBlock), "view camera"),
      node_poses_(GL_RGBA32F, 16, "view node poses"),
      rays_(gl::make_lens_rays(lens)),
      unshaded_(white_as(lens)),
      silhouettes_(lens),
      picture_(GL_RGBA8, lens.width(), lens.height(), 0, 1, "predicted view") {
  if (programs_ == ViewPrograms::two)
    listed_ = view_program({&lens, 1}, Cases::every, {.levels = raster_.has_levels(), .listed = true});
}

void PredictedView::set_lens(const Lens& lens) {
  if (lens.width() == lens_.width() && lens.height() == lens_.height()) return;
  lens_ = lens;
  faces_ = raster_.make_faces(gl::faces_for(lens, 2));
  rays_ = gl::make_lens_rays(lens);
  unshaded_ = white_as(lens);
  picture_ = gl::Texture(GL_RGBA8, lens.width(), lens.height(), 0, 1, "predicted view");
}

void PredictedView::set_paint(ViewPaint paint) {
  paint_ = paint;
  if (paint != ViewPaint::colours && !painter_) painter_ = std::make_unique<PaintPass>(raster_.has_levels());
}

void PredictedView::draw_part(const std::optional<gl::ViewPart>& part) {
  draws_part_ = part.has_value();
  raster_.draw_part(part);
  if (!part || part_) return;
  if (lens_.has_distortion() || programs_ == ViewPrograms::single)
    throw std::invalid_argument("a part of a view through a lens with distortion");
  part_ = std::make_unique<Part>(Part{gl::Program::compute(display_and_lookup_shaders(), "covered.comp"),
                                      WorkList("pixels of a part of the view")});
}

void PredictedView::start_part() const {
  if (draws_part_) glClearTexImage(picture_.name(), 0, GL_RGBA, GL_UNSIGNED_BYTE, nullptr);
}

/// For `by`.
void PredictedView::list_covered(Rows rows, const gl::Program& by) const {
  start(part_->pixels);
  dispatch_all(part_->covered, rows);
  part_->pixels.finish(by, kListUnit);
}

template <typename DrawRows>
void PredictedView::draw_rows(DrawRows draw) const {
  for (Rows rows; rows.last < lens_.height();) {
    rows.first = rows.last;
    const auto bands = static_cast<std::size_t>((lens_.height() - rows.first + kBand - 1) / kBand);
    const GpuSlice slice(gate_, "rows of a view", bands);
    rows.last = std::min(rows.first + kBand * static_cast<int>(slice.units()), lens_.height());
    draw(rows);
  }
}

void PredictedView::draw(const Pose& T_world_camera, const SceneState& state, const PublishedTextures& textures) {
  for (const std::shared_ptr<const SceneLight>& light : lights_to_prepare(prepares_, state, textures.light))
    draw_lit(T_world_camera, state, textures, light);
  draw_lit(T_world_camera, state, textures, textures.light);
}

void PredictedView::draw(const Pose& T_world_camera, const SceneState& state, const PublishedTextures& textures,
                         const NewestImages& images) {
  const std::shared_ptr<const SceneLight>& light = images.newest->light;
  const PublishedImage* before = images.before ? &*images.before : nullptr;
  for (const std::shared_ptr<const SceneLight>& other_light : lights_to_prepare(prepares_images_, state, light))
    for (const PublishedImage* way : {before, before ? nullptr : &*images.newest})
      draw_lit(T_world_camera, state, textures, images, other_light, way);
  draw_lit(T_world_camera, state, textures, images, light, before);
}

/// Known and not known. None where nothing is to be prepared; nor is it from now on.
std::vector<std::shared_ptr<const SceneLight>> PredictedView::lights_to_prepare(
    bool& prepares, const SceneState& state, const std::shared_ptr<const SceneLight>& light) const {
  if (!std::exchange(prepares, false)) return {};
  const auto known = light ? light : std::make_shared<const SceneLight>(light_from_above(*scene_, state));
  return {nullptr, known};
}

void PredictedView::draw_lit(const Pose& T_world_camera, const SceneState& state, const PublishedTextures& textures,
                             const std::shared_ptr<const SceneLight>& light) {
  start(T_world_camera, state, textures, light, textures.vignetting);
  for (const gl::Program* program : {&all_, &listed_})
    set_tone(*program, textures.display_gain, textures.white_balance, textures.sharp, textures);
  start_part();
  draw_rows([&](Rows rows) {
    if (programs_ == ViewPrograms::single) return dispatch_all(all_, rows);
    if (draws_part_) {
      list_covered(rows, listed_);
      return part_->pixels.dispatch(listed_);
    }
    start(rest_);
    dispatch_all(all_, rows);
    dispatch(rest_, listed_);
  });
  draw_silhouettes();
  finish(textures, state.time);
}

/// `before`: the image before the newest one; null: none is looked up.
void PredictedView::draw_lit(const Pose& T_world_camera, const SceneState& state, const PublishedTextures& textures,
                             const NewestImages& images, const std::shared_ptr<const SceneLight>& light,
                             const PublishedImage* before) {
  start(T_world_camera, state, textures, light, images.newest->tone.tail<2>());
  look_up(images, before);
  const bool any_kept = !images.others.empty() && !draws_part_;
  if (any_kept) {
    if (!kept_) kept_ = std::make_unique<KeptPass>(raster_.has_levels());
    kept_->choose(images, lens_, T_world_camera);
  }
  const Projection& p = *projection_;
  for (const gl::Program* program : {&p.usual, &p.usual_alone, &p.rest})
    set_tone(*program, images.newest->gain, images.newest->white_balance_of_textures, textures.sharp, textures);
  start_part();
  draw_rows([&](Rows rows) {
    draw_newest(images, rows);
    if (any_kept) {
      (*kept_)(kPixelsImage, [&](const gl::Program& program) {
        dispatch_all(program, rows);
        glMemoryBarrier(GL_SHADER_IMAGE_ACCESS_BARRIER_BIT);
      });
      reset_samplers_();
    }
    if (before)
      draw_usual_and_before(*before, *images.newest);
    else
      draw_usual();
    dispatch(rest_, p.rest);
  });
  draw_silhouettes();
  show_still_edges(*images.newest, T_world_camera);
  finish(textures, state.time);
}

/// Hands the images to the shaders.
void PredictedView::look_up(const NewestImages& images, const PublishedImage* before) {
  const Lens& lens = images.newest->camera->lens();
  const bool levels = raster_.has_levels();  // planes are those of the levels shown, then
  const auto pixels = static_cast<std::size_t>(lens_.width()) * static_cast<std::size_t>(lens_.height());
  if (!projection_)
    projection_ = std::make_unique<Projection>(lens_, lens, levels,
                                               !levels && PlaneHomographies::pay(surface_->triangle_count(), pixels));
  if (draws_part_ && !projection_->newest_of_part)
    projection_->newest_of_part =
        view_program(std::array{lens_, lens}, Cases::image, {.levels = levels, .listed = true});
  if (!before && !projection_->usual_alone)
    projection_->usual_alone =
        view_program({&lens_, 1}, Cases::usual, {.levels = levels, .listed = true, .blended = true});
  const auto update = [&](SeenInputs& inputs, const PublishedImage& of) {
    const CameraInput* camera = of.camera.get();
    const PosedImage* image = &of.image;
    Eigen::Vector3f tone = of.tone;
    tone.x() *= images.newest->gain / of.gain;
    inputs.update({&camera, 1}, {&image, 1}, {&tone, 1});
  };
  update(projection_->newest_inputs, *images.newest);
  if (projection_->homographies) {
    glBindTextureUnit(kSeenUnit, projection_->newest_inputs.node_poses());
    projection_->homographies->update(surface_->triangle_count(), kHomographiesUnit);
  }
  if (before) update(projection_->inputs_before, *before);
}

/// The newest image; lists what it does not show.
void PredictedView::draw_newest(const NewestImages& images, Rows rows) const {
  Projection& p = *projection_;
  const gl::Program& newest = draws_part_ ? p.newest_of_part : p.newest;
  if (draws_part_) list_covered(rows, newest);
  start(p.unseen);
  p.newest_inputs.bind(newest, images.newest->depth_tolerance, kSeenBlock, kSeenUnit);
  p.newest_inputs.bind_pixels(kPixelsImage);
  newest.set("sharp", images.newest->sharp);
  newest.set("white_balance", images.newest->white_balance);
  if (draws_part_)
    part_->pixels.dispatch(newest);
  else
    dispatch_all(newest, rows);
  reset_samplers_();
  glMemoryBarrier(GL_SHADER_IMAGE_ACCESS_BARRIER_BIT);
  p.unseen.finish(p.usual, kListUnit);
}

/// What the newest image does not show; lists what is left.
void PredictedView::draw_usual() {
  start(rest_);
  projection_->unseen.dispatch(projection_->usual_alone);
}

/// The same, where the image before shows it from there. Both programs list what is left.
void PredictedView::draw_usual_and_before(const PublishedImage& before, const PublishedImage& newest) {
  Projection& p = *projection_;
  start(p.of_before);
  p.of_before.bind(kBeforeBlock);
  start(rest_);
  p.inputs_before.bind(p.usual, before.depth_tolerance, kSeenBlock, kSeenUnit);
  p.unseen.dispatch(p.usual);
  glMemoryBarrier(GL_SHADER_IMAGE_ACCESS_BARRIER_BIT);
  p.of_before.finish(p.before, kListUnit);
  rest_.bind();
  p.inputs_before.bind(p.before, before.depth_tolerance, kSeenBlock, kSeenUnit);
  p.inputs_before.bind_pixels(kPixelsImage);
  p.before.set("sharp", newest.sharp);
  p.before.set("white_balance", newest.white_balance_of_textures);
  p.of_before.dispatch(p.before);
  reset_samplers_();
  glMemoryBarrier(GL_SHADER_IMAGE_ACCESS_BARRIER_BIT);
}

void PredictedView::start(const Pose& T_world_camera, const SceneState& state, const PublishedTextures& textures,
                          const std::shared_ptr<const SceneLight>& light, const Eigen::Vector2f& vignetting) {
  reset_samplers_();
  const SceneState& shown = raster_.shown(T_world_camera, state, faces_.faces);
  {
    const GpuSlice slice(gate_, "depth of a view");
    raster_(T_world_camera, shown, faces_);
  }

  gl::CameraBlock block = gl::make_camera_block(lens_, faces_.faces);
  if (has_rim_) block.tone.segment<2>(1) = vignetting;
  camera_.write(std::span<const gl::CameraBlock>(&block, 1));
  std::vector<Eigen::Vector4f> rows;
  for (const Pose& T_world_node : shown.T_world_node) {
    const Eigen::Matrix4f m = (T_world_node.inverse() * T_world_camera).matrix().cast<float>();
    for (int row = 0; row < 3; ++row) rows.push_back(m.row(row).transpose());
  }
  node_poses_.assign(std::span<const Eigen::Vector4f>(rows));
  shade(T_world_camera, shown, light);

  glBindBufferBase(GL_UNIFORM_BUFFER, 0, camera_.name());
  glBindTextureUnit(0, node_poses_.texture());
  glBindTextureUnit(1, faces_.surface.name());
  glBindImageTexture(kSurfacesImage, faces_.surface.name(), 0, GL_TRUE, 0, GL_READ_ONLY, GL_R32UI);
  glBindTextureUnit(2, surface_->triangles());
  glBindTextureUnit(3, surface_->patches());
  glBindTextureUnit(4, rays_.name());
  if (raster_.has_levels()) glBindTextureUnit(kPlanesUnit, faces_.planes.name());
  textures.bind();
  glBindTextureUnit(kAgesUnit, textures.ages.texture());
  glBindImageTexture(kPictureImage, picture_.name(), 0, GL_FALSE, 0, GL_READ_WRITE, GL_RGBA8);
}

/// Binds what shadows leave of each pixel.
void PredictedView::shade(const Pose& T_world_camera, const SceneState& state,
                          const std::shared_ptr<const SceneLight>& light) {
  const auto bind = [](const gl::Texture& texture) {
    glBindImageTexture(kLightImage, texture.name(), 0, GL_FALSE, 0, GL_READ_ONLY, GL_RGBA8);
  };
  bind(unshaded_);
  if (!light) return;
  const GpuSlice slice(gate_, "shadows of a view");
  find_shadows(T_world_camera, state, light);
  if (shadows_->is_there) bind(shadows_->pass.light());
}

void PredictedView::find_shadows(const Pose& T_world_camera, const SceneState& state,
                                 const std::shared_ptr<const SceneLight>& light) {
  if (!shadows_) shadows_.reset(new Shadows{ShadowMap(scene_), ShadowPass(lens_), {}, {}, false});
  // The map is that of the scene, wherever it is seen from.
  const bool is_same =
      shadows_->of == light && std::ranges::equal(shadows_->T_world_node, state.T_world_node, same_place);
  if (!is_same) {
    shadows_->is_there = shadows_->map.update(*light, state);
    shadows_->of = light;
    shadows_->T_world_node = state.T_world_node;
  }
  if (shadows_->is_there) shadows_->pass({lens_, camera_, faces_, rays_, T_world_camera}, shadows_->map);
}

void PredictedView::start(WorkList& list) const {
  list.start(static_cast<std::size_t>(lens_.width()) * static_cast<std::size_t>(lens_.height()));
}

void PredictedView::dispatch_all(const gl::Program& program, Rows rows) const {
  program.set("rows", Eigen::Vector2i(rows.first, rows.last));
  program.dispatch(lens_.width(), rows.last - rows.first);
}

void PredictedView::dispatch(const WorkList& list, const gl::Program& program) {
  list.finish(program, kListUnit);
  list.dispatch(program);
}

void PredictedView::draw_silhouettes() {
  if (!mixes_ || draws_part_) return;
  const GpuSlice slice(gate_, "silhouettes of a view");
  silhouettes_({lens_, camera_, faces_, rays_, picture_});
  glBindTextureUnit(0, node_poses_.texture());  // passes over the view find it there
}

/// After silhouettes were mixed: those of images are.
void PredictedView::show_still_edges(const PublishedImage& newest, const Pose& T_world_camera) {
  if (!mixes_ || draws_part_) return;
  const bool is_first = !still_edges_;  // compiles what later views need
  if (is_first)
    still_edges_ = std::make_unique<StillEdges>(lens_, newest.camera->lens(), raster_.has_levels());
  else if (!StillEdges::may_be_seen(newest, T_world_camera))
    return;
  const GpuSlice slice(gate_, "still edges of a view");
  glMemoryBarrier(GL_SHADER_IMAGE_ACCESS_BARRIER_BIT);
  glBindImageTexture(kSurfacesImage, faces_.surface.name(), 0, GL_TRUE, 0, GL_READ_ONLY, GL_R32UI);
  (*still_edges_)(newest, projection_->newest_inputs, T_world_camera, faces_.depth, silhouettes_.tiles());
  reset_samplers_();
}

void PredictedView::finish(const PublishedTextures& textures, RobotTime instant) {
  if (paint_ != ViewPaint::colours) (*painter_)(paint_, picture_, textures, instant);
  glMemoryBarrier(GL_TEXTURE_FETCH_BARRIER_BIT | GL_TEXTURE_UPDATE_BARRIER_BIT | GL_FRAMEBUFFER_BARRIER_BIT);
}

cv::Mat PredictedView::read() const {
  cv::Mat picture(lens_.height(), lens_.width(), CV_8UC4);
  glGetTextureImage(picture_.name(), 0, GL_BGRA, GL_UNSIGNED_BYTE, static_cast<GLsizei>(picture.total() * 4),
                    picture.data);
  count_as_seen(picture);
  return picture;
}

void PredictedView::count_as_seen(cv::Mat& bgra) {
  for (cv::Vec4b& pixel : std::span(bgra.ptr<cv::Vec4b>(), bgra.total()))
    if (pixel[3] == view_alpha::kFromEdge) pixel[3] = view_alpha::kFromImage;
}

}  // namespace foresight
