#include "texture_gpu/survey_pass.hpp"

#include "texture_gpu/shaders.hpp"

namespace foresight {

SurveyPass::SurveyPass()
    : cull_(gl::Program::compute(gl::texture_gpu_shaders(), "cull.comp")),
      exposure_(gl::Program::compute(gl::texture_gpu_shaders(), "exposure.comp")),
      pages_(GL_RGBA32UI, 4096, "pages to survey") {}

void SurveyPass::set_pages(std::span<const PageRecord> pages) {
  page_count_ = static_cast<int>(pages.size());
  pages_.assign(pages);
  const std::size_t mask_bytes = pages.size() * sizeof(std::uint32_t),
                    sample_bytes = pages.size() * sizeof(ExposureSample);
  if (masks_.bytes() < mask_bytes) masks_ = gl::Buffer(mask_bytes * 3 / 2, "page masks");
  if (samples_.bytes() < sample_bytes) samples_ = gl::Buffer(sample_bytes * 3 / 2, "page brightness");
}

std::vector<std::uint32_t> SurveyPass::cull(const SeenInputs& inputs, const gl::BufferTexture& charts,
                                            double depth_tolerance) {
  std::vector<std::uint32_t> masks(static_cast<std::size_t>(page_count_));
  if (masks.empty()) return masks;
  cull_.use();
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
  glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 0, masks_.name());
  glDispatchCompute(gl::groups(page_count_, 64), 1, 1);
  glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
  masks_.read(std::span(masks));
  return masks;
}

std::vector<ExposureSample> SurveyPass::brightness(const SeenInputs& inputs, const gl::BufferTexture& charts,
                                                   const AtlasStore& store, int camera, double depth_tolerance,
                                                   int first, int stride) {
  const int count = first < page_count_ ? (page_count_ - first + stride - 1) / stride : 0;
  std::vector<ExposureSample> samples(static_cast<std::size_t>(count));
  if (samples.empty()) return samples;
  inputs.bind(exposure_, depth_tolerance);
  exposure_.set("page_count", page_count_);
  exposure_.set("camera", camera);
  exposure_.set("first_page", first);
  exposure_.set("stride", stride);
  glBindTextureUnit(7, pages_.texture());
  glBindTextureUnit(8, charts.texture());
  glBindTextureUnit(9, store.heights.name());
  glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 0, samples_.name());
  glDispatchCompute(gl::groups(count, 64), 1, 1);
  glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
  samples_.read(std::span(samples));
  return samples;
}

}  // namespace foresight
