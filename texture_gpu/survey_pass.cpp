#include "texture_gpu/survey_pass.hpp"

#include "texture_gpu/extract_pass.hpp"
#include "texture_gpu/shaders.hpp"

namespace foresight {
namespace {

gl::Program program(const char* file, std::span<const Lens> lenses, const std::vector<std::string>& more = {}) {
  auto defines = gl::camera_defines(lenses);
  defines.insert(defines.end(), more.begin(), more.end());
  return gl::Program::compute(gl::texture_gpu_shaders(), file, defines);
}

/// One answer for each invocation of the program, all of whose other inputs are bound: `buffer` gets them. `gate`: in
/// slices of `kind`; may be null.
template <typename Answer>
void ask(const gl::Program& program, const gl::Buffer& buffer, std::vector<Answer>& answers, FrameGate* gate = nullptr,
         const char* kind = nullptr) {
  glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 0, buffer.name());
  dispatch_slices(program, program.groups(answers.size()), gate, kind);
  glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
  buffer.read(std::span(answers));
}

}  // namespace

SurveyPass::SurveyPass(std::span<const Lens> lenses)
    : cull_(program("cull.comp", lenses)),
      exposure_(program("exposure.comp", lenses)),
      agreement_(program("agreement.comp", lenses)),
      perhaps_missed_(program("missed.comp", lenses, {"STEP 0"})),
      missed_(program("missed.comp", lenses, {"STEP 1"})),
      pages_(GL_RGBA32UI, 4096, "pages to survey"),
      asked_pages_(GL_RGBA32UI, 4096, "pages to compare"),
      tiles_(GL_R32UI, 4096, "tiles to survey"),
      geometry_(GL_RGBA32F, 4096, "geometry of pages to survey") {}

void SurveyPass::set_pages(std::span<const PageRecord> pages) {
  page_count_ = static_cast<int>(pages.size());
  pages_.assign(pages);
  const std::size_t mask_bytes = pages.size() * sizeof(std::uint32_t);
  if (masks_.bytes() < mask_bytes) masks_ = gl::Buffer(mask_bytes * 3 / 2, "page masks");
}

std::vector<std::uint32_t> SurveyPass::cull(const SeenInputs& inputs, const gl::BufferTexture& charts,
                                            double depth_tolerance, FrameGate* gate) {
  std::vector<std::uint32_t> masks(static_cast<std::size_t>(page_count_));
  if (masks.empty()) return masks;
  cull_.set("node_count", inputs.node_count());
  cull_.set("camera_count", inputs.camera_count());
  cull_.set("page_count", page_count_);
  cull_.set("depth_tolerance", static_cast<float>(depth_tolerance));
  glBindBufferBase(GL_UNIFORM_BUFFER, 0, inputs.blocks().name());
  glBindTextureUnit(0, inputs.node_poses());
  glBindTextureUnit(1, inputs.camera(0).blocks().name());
  glBindTextureUnit(2, inputs.camera(inputs.camera_count() - 1).blocks().name());
  glBindTextureUnit(3, pages_.texture());
  glBindTextureUnit(4, charts.texture());
  ask(cull_, masks_, masks, gate, "pages in view");
  return masks;
}

/// Of `tiles`, what `program` says of each, in slices of `kind`.
std::vector<std::uint32_t> SurveyPass::ask_tiles(const gl::Program& program, std::span<const std::uint32_t> tiles,
                                                 FrameGate* gate, const char* kind) {
  std::vector<std::uint32_t> answers(tiles.size());
  if (tiles.empty()) return answers;
  program.set("tile_count", static_cast<int>(tiles.size()));
  tiles_.assign(tiles);
  if (answers_.bytes() < tiles.size_bytes()) answers_ = gl::Buffer(tiles.size_bytes() * 3 / 2, "missed tiles");
  glBindTextureUnit(10, tiles_.texture());
  ask(program, answers_, answers, gate, kind);
  return answers;
}

