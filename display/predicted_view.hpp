// The scene as a camera with a real lens would see it, with published textures.
#pragma once

#include <memory>
#include <opencv2/core.hpp>
#include <optional>
#include <vector>

#include "display/kept_pass.hpp"
#include "display/paint_pass.hpp"
#include "display/plane_homographies.hpp"
#include "display/scene_raster.hpp"
#include "display/silhouette_pass.hpp"
#include "display/still_edges.hpp"
#include "display/surface_records.hpp"
#include "gl/camera_block.hpp"
#include "gl/program.hpp"
#include "gl/sampler_reset.hpp"
#include "texture_gpu/frame_gate.hpp"
#include "texture_gpu/published_image.hpp"
#include "texture_gpu/published_textures.hpp"
#include "texture_gpu/seen_inputs.hpp"
#include "texture_gpu/shadow_pass.hpp"
#include "texture_gpu/work_list.hpp"

namespace foresight {

/// How pixels are shared out among programs; the picture is the same.
enum class ViewPrograms {
  two,     ///< the usual case for all, then every case for the pixels that it listed: cheaper on software renderers
  single,  ///< every case for all: to compare with
};

/// Where the textures' light is known, shadows of what moves are drawn where they fall at the state drawn.
///
/// Renders through one lens. First the scene's triangles are rasterised into pinhole faces; then
/// each pixel follows its own ray through the lens model to the triangle seen there, to the exact
/// point on it, to its texels: one filter between texture and picture, none for the lens.
/// Belongs to one context, in a share group with the texture core's.
class PredictedView {
 public:
  PredictedView(std::shared_ptr<const gl::SceneBuffers> scene, std::shared_ptr<const SurfaceRecords> surface,
                const Lens& lens, ViewPrograms programs = ViewPrograms::two,
                const std::optional<ViewLevels>& levels = std::nullopt);

  /// From now on the view is as large as this lens says, which differs from the one before in that alone.
  void set_lens(const Lens& lens);
  const Lens& lens() const { return lens_; }
  /// From now on it is painted so.
  void set_paint(ViewPaint paint);
  /// Whether pixels at edges of surfaces are mixed with those around them (SilhouettePass), as they are from the start,
  /// or stay what was looked up.
  void mix_silhouettes(bool mixed) { mixes_ = mixed; }

  /// Whether pixels towards the view's rim are as dark as the camera's lens makes the newest image there
  /// (PublishedTextures::vignetting), by their share of half the diagonal, or as bright as in its middle, as from the
  /// start.
  void show_vignetting(bool shown) { has_rim_ = shown; }

  /// The next draw(), and the next one with images, compile what later ones need: with the textures' light known or
  /// not, with an image before the newest one or without. They take some drawings longer.
  void prepare() { prepares_ = prepares_images_ = true; }

  /// From now on only this part of what is seen is drawn, and costs what it covers; nothing: all of it. The textures
  /// must outlive that. Throws std::invalid_argument: a lens with distortion, or ViewPrograms::single.
  void draw_part(const std::optional<gl::ViewPart>& part);

  /// From now on views are drawn in bands of rows, each when `gate` lets it; draw() has finished on the GPU then. Null:
  /// at once. It must outlive this.
  void use(FrameGate* gate) { gate_ = gate; }

  /// Draws into picture(). `textures` must stay leased until the GPU has finished.
  void draw(const Pose& T_world_camera, const SceneState& state, const PublishedTextures& textures);
  /// The same, but where one of `images` saw a surface point, and about as sharply as the view shows it, the colour
  /// comes from there, from the newest before the one before; towards its rim each gives way to what comes after it.
  /// All must stay leased. Where others are kept, they are blended over the newest one (KeptPass); not in a part of a
  /// view.
  void draw(const Pose& T_world_camera, const SceneState& state, const PublishedTextures& textures,
            const NewestImages& images);
  /// The one or the other: with images where they are leased.
  void draw(const Pose& T_world_camera, const SceneState& state, const TextureLease& textures,
            const ImagesLease& images) {
    if (images)
      draw(T_world_camera, state, *textures, *images);
    else
      draw(T_world_camera, state, *textures);
  }

  /// RGBA8, straight alpha as in pictures/view_alpha.hpp, row 0 at the top.
  const gl::Texture& picture() const { return picture_; }

  /// Waits for the GPU; CV_8UC4 in BGRA order, kFromImage in place of kFromEdge.
  cv::Mat read() const;
  /// kFromImage in place of kFromEdge, in a picture that was read.
  static void count_as_seen(cv::Mat& bgra);

