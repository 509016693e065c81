#include "texture_gpu/witness_pass.hpp"

#include "texture_gpu/shaders.hpp"

namespace foresight {

WitnessPass::WitnessPass()
    : program_(gl::Program::compute(gl::texture_gpu_shaders(), "witness.comp")),
      witnesses_(GL_RGBA32F, 2 * sizeof(Eigen::Vector4f), "witnesses of the lamp") {}

void WitnessPass::set_witnesses(std::span<const Witness> witnesses) {
  std::vector<Eigen::Vector4f> rows;
  for (const Witness& w : witnesses) {
    rows.push_back(w.point.homogeneous());
    rows.push_back(w.normal.homogeneous());
  }
  witnesses_.assign(std::span<const Eigen::Vector4f>(rows));
  count_ = static_cast<int>(witnesses.size());
  values_ = gl::Buffer(witnesses.size() * sizeof(Eigen::Vector4f), "brightness of witnesses");
}

std::vector<Eigen::Vector3f> WitnessPass::brightness(const SeenInputs& inputs, const Pose& T_world_camera,
                                                     double depth_tolerance) {
  std::vector<Eigen::Vector4f> values(static_cast<std::size_t>(count_));
  if (values.empty()) return {};
  inputs.bind(program_, depth_tolerance);
  program_.set("witness_count", count_);
  program_.set("T_camera_world", T_world_camera.inverse().matrix().cast<float>().eval());
  glBindTextureUnit(7, witnesses_.texture());
  glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 0, values_.name());
  program_.dispatch(count_);
  glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
  values_.read(std::span(values));
  std::vector<Eigen::Vector3f> out;
  for (const Eigen::Vector4f& v : values) out.push_back(v.head<3>());
  return out;
}

}  // namespace foresight
