#include "texture_gpu/old_shadows.hpp"

#include <algorithm>
#include <map>

#include "texture_gpu/extract_pass.hpp"
#include "texture_gpu/shaders.hpp"

namespace foresight {
namespace {

constexpr std::size_t kPosesKept = 1 << 14;  // of nodes: 2 MiB, some 500 images of the lab
constexpr GLuint kMapUnit = 3;

}  // namespace

OldShadows::OldShadows(std::shared_ptr<const gl::SceneBuffers> scene)
    : scene_(std::move(scene)),
      geometry_(GL_RGBA32F, 4096, "pages in old shadows"),
      tiles_(GL_R32UI, 4096, "tiles in old shadows") {}

void OldShadows::note(Image image) {
  if (!images_.empty() && images_.back().number == image.number) images_.pop_back();
  images_.push_back(std::move(image));
  if (images_.size() > 1 && images_.size() * images_.back().state.T_world_node.size() > kPosesKept) images_.pop_front();
}

/// Whose colours the tile has; null where that is none of those that are remembered.
const OldShadows::Image* OldShadows::image_of(const AtlasPage& page, unsigned tile) const {
  if (page.colour == atlas::kNoSlot || !(page.held >> tile & 1u)) return nullptr;
  const std::int64_t from = page.tile_from[tile], number = from < 0 ? page.written : from;
  const auto found = std::ranges::lower_bound(images_, number, {}, &Image::number);
  return found != images_.end() && found->number == number ? &*found : nullptr;
}

/// Whether something that moves may stand between the lamp and a ball, world.
bool OldShadows::may_shade(const Image& image, const SceneLight& light, const Eigen::Vector3d& middle,
                           double radius) const {
  const auto& boxes = scene_->boxes().box;
  const Eigen::Vector3d way = light.lamp.position - middle;
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    if (!light.moving[i] || boxes[i].isEmpty()) continue;
    const Eigen::Vector3d part = image.state.T_world_node[i] * boxes[i].center() - middle;
    const double along = std::clamp(part.dot(way) / way.squaredNorm(), 0.0, 1.0);
    if ((part - along * way).norm() < 0.5 * boxes[i].diagonal().norm() + radius + light.lamp.radius) return true;
  }
  return false;
}

OldShadows::Pages OldShadows::in_shadow(const ChartAtlas& atlas, const SceneLight& light) const {
  Pages out;
  std::map<const Image*, std::vector<std::uint32_t>> tiles_of;
  for (std::size_t c = 0; c < atlas.charts().size(); ++c) {
    const AtlasChart& chart = atlas.charts()[c];
    for (std::size_t k = 0; k < chart.page.size(); ++k) {
      const auto [node, middle, radius] = atlas.ball_around(c, static_cast<int>(k));
      bool is_listed = false;
      for (unsigned tile = 0; tile < 4; ++tile) {
        const Image* image = image_of(chart.page[k], tile);
        if (!image || !may_shade(*image, light, image->state.T_world_node[node] * middle, radius)) continue;
        if (!is_listed) out.list.push_back({static_cast<std::uint32_t>(c), static_cast<int>(k)});
        is_listed = true;
        tiles_of[image].push_back(static_cast<std::uint32_t>(out.list.size() - 1) << 4 | tile << 2);
      }
    }
  }
  for (auto& [image, tiles] : tiles_of) out.shaded.push_back({image, std::move(tiles)});
  return out;
}

void OldShadows::take_out(const Pages& pages, std::span<const PageJob> jobs, const ChartAtlas& atlas,
                          const AtlasStore& store, const SceneLight& light, const gl::SamplerReset& reset_samplers) {
  if (!map_) {
    map_ = std::make_unique<ShadowMap>(scene_);
    program_ = std::make_unique<gl::Program>(gl::Program::compute(gl::texture_gpu_shaders(), "unshade_texels.comp"));
  }
  std::vector<Eigen::Vector4f> geometry;
  for (const auto& [image, tiles] : pages.shaded) {
    if (!map_->update(light, image->state)) continue;
    AtlasView lamp;
    const Pose T_lamp_world = map_->T_world_lamp().inverse();
    for (const Pose& T_world_node : image->state.T_world_node)
      lamp.T_camera_node.push_back(T_lamp_world * T_world_node);
    atlas.write_job_geometry(jobs, {&lamp, 1}, geometry);
    geometry_.assign(std::span<const Eigen::Vector4f>(geometry));
    tiles_.assign(std::span<const std::uint32_t>(tiles));
    program_->set("seen_from", (T_lamp_world * image->seen_from).homogeneous().cast<float>().eval());
    map_->bind(*program_, kMapUnit);
    glBindTextureUnit(7, geometry_.texture());
    glBindTextureUnit(9, store.heights.name());
    glBindTextureUnit(10, tiles_.texture());
    glBindImageTexture(0, store.colours->name(), 0, GL_TRUE, 0, GL_READ_WRITE, atlas::kStoredColourFormat);
    dispatch_groups(*program_, tiles.size());
    reset_samplers();
  }
  glMemoryBarrier(GL_TEXTURE_FETCH_BARRIER_BIT | GL_SHADER_IMAGE_ACCESS_BARRIER_BIT);
}

}  // namespace foresight