SurveyPass::Missed SurveyPass::missed(const SeenInputs& inputs, std::span<const Eigen::Vector4f> geometry,
                                      const AtlasStore& store, std::span<const std::uint32_t> seen,
                                      double depth_tolerance, double worse, FrameGate* gate) {
  std::vector<std::size_t> pages;  // of which geometry tells
  std::vector<std::uint32_t> tiles, answers;
  for (std::size_t page = 0; page < seen.size(); ++page) {
    if (!seen[page]) continue;
    for (std::uint32_t tile = 0; tile < 4; ++tile)
      if (seen[page] >> (2 * tile) & 3u) tiles.push_back(static_cast<std::uint32_t>(pages.size()) << 2 | tile);
    pages.push_back(page);
  }
  geometry_.assign(geometry);
  for (const gl::Program* program : {&perhaps_missed_, &missed_}) {
    inputs.bind(*program, depth_tolerance);
    program->set("worse", static_cast<float>(worse));
    glBindTextureUnit(7, geometry_.texture());
    glBindTextureUnit(9, store.heights.name());
    glBindTextureUnit(11, inputs.camera(0).blocks().name());
    answers = ask_tiles(*program, tiles, gate, program == &missed_ ? "missed tiles" : "tiles perhaps missed");
    std::size_t kept = 0;
    for (std::size_t i = 0; i < tiles.size(); ++i) {
      if (!answers[i]) continue;
      tiles[kept] = tiles[i];
      answers[kept++] = answers[i];
    }
    tiles.resize(kept);
  }
  Missed out{std::vector<std::uint32_t>(seen.size()), std::vector<std::uint32_t>(seen.size()), {}};
  for (std::size_t i = 0; i < tiles.size(); ++i) {
    const std::size_t page = pages[tiles[i] >> 2];
    const std::uint32_t of_tile = seen[page] & 3u << (2 * (tiles[i] & 3u));
    if (answers[i] & 1u) out.masks[page] |= of_tile;
    if (answers[i] & 4u) out.hidden[page] |= of_tile;
    if (answers[i] & 2u && (out.coarser.empty() || out.coarser.back() != page)) out.coarser.push_back(page);
  }
  return out;
}

std::vector<ExposureSample> SurveyPass::brightness(const SeenInputs& inputs, const gl::BufferTexture& charts,
                                                   const AtlasStore& store, std::span<const PageRecord> pages,
                                                   int camera, double depth_tolerance) {
  std::vector<ExposureSample> samples(pages.size());
  if (samples.empty()) return samples;
  inputs.bind(exposure_, depth_tolerance);
  exposure_.set("camera", camera);
  bind_pages(exposure_, charts, store, pages);
  ask(exposure_, samples_, samples);
  return samples;
}

std::vector<AgreementSample> SurveyPass::agreement(const SeenInputs& inputs, const gl::BufferTexture& charts,
                                                   const AtlasStore& store, std::span<const PageRecord> pages,
                                                   const PublishedTextures& textures, double depth_tolerance) {
  std::vector<AgreementSample> samples(pages.size());
  if (samples.empty()) return samples;
  inputs.bind(agreement_, depth_tolerance);
  bind_pages(agreement_, charts, store, pages);
  textures.bind();
  ask(agreement_, samples_, samples);
  return samples;
}

/// And makes room for a sample of each.
void SurveyPass::bind_pages(const gl::Program& program, const gl::BufferTexture& charts, const AtlasStore& store,
                            std::span<const PageRecord> pages) {
  const std::size_t sample_bytes = pages.size() * sizeof(ExposureSample);
  static_assert(sizeof(AgreementSample) <= sizeof(ExposureSample), "samples_ has room for either");
  if (samples_.bytes() < sample_bytes) samples_ = gl::Buffer(sample_bytes * 3 / 2, "page brightness");
  asked_pages_.assign(pages);
  program.set("page_count", static_cast<int>(pages.size()));
  glBindTextureUnit(7, asked_pages_.texture());
  glBindTextureUnit(8, charts.texture());
  glBindTextureUnit(9, store.heights.name());
}

}  // namespace foresight
