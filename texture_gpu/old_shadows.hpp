// Shadows that textures hold from images that came before the lamp was known.
#pragma once

#include <deque>
#include <memory>
#include <vector>

#include "gl/sampler_reset.hpp"
#include "texture_gpu/atlas_store.hpp"
#include "texture_gpu/shadow_map.hpp"

namespace foresight {

/// Remembers where everything stood in images whose shadows were left in them, and takes these out of textures once it
/// is known where the lamp is. One context.
class OldShadows {
 public:
  explicit OldShadows(std::shared_ptr<const gl::SceneBuffers> scene);

  struct Image {
    std::int64_t number;
    RobotTime time;
    SceneState state;
    Eigen::Vector3d seen_from;  ///< the camera's place, world
  };
  /// The image keeps its shadows.
  void note(Image image);
  bool empty() const { return images_.empty(); }
  void clear() { images_.clear(); }
  const Image& oldest() const { return images_.front(); }  ///< that is remembered

  /// Of one image: which pages of a list, and which tiles of these (page << 4 | tile << 2).
  struct Shaded {
    const Image* image;
    std::vector<std::uint32_t> tiles;
  };
  struct Pages {
    std::vector<ChartAtlas::PagePlace> list;
    std::vector<Shaded> shaded;
  };
  /// What may hold a shadow of something that moves.
  Pages in_shadow(const ChartAtlas& atlas, const SceneLight& light) const;

  /// Divides the texels by the shadows that fell on them. `jobs`: of each page, whose new places hold its colours, and
  /// nobody looks them up yet. `reset_samplers` runs after each image.
  void take_out(const Pages& pages, std::span<const PageJob> jobs, const ChartAtlas& atlas, const AtlasStore& store,
                const SceneLight& light, const gl::SamplerReset& reset_samplers);

 private:
  const Image* image_of(const AtlasPage& page, unsigned tile) const;
  bool may_shade(const Image& image, const SceneLight& light, const Eigen::Vector3d& middle, double radius) const;

  std::shared_ptr<const gl::SceneBuffers> scene_;
  std::deque<Image> images_;  // by their numbers
  std::unique_ptr<ShadowMap> map_;
  std::unique_ptr<gl::Program> program_;
  gl::BufferTexture geometry_, tiles_;
};

}  // namespace foresight
