// Runs the passes one after the other, as TextureCore does, and reads back what each wrote.
#pragma once

#include "tests/support/small_scene.hpp"
#include "tests/texture_gpu/reference/atlas_pixels.hpp"
#include "tests/texture_gpu/reference/seeing.hpp"
#include "texture_gpu/edge_pass.hpp"
#include "texture_gpu/extract_pass.hpp"
#include "texture_gpu/fill_pass.hpp"
#include "texture_gpu/survey_pass.hpp"

namespace foresight {

class PassBench {
 public:
  PassBench(std::shared_ptr<const SceneModel> scene, const std::vector<Lens>& lenses, TextureOptions options,
            const PatchOptions& patches = {});

  /// Upload, depth and edges of one image per lens.
  void look(const std::vector<PosedImage>& images, const std::vector<Eigen::Vector3f>& tones = {});

  /// Plan and cull; then allocate.
  const std::vector<std::uint32_t>& cull();
  const ChartAtlas::Allocation& allocate();

  /// Heights, re-levelling, extraction.
  void relevel();
  void extract(double minify_above = kNever);

  /// Filling, then the flip.
  void fill();

  /// All of it for one set of images.
  void run(const std::vector<PosedImage>& images, const std::vector<Eigen::Vector3f>& tones = {},
           double minify_above = kNever);
  static constexpr double kNever = 1e9;  ///< of ExtractPass::Work::minify_above: Catmull-Rom for all texels

  /// What the reference needs of camera `i`, its depth and edges as the GPU found them.
  reference::Camera camera(std::size_t i) const;
  std::vector<Eigen::Vector2f> blocks(std::size_t i) const;
  reference::AtlasPixels pixels() const { return reference::AtlasPixels(*store.colours); }
  reference::Generation generation() const { return {*current, surface->charts.size()}; }

  /// True where all cameras see all triangles of a solid's chart from behind: its texels count as
  /// unseen, though a thin solid's may lie within the depth tolerance of what is seen.
  bool turned_away(std::uint32_t chart) const;

  /// Place of a chart's texel in the frame of its node.
  Eigen::Vector3d texel_point(const AtlasChart& chart, const Patch& patch, int x, int y) const;
  const Patch& patch_of(std::uint32_t chart) const {
    return surface->patches[static_cast<std::size_t>(surface->charts[chart].patch)];
  }
  std::uint16_t raw_height(const AtlasChart& chart, int x, int y) const;

  std::shared_ptr<const SceneModel> scene;
  std::shared_ptr<const SurfacePatches> surface;
  TextureOptions options;
  ChartAtlas atlas;
  AtlasStore store;
  std::vector<std::unique_ptr<CameraInput>> cameras;
  std::vector<PosedImage> images;
  std::vector<AtlasView> views;
  SeenInputs inputs;
  gl::RasterPass raster;
  EdgePass edges;
  SurveyPass survey;
  ExtractPass extraction;
  FillPass filling;
  std::span<const PageRecord> records;
  std::vector<std::uint32_t> masks;
  ChartAtlas::Allocation allocation;
  std::shared_ptr<PublishedTextures> current, next;
  std::int64_t image = 0;

 private:
  std::shared_ptr<PublishedTextures> fresh_generation() const;
  std::vector<int> first_page_before_;
  struct Heights {
    const AtlasChart* of = nullptr;
    Eigen::Vector2d density{0, 0};
    std::vector<std::uint16_t> raw;
  };
  mutable Heights heights_;  ///< of the chart that was asked last
};

}  // namespace foresight