  /// The triangle seen at each pixel of the last draw()'s faces (gl::FaceImages::surface).
  const gl::FaceImages& faces() const { return faces_; }
  /// gl::make_lens_rays, of lens().
  const gl::Texture& rays() const { return rays_; }
  /// What chooses levels of detail; null where all is drawn in full.
  const LevelDirector* levels() const { return raster_.director(); }

 private:
  /// What the newest images need besides.
  struct Projection {
    Projection(const Lens& view, const Lens& image, bool levels, bool homographies);
    gl::Program newest, before, usual, rest;
    gl::Program newest_of_part, usual_alone;  // once they are needed: the latter without an image before
    WorkList unseen;                          // by the newest image
    WorkList of_before;                       // of these, what the one before shows
    SeenInputs newest_inputs, inputs_before;
    std::optional<PlaneHomographies> homographies;  // to the newest image
  };
  /// What shadows need besides.
  struct Shadows {
    ShadowMap map;
    ShadowPass pass;
    // What the map was drawn of.
    std::shared_ptr<const SceneLight> of;
    std::vector<Pose> T_world_node;
    bool is_there = false;
  };
  void start(const Pose& T_world_camera, const SceneState& state, const PublishedTextures& textures,
             const std::shared_ptr<const SceneLight>& light, const Eigen::Vector2f& vignetting);
  void shade(const Pose& T_world_camera, const SceneState& state, const std::shared_ptr<const SceneLight>& light);
  void find_shadows(const Pose& T_world_camera, const SceneState& state,
                    const std::shared_ptr<const SceneLight>& light);
  void draw_silhouettes();
  void show_still_edges(const PublishedImage& newest, const Pose& T_world_camera);
  void finish(const PublishedTextures& textures, RobotTime instant);
  struct Rows {
    int first = 0, last = 0;  // beyond the last
  };
  std::vector<std::shared_ptr<const SceneLight>> lights_to_prepare(
      bool& prepares, const SceneState& state, const std::shared_ptr<const SceneLight>& light) const;
  void draw_lit(const Pose& T_world_camera, const SceneState& state, const PublishedTextures& textures,
                const std::shared_ptr<const SceneLight>& light);
  void draw_lit(const Pose& T_world_camera, const SceneState& state, const PublishedTextures& textures,
                const NewestImages& images, const std::shared_ptr<const SceneLight>& light,
                const PublishedImage* before);
  void look_up(const NewestImages& images, const PublishedImage* before);
  void draw_newest(const NewestImages& images, Rows rows) const;
  void draw_usual();
  void draw_usual_and_before(const PublishedImage& before, const PublishedImage& newest);
  void start_part() const;
  void list_covered(Rows rows, const gl::Program& by) const;
  template <typename DrawRows>
  void draw_rows(DrawRows draw) const;
  void dispatch_all(const gl::Program& program, Rows rows) const;
  void start(WorkList& list) const;
  static void dispatch(const WorkList& list, const gl::Program& program);

  Lens lens_;
  std::shared_ptr<const SurfaceRecords> surface_;
  std::shared_ptr<const gl::SceneBuffers> scene_;
  SceneRaster raster_;
  gl::FaceImages faces_;
  ViewPrograms programs_;
  gl::Program all_, listed_;  // view.glsl: the first for every pixel, the other for those that it listed
  WorkList rest_;
  struct Part {
    gl::Program covered;
    WorkList pixels;
  };
  std::unique_ptr<Part> part_;  // from the first draw_part() on
  bool draws_part_ = false;
  std::unique_ptr<Projection> projection_;  // from the first such draw() on
  std::unique_ptr<KeptPass> kept_;          // from the first one with images beside the newest on
  gl::Buffer camera_;
  gl::BufferTexture node_poses_;                     // T_node_camera: three rows a node
  gl::Texture rays_;                                 // RGB32F directions, only for lenses with distortion
  std::unique_ptr<Shadows> shadows_;                 // from the first known light on, or since they were prepared
  gl::Texture unshaded_;                             // white: where there is no light
  bool prepares_ = false, prepares_images_ = false;  // with the next draw(); with the next one with images
  SilhouettePass silhouettes_;
  std::unique_ptr<StillEdges> still_edges_;  // from the first view of an image on
  gl::Texture picture_;
  gl::SamplerReset reset_samplers_;
  FrameGate* gate_ = nullptr;
  bool mixes_ = true, has_rim_ = false;
  ViewPaint paint_ = ViewPaint::colours;
  std::unique_ptr<PaintPass> painter_;  // once it is needed
};

}  // namespace foresight
