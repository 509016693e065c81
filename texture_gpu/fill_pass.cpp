#include "texture_gpu/fill_pass.hpp"

#include "texture_gpu/atlas_layout.hpp"
#include "texture_gpu/frame_gate.hpp"
#include "texture_gpu/shaders.hpp"

namespace foresight {
namespace {

// Each round carries colours one chart farther into what was never seen; later images continue.
constexpr int kSpreadRounds = 4;
// Images within which filled texels follow the colours around them.
constexpr int kRefresh = 8;

gl::Program compute(const char* file) {
  return gl::Program::compute(gl::texture_gpu_shaders(), file);
}
gl::Program pull_program(int level) {
  return gl::Program::compute(gl::texture_gpu_shaders(), "pull.comp", {"LEVEL " + std::to_string(level)});
}

gl::Program hole_program(int tiles) {
  return gl::Program::compute(gl::texture_gpu_shaders(), "hole_jobs.comp", {"TILES " + std::to_string(tiles)});
}

void bind_level(GLuint unit, const gl::Texture& colours, int level, GLenum access) {
  const GLenum format = access == GL_READ_ONLY ? atlas::kColourFormat : atlas::kStoredColourFormat;
  glBindImageTexture(unit, colours.name(), level, GL_TRUE, 0, access, format);
}

}  // namespace

FillPass::FillPass(const SurfacePatches& surface)
    : push_(compute("push.comp")),
      push_rest_(compute("push_rest.comp")),
      coarse_(compute("coarse.comp")),
      coarse_fill_(compute("coarse_fill.comp")),
      spread_(compute("spread.comp")),
      hole_jobs_(hole_program(0)),
      hole_tiles_(hole_program(1)),
      pull_{pull_program(0), pull_program(1), pull_program(2), pull_program(3)},
      neighbour_start_(GL_R32UI, 16, "neighbour starts"),
      neighbours_(GL_R32UI, 16, "neighbours"),
      dirty_(GL_R32UI, 16, "dirty charts"),
      chart_of_page_(GL_R32UI, 16, "charts of pages"),
      spare_means_(atlas::kMeanFormat, surface.charts.size() * atlas::kMeanBytes, "spare chart means"),
      with_holes_("pages or tiles with holes"),
      empty_pages_("pages without colour"),
      chart_count_(static_cast<int>(surface.charts.size())) {
  std::vector<std::uint32_t> start{0}, list;
  for (const Chart& chart : surface.charts) {
    list.insert(list.end(), chart.neighbours.begin(), chart.neighbours.end());
    start.push_back(static_cast<std::uint32_t>(list.size()));
  }
  neighbour_start_.assign(std::span<const std::uint32_t>(start));
  neighbours_.assign(std::span<const std::uint32_t>(list));
}

void FillPass::operator()(const ExtractPass& extracted, const Work& work, const AtlasStore& store,
                          const PublishedTextures& previous, PublishedTextures& next, FrameGate* gate) {
  glBindTextureUnit(7, extracted.jobs().texture());
  push(work.job_count, store);
  next_slice(gate, "means");
  means(work, store, previous, next);
  next_slice(gate, "spread");
  spread(next);
  next_slice(gate, "pull");
  glBindTextureUnit(7, extracted.jobs().texture());
  pull(work.job_count, extracted.holes(), store, next);
  turn_ = (turn_ + 1) % kRefresh;
}

void FillPass::push(std::size_t job_count, const AtlasStore& store) const {
  if (job_count == 0) return;
  glBindTextureUnit(11, store.colours->name());
  bind_level(0, *store.colours, 1, GL_WRITE_ONLY);
  dispatch_groups(push_, job_count);
  glMemoryBarrier(GL_TEXTURE_FETCH_BARRIER_BIT);
  push_rest_.set("job_count", static_cast<int>(job_count));
  for (int level = 2; level <= 4; ++level)
    bind_level(static_cast<GLuint>(level - 2), *store.colours, level, GL_WRITE_ONLY);
  push_rest_.dispatch(static_cast<int>(job_count));
  glMemoryBarrier(GL_TEXTURE_FETCH_BARRIER_BIT | GL_SHADER_IMAGE_ACCESS_BARRIER_BIT);
}

void FillPass::means(const Work& work, const AtlasStore& store, const PublishedTextures& previous,
                     PublishedTextures& next) {
  constexpr auto kEntry = static_cast<GLintptr>(atlas::kMeanBytes);
  glCopyNamedBufferSubData(previous.means.buffer().name(), next.means.buffer().name(), 0, 0, chart_count_ * kEntry);
  for (const auto& [before, now, count] : work.kept)
    glCopyNamedBufferSubData(previous.coarse.buffer().name(), next.coarse.buffer().name(), before * kEntry,
                             now * kEntry, count * kEntry);
  if (work.dirty.empty()) return;
  dirty_.assign(work.dirty);
  chart_of_page_.assign(work.chart_of_page);
  glBindTextureUnit(7, dirty_.texture());
  glBindTextureUnit(8, next.charts.texture());
  glBindTextureUnit(9, next.table.texture());
  glBindTextureUnit(11, store.colours->name());
  glBindImageTexture(0, next.coarse.texture(), 0, GL_FALSE, 0, GL_WRITE_ONLY, atlas::kMeanFormat);
  glBindImageTexture(1, next.means.texture(), 0, GL_FALSE, 0, GL_WRITE_ONLY, atlas::kMeanFormat);
  empty_pages_.start(work.chart_of_page.size());
  dispatch_groups(coarse_, work.dirty.size());
  empty_pages_.finish(coarse_fill_);
  glMemoryBarrier(GL_SHADER_IMAGE_ACCESS_BARRIER_BIT);  // both passes store into the coarse colours

  glBindTextureUnit(7, chart_of_page_.texture());
  glBindTextureUnit(10, next.means.texture());
  empty_pages_.dispatch(coarse_fill_);
  // Fetched by what follows, and copied when the next generation starts from this one.
  glMemoryBarrier(GL_TEXTURE_FETCH_BARRIER_BIT | GL_BUFFER_UPDATE_BARRIER_BIT);
}

/// Hands chart means on to charts that were never seen.
void FillPass::spread(const PublishedTextures& next) const {
  spread_.set("chart_count", chart_count_);
  glBindTextureUnit(7, neighbour_start_.texture());
  glBindTextureUnit(8, neighbours_.texture());
  const gl::BufferTexture* from = &next.means;
  const gl::BufferTexture* to = &spare_means_;
  for (int round = 0; round < kSpreadRounds; ++round, std::swap(from, to)) {  // even: ends in next.means
    glBindTextureUnit(9, from->texture());
    glBindImageTexture(0, to->texture(), 0, GL_FALSE, 0, GL_WRITE_ONLY, atlas::kMeanFormat);
    spread_.dispatch(chart_count_);
    glMemoryBarrier(GL_TEXTURE_FETCH_BARRIER_BIT | GL_BUFFER_UPDATE_BARRIER_BIT);
  }
}

void FillPass::list_holes(const gl::Program& program, std::size_t job_count, std::size_t most,
                          const gl::BufferTexture& holes, const AtlasStore& store) {
  program.set("job_count", static_cast<int>(job_count));
  program.set("turn", turn_);
  program.set("refresh", kRefresh);
  glBindTextureUnit(10, holes.texture());
  glBindTextureUnit(11, store.colours->name());
  with_holes_.start(most);
  program.dispatch(static_cast<int>(most));
  with_holes_.finish_for_groups();
}

void FillPass::pull(std::size_t job_count, const gl::BufferTexture& holes, const AtlasStore& store,
                    const PublishedTextures& next) {
  if (job_count == 0) return;
  list_holes(hole_jobs_, job_count, job_count, holes, store);
  glBindTextureUnit(8, next.charts.texture());
  glBindTextureUnit(9, next.table.texture());
  glBindTextureUnit(14, next.coarse.texture());
  for (int level = 3; level >= 0; --level) {
    if (level == 0) list_holes(hole_tiles_, job_count, 4 * job_count, holes, store);
    bind_level(0, *store.colours, level, GL_READ_WRITE);
    bind_level(1, *store.colours, level + 1, GL_READ_ONLY);
    with_holes_.dispatch(pull_[static_cast<std::size_t>(level)]);
    glMemoryBarrier(GL_SHADER_IMAGE_ACCESS_BARRIER_BIT | GL_TEXTURE_FETCH_BARRIER_BIT);
  }
}

}  // namespace foresight
