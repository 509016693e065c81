// Shader programs from the files that lie beside their passes.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <initializer_list>
#include <map>
#include <string>
#include <vector>

#include "gl/objects.hpp"

namespace foresight::gl {

/// File name to text, embedded at build time (cmake/ForesightModule.cmake).
using ShaderSources = std::map<std::string, std::string>;

const ShaderSources& gl_shaders();

void delete_program(GLuint name);

/// A linked program. A line `#include "file"` in a shader is replaced by that file's text.
class Program : public Handle<delete_program> {
 public:
  Program() = default;

  /// Compile and link; `defines` ("NAME value") come right after the #version line. Throws
  /// RuntimeFailure with the driver's log and the file's name.
  static Program compute(const ShaderSources& sources, const std::string& file,
                         const std::vector<std::string>& defines = {});
  static Program graphics(const ShaderSources& sources, const std::string& vertex, const std::string& fragment,
                          const std::vector<std::string>& defines = {});

  void use() const { glUseProgram(name()); }

  /// Uses and runs a compute program: whole groups of it, so many that there are `across` x `down` x `deep`
  /// invocations. Those beyond are left out by the shader.
  void dispatch(int across, int down = 1, int deep = 1) const;

  /// Of a compute program: groups that have so many invocations.
  std::size_t groups(std::size_t count) const;
  /// Of a compute program: of each group.
  std::size_t invocations() const { return std::size_t{group_[0]} * group_[1] * group_[2]; }

  /// Set a uniform by name. Unknown names are ignored: the compiler drops unused uniforms.
  void set(const char* uniform, int value) const;
  void set(const char* uniform, unsigned value) const;
  void set(const char* uniform, float value) const;
  void set(const char* uniform, const Eigen::Vector2f& value) const;
  void set(const char* uniform, const Eigen::Vector3f& value) const;
  void set(const char* uniform, const Eigen::Vector4f& value) const;
  void set(const char* uniform, const Eigen::Vector2i& value) const;
  void set(const char* uniform, const Eigen::Matrix4f& value) const;

 private:
  explicit Program(GLuint name) : Handle<delete_program>(name) {}

  std::array<GLuint, 3> group_{};  // invocations along x, y, z, as the shader has them: asked once
};

}  // namespace foresight::gl
