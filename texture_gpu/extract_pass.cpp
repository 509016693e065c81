#include "texture_gpu/extract_pass.hpp"

#include <algorithm>

#include "texture_gpu/shaders.hpp"

namespace foresight {

namespace {

gl::Program extract_program(std::span<const Lens> lenses, std::size_t variant) {
  auto defines = gl::camera_defines(lenses);
  defines.push_back("CAMERAS " + std::to_string(1 + variant / 2));
  defines.push_back("MINIFY " + std::to_string(variant % 2));
  return gl::Program::compute(gl::texture_gpu_shaders(), "extract.comp", defines);
}

}  // namespace

ExtractPass::ExtractPass(std::span<const Lens> lenses)
    : heights_(gl::Program::compute(gl::texture_gpu_shaders(), "heights.comp")),
      relevel_(gl::Program::compute(gl::texture_gpu_shaders(), "relevel.comp")),
      copy_(gl::Program::compute(gl::texture_gpu_shaders(), "copy.comp")),
      jobs_(GL_RGBA32UI, 4096, "extraction jobs"),
      geometry_(GL_RGBA32F, 4096, "job geometry"),
      relevel_jobs_(GL_RGBA32UI, 4096, "relevel jobs"),
      tiles_(GL_R32UI, 4096, "tiles"),
      copy_tiles_(GL_R32UI, 4096, "tiles to copy"),
      holes_(GL_R32UI, 4096, "holes"),
      staged_(GL_R16UI, 4096, "staged heights"),
      slots_(GL_R32UI, 4096, "height slots") {
  for (std::size_t v = 0; v < 2 * lenses.size(); ++v) extract_[v] = extract_program(lenses, v);
}

void dispatch_groups(const gl::Program& program, std::size_t count) {
  constexpr std::size_t kMost = 65535;
  for (std::size_t first = 0; first < count; first += kMost) {
    program.set("first_group", static_cast<int>(first));
    glDispatchCompute(static_cast<GLuint>(std::min(kMost, count - first)), 1, 1);
  }
}

void ExtractPass::upload_heights(const ChartAtlas& atlas, std::span<const std::pair<std::uint32_t, int>> pages,
                                 const AtlasStore& store) {
  constexpr std::size_t kBatch = 16384;
  for (std::size_t first = 0; first < pages.size(); first += kBatch) {
    const auto batch = pages.subspan(first, std::min(kBatch, pages.size() - first));
    std::vector<std::uint16_t> raw(batch.size() * 256, 0);
    std::vector<std::uint32_t> slots;
    for (std::size_t i = 0; i < batch.size(); ++i) {
      const AtlasChart& chart = atlas.charts()[batch[i].first];
      slots.push_back(chart.page[static_cast<std::size_t>(batch[i].second)].height);
      const int x0 = atlas::kPage * (batch[i].second % chart.pages.x()),
                y0 = atlas::kPage * (batch[i].second / chart.pages.x());
      const int columns = std::min(atlas::kPage, chart.raster.width - x0),
                rows = std::min(atlas::kPage, chart.raster.height - y0);
      for (int y = 0; y < rows; ++y)
        std::copy_n(chart.raster.raw.begin() + (y0 + y) * chart.raster.width + x0, columns,
                    raw.begin() + static_cast<std::ptrdiff_t>(i * 256) + y * atlas::kPage);
    }
    staged_.assign(std::span<const std::uint16_t>(raw));
    slots_.assign(std::span<const std::uint32_t>(slots));
    heights_.use();
    glBindTextureUnit(7, staged_.texture());
    glBindTextureUnit(8, slots_.texture());
    glBindImageTexture(0, store.heights.name(), 0, GL_TRUE, 0, GL_WRITE_ONLY, GL_R16UI);
    glDispatchCompute(static_cast<GLuint>(batch.size()), 1, 1);
  }
  if (!pages.empty()) glMemoryBarrier(GL_TEXTURE_FETCH_BARRIER_BIT);
}

void ExtractPass::relevel(std::span<const PageJob> jobs, const gl::BufferTexture& charts,
                          const PublishedTextures& published, const AtlasStore& store) {
  if (jobs.empty()) return;
  relevel_jobs_.assign(jobs);
  relevel_.use();
  glBindTextureUnit(7, relevel_jobs_.texture());
  glBindTextureUnit(8, charts.texture());
  published.bind();
  glBindImageTexture(0, store.colours.name(), 0, GL_TRUE, 0, GL_WRITE_ONLY, GL_RGBA8);
  dispatch_groups(relevel_, 4 * jobs.size());
  glMemoryBarrier(GL_TEXTURE_FETCH_BARRIER_BIT | GL_SHADER_IMAGE_ACCESS_BARRIER_BIT);
}

void ExtractPass::extract(const Work& work, const SeenInputs& inputs, const AtlasStore& store, double depth_tolerance,
                          double worse) {
  std::vector<std::uint32_t> tiles, unseen;
  tiles.reserve(4 * work.jobs.size());
  for (std::size_t i = 0; i < work.jobs.size(); ++i)
    for (std::uint32_t t = 0; t < 4; ++t) {
      const std::uint32_t cameras = (work.masks[i] >> (2 * t)) & 3u;
      (cameras ? tiles : unseen).push_back(static_cast<std::uint32_t>(i) << 4 | t << 2 | cameras);
    }
  tile_count_ = tiles.size();
  if (work.jobs.empty()) return;
  jobs_.assign(work.jobs);
  geometry_.assign(work.geometry);
  tiles_.assign(std::span<const std::uint32_t>(tiles));
  copy_tiles_.assign(std::span<const std::uint32_t>(unseen));
  holes_.reserve(4 * work.jobs.size() * sizeof(std::uint32_t));
  holes_.buffer().clear_to_zero();

  glBindTextureUnit(9, store.heights.name());
  glBindTextureUnit(11, store.colours.name());
  glBindImageTexture(0, store.colours.name(), 0, GL_TRUE, 0, GL_WRITE_ONLY, GL_RGBA8);
  glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 0, holes_.buffer().name());

  const gl::Program& program =
      extract_[2 * static_cast<std::size_t>(inputs.camera_count() - 1) + (work.minify ? 1 : 0)];
  inputs.bind(program, depth_tolerance);
  program.set("worse", static_cast<float>(worse));
  glBindTextureUnit(7, geometry_.texture());
  glBindTextureUnit(10, tiles_.texture());
  program.set("tile_count", static_cast<int>(tiles.size()));
  dispatch_groups(program, (tiles.size() + 3) / 4);

  copy_.use();
  glBindTextureUnit(7, jobs_.texture());
  glBindTextureUnit(10, copy_tiles_.texture());
  dispatch_groups(copy_, unseen.size());
  glMemoryBarrier(GL_TEXTURE_FETCH_BARRIER_BIT | GL_SHADER_IMAGE_ACCESS_BARRIER_BIT | GL_BUFFER_UPDATE_BARRIER_BIT);
}

}  // namespace foresight
