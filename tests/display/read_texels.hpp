// Texels of a samplerBuffer.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "gl/objects.hpp"

namespace foresight {

/// The first `count` of an RGBA32F buffer texture. Waits for the GPU.
inline std::vector<Eigen::Vector4d> read_texels(GLuint texture, std::size_t count) {
  GLint buffer = 0;
  glGetTextureLevelParameteriv(texture, 0, GL_TEXTURE_BUFFER_DATA_STORE_BINDING, &buffer);
  std::vector<Eigen::Vector4f> rows(count);
  glGetNamedBufferSubData(static_cast<GLuint>(buffer), 0, static_cast<GLsizeiptr>(count * 16), rows.data());
  std::vector<Eigen::Vector4d> out;
  for (const auto& row : rows) out.push_back(row.cast<double>());
  return out;
}

}  // namespace foresight
