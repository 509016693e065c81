#include "texture_gpu/extract_pass.hpp"

#include <algorithm>

#include "texture_gpu/frame_gate.hpp"
#include "texture_gpu/shaders.hpp"

namespace foresight {

namespace {

constexpr std::size_t kInvocationsPerTile = 16;  // as in extract.comp

gl::Program extract_program(std::span<const Lens> lenses, std::size_t cameras, std::size_t size) {
  auto defines = gl::camera_defines(lenses);
  defines.push_back("CAMERAS " + std::to_string(cameras));
  defines.push_back("TEXELS " + std::to_string(size));
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
      copy_tiles_(GL_R32UI, 4096, "tiles to copy"),
      holes_(GL_R32UI, 4096, "holes"),
      staged_(GL_R16UI, 4096, "staged heights"),
      slots_(GL_R32UI, 4096, "height slots"),
      by_levels_(gl::create_level_sampler("levels of images")) {
  for (auto& tiles : tiles_) tiles = gl::BufferTexture(GL_R32UI, 4096, "tiles of a size");
  for (std::size_t v = 0; v < kSizes * lenses.size(); ++v)
    extract_[v] = extract_program(lenses, 1 + v / kSizes, v % kSizes);
}

void dispatch_groups(const gl::Program& program, std::size_t count) {
  dispatch_slices(program, count, nullptr, "");
}

void dispatch_slices(const gl::Program& program, std::size_t count, FrameGate* gate, const char* kind) {
  constexpr std::size_t kMost = 65535;
  program.use();
  for (std::size_t first = 0, now = 0; first < count; first += now) {
    now = next_slice(gate, kind, std::min(kMost, count - first));
    program.set("first_group", static_cast<int>(first));
    glDispatchCompute(static_cast<GLuint>(now), 1, 1);
  }
}

void ExtractPass::upload_heights(const ChartAtlas& atlas, std::span<const std::pair<std::uint32_t, int>> pages,
                                 const AtlasStore& store) {
  constexpr std::size_t kBatch = 16384;
  for (std::size_t first = 0; first < pages.size(); first += kBatch) {
    const auto batch = pages.subspan(first, std::min(kBatch, pages.size() - first));
    std::vector<std::uint16_t> raw(batch.size() * 256, 0);
    std::vector<std::uint32_t> slots;
    std::vector<std::uint16_t> heights;  // of the last page's chart
    for (std::size_t i = 0; i < batch.size(); ++i) {
      const AtlasChart& chart = atlas.charts()[batch[i].first];
      if (i == 0 || batch[i].first != batch[i - 1].first) heights = chart.heights.unpacked();
      slots.push_back(chart.page[static_cast<std::size_t>(batch[i].second)].height);
      const int x0 = atlas::kPage * (batch[i].second % chart.pages.x()),
                y0 = atlas::kPage * (batch[i].second / chart.pages.x());
      const int columns = std::min(atlas::kPage, chart.raster.width - x0),
                rows = std::min(atlas::kPage, chart.raster.height - y0);
      for (int y = 0; y < rows; ++y)
        std::copy_n(heights.begin() + (y0 + y) * chart.raster.width + x0, columns,
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
  glBindTextureUnit(7, relevel_jobs_.texture());
  glBindTextureUnit(8, charts.texture());
  published.bind();
  glBindImageTexture(0, store.colours->name(), 0, GL_TRUE, 0, GL_WRITE_ONLY, atlas::kStoredColourFormat);
  dispatch_groups(relevel_, 4 * jobs.size());
  glMemoryBarrier(GL_TEXTURE_FETCH_BARRIER_BIT | GL_SHADER_IMAGE_ACCESS_BARRIER_BIT);
}

/// Into those that cameras may see, by the size of their texels in pixels, and the others.
void ExtractPass::sort_tiles(const Work& work, const SeenInputs& inputs) {
  for (auto& tiles : seen_tiles_) tiles.clear();
  unseen_tiles_.clear();
  const int cameras = inputs.camera_count();
  // Pixels per texel of a page, from its corner and axes in the camera's frame.
  const auto texel_size = [&](std::size_t job, int camera) {
    const auto* g = &work.geometry[4 * (job * static_cast<std::size_t>(cameras) + static_cast<std::size_t>(camera))];
    const Lens::Parameters& lens = inputs.camera(camera).lens().parameters();
    const Eigen::Vector3f eu = g[1].head<3>(), ev = g[2].head<3>();
    const Eigen::Vector3f p = g[0].head<3>() + 0.5f * atlas::kPage * (eu + ev);
    const Eigen::Vector3f sight = p.normalized();
    const auto across = [&](const Eigen::Vector3f& axis) { return (axis - sight * sight.dot(axis)).norm(); };
    return std::max(lens.fx, lens.fy) * std::max(across(eu), across(ev)) / p.norm();
  };
  for (std::size_t i = 0; i < work.jobs.size(); ++i) {
    double largest = 0;
    for (int c = 0; c < cameras; ++c) largest = std::max(largest, texel_size(i, c));
    std::size_t size = 0;
    for (double limit = work.minify_above; size + 1 < kSizes && largest > limit; limit *= 2) ++size;
    for (std::uint32_t t = 0; t < 4; ++t) {
      const std::uint32_t seen_by = (work.masks[i] >> (2 * t)) & 3u;
      (seen_by ? seen_tiles_[size] : unseen_tiles_).push_back(static_cast<std::uint32_t>(i) << 4 | t << 2 | seen_by);
    }
  }
  tile_count_ = 0;
  for (const auto& tiles : seen_tiles_) tile_count_ += tiles.size();
}

void ExtractPass::run(std::size_t size, std::int64_t image, const SeenInputs& inputs, double depth_tolerance,
                      FrameGate* gate) {
  const auto& tiles = seen_tiles_[size];
  if (tiles.empty() && !prepares_) return;
  const gl::Program& program = extract_[kSizes * static_cast<std::size_t>(inputs.camera_count() - 1) + size];
  const bool levels = size + 1 == kSizes;
  for (int c = 0; levels && c < inputs.camera_count(); ++c) inputs.camera(c).build_levels();
  // Not by the texture's own filter: views look it up in the meantime.
  if (levels) SeenInputs::sample_images_by(by_levels_.name());
  inputs.bind(program, depth_tolerance);
  program.set("tile_count", static_cast<int>(tiles.size()));
  program.set("image_number", static_cast<int>(image));
  tiles_[size].assign(std::span<const std::uint32_t>(tiles));
  glBindTextureUnit(7, geometry_.texture());
  glBindTextureUnit(10, tiles_[size].texture());
  static constexpr const char* kKinds[kSizes] = {"tiles", "tiles of 2x2 taps", "tiles of 4x4 taps", "tiles of 8x8 taps",
                                                 "tiles of levels"};
  dispatch_slices(program, std::max<std::size_t>(program.groups(kInvocationsPerTile * tiles.size()), 1), gate,
                  kKinds[size]);
  if (levels) SeenInputs::sample_images_by(0);
}

void ExtractPass::extract(const Work& work, const SeenInputs& inputs, const AtlasStore& store, double depth_tolerance,
                          FrameGate* gate) {
  sort_tiles(work, inputs);
  if (work.jobs.empty()) return;
  jobs_.assign(work.jobs);
  geometry_.assign(work.geometry);
  holes_.reserve(4 * work.jobs.size() * sizeof(std::uint32_t));
  holes_.buffer().clear_to_zero();
  glBindTextureUnit(9, store.heights.name());
  glBindTextureUnit(11, store.colours->name());
  glBindImageTexture(0, store.colours->name(), 0, GL_TRUE, 0, GL_WRITE_ONLY, atlas::kStoredColourFormat);
  glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 0, holes_.buffer().name());
  for (std::size_t size = 0; size < kSizes; ++size) run(size, work.image, inputs, depth_tolerance, gate);
  prepares_ = false;
  next_slice(gate, "copied tiles");

  copy_tiles_.assign(std::span<const std::uint32_t>(unseen_tiles_));
  glBindTextureUnit(7, jobs_.texture());
  glBindTextureUnit(10, copy_tiles_.texture());
  dispatch_groups(copy_, unseen_tiles_.size());
  glMemoryBarrier(GL_TEXTURE_FETCH_BARRIER_BIT | GL_SHADER_IMAGE_ACCESS_BARRIER_BIT | GL_BUFFER_UPDATE_BARRIER_BIT);
}

std::vector<std::uint32_t> ExtractPass::read_holes(std::size_t jobs) const {
  std::vector<std::uint32_t> out(4 * jobs);
  if (!out.empty()) holes_.buffer().read(std::span(out));
  return out;
}

}  // namespace foresight
