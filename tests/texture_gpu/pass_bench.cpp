#include "tests/texture_gpu/pass_bench.hpp"

#include <stdexcept>

namespace foresight {

PassBench::PassBench(std::shared_ptr<const SceneModel> model, const std::vector<Lens>& lenses, TextureOptions o,
                     const PatchOptions& patches)
    : scene(std::move(model)),
      surface(std::make_shared<SurfacePatches>(find_surface_patches(*scene, patches))),
      options(o),
      atlas(surface, options),
      store(atlas),
      raster(std::make_shared<gl::SceneBuffers>(*scene), false),
      survey(lenses),
      extraction(lenses),
      filling(*surface),
      first_page_before_(surface->charts.size(), 0) {
  for (const Lens& lens : lenses) cameras.push_back(std::make_unique<CameraInput>(lens, options.margin_px));
  current = fresh_generation();
  std::vector<Eigen::Vector4f> rows;
  atlas.write_charts(rows);
  current->charts.assign(std::span<const Eigen::Vector4f>(rows));
  current->means.buffer().clear_to_zero();
  current->coarse.buffer().clear_to_zero();
}

std::shared_ptr<PublishedTextures> PassBench::fresh_generation() const {
  auto fresh = std::make_shared<PublishedTextures>();
  fresh->table = gl::BufferTexture(GL_R32UI, 16, "page table");
  fresh->charts = gl::BufferTexture(GL_RGBA32F, 16, "charts");
  fresh->coarse = gl::BufferTexture(atlas::kMeanFormat, 16, "page means");
  fresh->means = gl::BufferTexture(atlas::kMeanFormat, surface->charts.size() * atlas::kMeanBytes, "chart means");
  fresh->colours = store.colours;
  return fresh;
}

void PassBench::look(const std::vector<PosedImage>& taken, const std::vector<Eigen::Vector3f>& tones) {
  images = taken;
  views.clear();
  std::vector<const CameraInput*> active;
  std::vector<const PosedImage*> pointers;
  for (std::size_t i = 0; i < images.size(); ++i) {
    cameras[i]->upload(images[i].pixels);
    raster(images[i].T_world_camera, images[i].scene, cameras[i]->faces(), &cameras[i]->marked_depth());
    edges(*cameras[i], options.margin_px, options.depth_tolerance);
    AtlasView view{&cameras[i]->lens(), &cameras[i]->faces().faces, {}};
    for (const Pose& T : images[i].scene.T_world_node)
      view.T_camera_node.push_back(images[i].T_world_camera.inverse() * T);
    views.push_back(std::move(view));
    active.push_back(cameras[i].get());
    pointers.push_back(&images[i]);
  }
  inputs.update(active, pointers, tones.empty() ? std::vector<Eigen::Vector3f>(images.size(), {1, 0, 0}) : tones);
}

const std::vector<std::uint32_t>& PassBench::cull() {
  records = atlas.plan(views);
  next = fresh_generation();
  std::vector<Eigen::Vector4f> rows;
  atlas.write_charts(rows);
  next->charts.assign(std::span<const Eigen::Vector4f>(rows));
  survey.set_pages(records);
  masks = survey.cull(inputs, next->charts, options.depth_tolerance);
  return masks;
}

const ChartAtlas::Allocation& PassBench::allocate() {
  if (!store.hold(atlas.reach(masks))) throw std::runtime_error("the atlas could not grow");
  next->colours = store.colours;
  allocation = atlas.allocate(masks, image);
  if (!allocation.fits) throw std::logic_error("the bench's atlas is too small");
  std::vector<std::uint32_t> table;
  atlas.write_table(table);
  next->table.assign(std::span<const std::uint32_t>(table));
  return allocation;
}

void PassBench::relevel() {
  extraction.upload_heights(atlas, allocation.new_heights, store);
  extraction.relevel(allocation.relevel, next->charts, *current, store);
}

void PassBench::extract(double minify_above) {
  std::vector<Eigen::Vector4f> geometry;
  atlas.write_job_geometry(allocation.jobs, views, geometry);
  extraction.extract({allocation.jobs, allocation.masks, geometry, minify_above, image}, inputs, store,
                     options.depth_tolerance);
}

void PassBench::fill() {
  // Every chart with pages counts as changed.
  std::vector<std::uint32_t> dirty, chart_of_page;
  for (std::size_t i = 0; i < atlas.charts().size(); ++i) {
    const auto count = static_cast<std::size_t>(atlas.charts()[i].pages.prod());
    if (count) dirty.push_back(static_cast<std::uint32_t>(i));
    chart_of_page.insert(chart_of_page.end(), count, static_cast<std::uint32_t>(i));
  }
  next->coarse.reserve(chart_of_page.size() * atlas::kMeanBytes);
  filling(extraction, {allocation.jobs.size(), dirty, chart_of_page, {}}, store, *current, *next);
  glFinish();
  atlas.commit();
  atlas.give_back_colours(allocation.retired);
  current = next;
  ++image;
}

void PassBench::run(const std::vector<PosedImage>& taken, const std::vector<Eigen::Vector3f>& tones,
                    double minify_above) {
  look(taken, tones);
  cull();
  allocate();
  relevel();
  extract(minify_above);
  fill();
}

reference::Camera PassBench::camera(std::size_t i) const {
  const CameraInput& input = *cameras[i];
  const gl::Faces& faces = input.faces().faces;
  const auto face_pixels = static_cast<std::size_t>(faces.width * faces.height);
  std::vector<float> depth(face_pixels * static_cast<std::size_t>(faces.count));
  std::vector<float> marked(depth.size());
  glGetTextureImage(input.faces().depth.name(), 0, GL_DEPTH_COMPONENT, GL_FLOAT, static_cast<GLsizei>(depth.size() * 4),
                    depth.data());
  glGetTextureImage(input.marked_depth().name(), 0, GL_RED, GL_FLOAT, static_cast<GLsizei>(marked.size() * 4),
                    marked.data());
  std::vector<std::uint8_t> uncertain;
  for (const float near_over_z : marked) uncertain.push_back(near_over_z < -1 ? 2 : near_over_z < 0);
  reference::Camera out{input.lens(), faces, views[i].T_camera_node, {}, {}, images[i].pixels};
  for (std::size_t face = 0; face < static_cast<std::size_t>(faces.count); ++face) {
    const std::size_t from = face * face_pixels;
    reference::FacePicture picture{faces.width, faces.height, {}, {}};
    for (std::size_t k = from; k < from + face_pixels; ++k) picture.inverse_z.push_back(depth[k] / gl::kNearPlane);
    out.depth.push_back(std::move(picture));
    out.uncertain.emplace_back(uncertain.begin() + static_cast<std::ptrdiff_t>(from),
                               uncertain.begin() + static_cast<std::ptrdiff_t>(from + face_pixels));
  }
  return out;
}

std::vector<Eigen::Vector2f> PassBench::blocks(std::size_t i) const {
  const gl::Texture& texture = cameras[i]->blocks();
  std::vector<Eigen::Vector2f> out(static_cast<std::size_t>(texture.width() * texture.height() * texture.layers()));
  glGetTextureImage(texture.name(), 0, GL_RG, GL_FLOAT, static_cast<GLsizei>(out.size() * 8), out.data());
  return out;
}

bool PassBench::turned_away(std::uint32_t index) const {
  const Chart& chart = surface->charts[index];
  if (!chart.closed()) return false;
  for (const AtlasView& view : views) {
    const Eigen::Vector3d eye =
        view.T_camera_node[static_cast<std::size_t>(patch_of(index).node)].inverse().translation();
    for (const std::uint32_t t : chart.triangles) {
      const auto& p = surface->corners[t];
      if ((p[1] - p[0]).cross(p[2] - p[0]).dot(eye - p[0]) > 0) return false;
    }
  }
  return true;
}

Eigen::Vector3d PassBench::texel_point(const AtlasChart& chart, const Patch& patch, int x, int y) const {
  const ChartRaster& r = chart.raster;
  const Eigen::Vector2d uv = r.uv0 + Eigen::Vector2d(x, y).cwiseQuotient(r.density);
  const double height = r.height0 + ((raw_height(chart, x, y) & 0x7fff) - 1) * r.height_step;
  return patch.origin + uv.x() * patch.eu + uv.y() * patch.ev + height * patch.n;
}

std::uint16_t PassBench::raw_height(const AtlasChart& chart, int x, int y) const {
  const ChartRaster& r = chart.raster;
  if (heights_.of != &chart || heights_.density != r.density) heights_ = {&chart, r.density, chart.heights.unpacked()};
  return x < r.width && y < r.height
             ? heights_
                   .raw[static_cast<std::size_t>(y) * static_cast<std::size_t>(r.width) + static_cast<std::size_t>(x)]
             : std::uint16_t{0};
}

}  // namespace foresight
