#include "display/warp/warp_layers.hpp"

#include <algorithm>
#include <stdexcept>

#include "display/warp/warp_shaders.hpp"
#include "scene/visibility.hpp"

namespace foresight {

WarpScene::WarpScene(const SceneModel& scene) : boxes_(NodeBoxes(scene).box) {
  std::vector<std::uint8_t> nodes;
  nodes.reserve(scene.triangle_count());
  for (std::size_t i = 0; i < scene.nodes().size(); ++i)
    nodes.insert(nodes.end(), scene.nodes()[i].mesh.triangles.size(),
                 static_cast<std::uint8_t>(std::min(i, kMostNodes) + 1));
  node_of_triangle_ = gl::BufferTexture(GL_R8UI, nodes.size(), "nodes of triangles");
  node_of_triangle_.assign(std::span<const std::uint8_t>(nodes));
}

WarpLayers::WarpLayers(const Lens& through, bool is_of_part)
    : lens(through),
      of_part(is_of_part),
      picture(GL_RGBA8, lens.width(), lens.height(), 0, 1, "picture to be warped"),
      depth(GL_R32F, lens.width(), lens.height(), 0, 1, "depth to be warped"),
      node(GL_R8UI, lens.width(), lens.height(), 0, 1, "nodes to be warped"),
      blocks(GL_RGBA32F, warp_blocks(lens.width()), warp_blocks(lens.height()), 0, 1, "depths of blocks") {
  if (lens.has_distortion() || lens.model() == LensModel::equidistant)
    throw std::invalid_argument("a source of warping has a distortion");
  glTextureParameteri(picture.name(), GL_TEXTURE_MIN_FILTER, GL_LINEAR);
  glTextureParameteri(picture.name(), GL_TEXTURE_MAG_FILTER, GL_LINEAR);
}

LayerCapture::LayerCapture(std::shared_ptr<const WarpScene> scene)
    : scene_(std::move(scene)),
      capture_(gl::Program::compute(gl::warp_shaders(), "capture.comp")),
      blocks_(gl::Program::compute(gl::warp_shaders(), "blocks.comp")) {}

void LayerCapture::operator()(const gl::Texture& picture, const gl::FaceImages& faces, const Pose& T_world_camera,
                              const SceneState& state, WarpLayers& layers) const {
  const int width = layers.lens.width(), height = layers.lens.height();
  const auto fits = [&](const gl::Texture& texture) { return texture.width() == width && texture.height() == height; };
  if (!fits(picture) || !fits(faces.depth) || !fits(faces.surface) || faces.faces.count != 1)
    throw std::invalid_argument("layers of warping have another size than the view");
  layers.T_world_camera = T_world_camera;
  layers.T_world_node = state.T_world_node;

  glCopyImageSubData(picture.name(), GL_TEXTURE_2D, 0, 0, 0, 0, layers.picture.name(), GL_TEXTURE_2D, 0, 0, 0, 0, width,
                     height, 1);
  capture_.set("size", Eigen::Vector2i(width, height));
  glBindTextureUnit(0, faces.depth.name());
  glBindTextureUnit(1, faces.surface.name());
  glBindTextureUnit(2, scene_->node_of_triangle());
  glBindImageTexture(0, layers.depth.name(), 0, GL_FALSE, 0, GL_WRITE_ONLY, GL_R32F);
  glBindImageTexture(1, layers.node.name(), 0, GL_FALSE, 0, GL_WRITE_ONLY, GL_R8UI);
  capture_.dispatch(width, height);
  glMemoryBarrier(GL_TEXTURE_FETCH_BARRIER_BIT);
  find_blocks(layers);
}

void LayerCapture::find_blocks(const WarpLayers& layers) const {
  blocks_.set("size", Eigen::Vector2i(layers.lens.width(), layers.lens.height()));
  blocks_.set("of_part", static_cast<int>(layers.of_part));
  glBindTextureUnit(0, layers.depth.name());
  glBindImageTexture(0, layers.blocks.name(), 0, GL_FALSE, 0, GL_WRITE_ONLY, GL_RGBA32F);
  blocks_.dispatch(layers.blocks.width(), layers.blocks.height());
  glMemoryBarrier(GL_TEXTURE_FETCH_BARRIER_BIT);
}

gl::ViewPart LayerCapture::behind_edges(const WarpLayers& front) {
  constexpr int kReach = 2;  // blocks: what is hidden farther from an edge stays hidden
  gl::ViewPart out;
  out.seen = front.depth.name();
  out.edges = edges_(front, kReach).name();
  return out;
}

}  // namespace foresight
