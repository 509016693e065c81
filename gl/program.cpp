#include "gl/program.hpp"

#include <algorithm>
#include <cstddef>
#include <sstream>

#include "common/error.hpp"
#include "gl/early_uniforms.hpp"
#include "gl/kept_programs.hpp"

namespace foresight::gl {

void delete_program(GLuint name) {
  if (KeptPrograms* store = KeptPrograms::in_use(); store && store->keep(name)) return;
  glDeleteProgram(name);
}

namespace {

const std::string& find_source(const ShaderSources& sources, const std::string& file) {
  if (const auto it = sources.find(file); it != sources.end()) return it->second;
  if (const auto it = gl_shaders().find(file); it != gl_shaders().end()) return it->second;
  throw RuntimeFailure("the shader " + file + " is not embedded", "add it to SHADERS in its CMakeLists.txt");
}

void append_expanded(const ShaderSources& sources, const std::string& file, std::string& out) {
  std::istringstream lines(find_source(sources, file));
  for (std::string line; std::getline(lines, line);) {
    constexpr std::string_view kInclude = "#include \"";
    if (line.starts_with(kInclude))
      append_expanded(sources, line.substr(kInclude.size(), line.rfind('"') - kInclude.size()), out);
    else
      out += line + "\n";
  }
}

/// `get`: glGetShaderInfoLog or glGetProgramInfoLog.
template <typename Get>
std::string info_log(GLuint name, Get get) {
  std::string log(4096, '\0');
  GLsizei length = 0;
  get(name, static_cast<GLsizei>(log.size()), &length, log.data());
  log.resize(static_cast<std::size_t>(length));
  return log;
}

struct Stage {
  GLenum stage;
  std::string file, text;
};

Stage read_stage(const ShaderSources& sources, GLenum stage, const std::string& file,
                 const std::vector<std::string>& defines) {
  Stage out{stage, file, "#version 450 core\n"};
  for (const std::string& define : defines) out.text += "#define " + define + "\n";
  append_expanded(sources, file, out.text);
  if (stage == GL_COMPUTE_SHADER) out.text = with_early_uniforms(out.text);
  return out;
}

GLuint compile(const Stage& stage) {
  const GLuint shader = glCreateShader(stage.stage);
  const char* pointer = stage.text.c_str();
  glShaderSource(shader, 1, &pointer, nullptr);
  glCompileShader(shader);
  GLint ok = 0;
  glGetShaderiv(shader, GL_COMPILE_STATUS, &ok);
  if (ok) return shader;
  const std::string log = info_log(shader, glGetShaderInfoLog);
  glDeleteShader(shader);
  throw RuntimeFailure("shader " + stage.file + " does not compile: " + log,
                       "please report this with the driver's name");
}

/// Made anew from its binary, where the driver has one. What Mesa's compiler leaves with a program is a sixth of a
/// megabyte, which a software renderer takes from the process; the binary holds none of it.
GLuint without_leftovers(GLuint program) {
  GLint length = 0;
  glGetProgramiv(program, GL_PROGRAM_BINARY_LENGTH, &length);
  if (length <= 0) return program;
  std::vector<std::byte> binary(static_cast<std::size_t>(length));
  GLenum format = 0;
  glGetProgramBinary(program, length, &length, &format, binary.data());
  const GLuint anew = glCreateProgram();
  glProgramBinary(anew, format, binary.data(), length);
  GLint ok = 0;
  glGetProgramiv(anew, GL_LINK_STATUS, &ok);
  glDeleteProgram(ok ? program : anew);
  return ok ? anew : program;
}

GLuint link(const std::vector<GLuint>& shaders, const std::string& label) {
  GLuint program = glCreateProgram();
  glProgramParameteri(program, GL_PROGRAM_BINARY_RETRIEVABLE_HINT, GL_TRUE);
  for (GLuint shader : shaders) glAttachShader(program, shader);
  glLinkProgram(program);
  for (GLuint shader : shaders) {
    glDetachShader(program, shader);
    glDeleteShader(shader);
  }
  GLint ok = 0;
  glGetProgramiv(program, GL_LINK_STATUS, &ok);
  if (ok) program = without_leftovers(program);
  glReleaseShaderCompiler();  // Mesa's holds 5 MB of built-in functions, and is there again when it is needed
  glObjectLabel(GL_PROGRAM, program, -1, label.c_str());
  if (ok) return program;
  const std::string log = info_log(program, glGetProgramInfoLog);
  glDeleteProgram(program);
  throw RuntimeFailure("program " + label + " does not link: " + log, "please report this with the driver's name");
}

GLuint make_program(const std::vector<Stage>& stages) {
  KeptPrograms* store = KeptPrograms::in_use();
  std::string text;
  for (const Stage& stage : stages) text += stage.text;
  if (store)
    if (const auto kept = store->take(text)) return *kept;
  std::vector<GLuint> shaders;
  for (const Stage& stage : stages) shaders.push_back(compile(stage));
  const GLuint program = link(shaders, stages.back().file);
  if (store) store->made(program, text);
  return program;
}

GLint location(const Program& program, const char* uniform) {
  const GLint early = glGetUniformLocation(program.name(), (std::string(uniform) + kAsGiven).c_str());
  return early >= 0 ? early : glGetUniformLocation(program.name(), uniform);
}

}  // namespace

Program Program::compute(const ShaderSources& sources, const std::string& file,
                         const std::vector<std::string>& defines) {
  Program out(make_program({read_stage(sources, GL_COMPUTE_SHADER, file, defines)}));
  std::array<GLint, 3> group{};
  glGetProgramiv(out.name(), GL_COMPUTE_WORK_GROUP_SIZE, group.data());
  std::ranges::copy(group, out.group_.begin());
  return out;
}

Program Program::graphics(const ShaderSources& sources, const std::string& vertex, const std::string& fragment,
                          const std::vector<std::string>& defines) {
  return Program(make_program({read_stage(sources, GL_VERTEX_SHADER, vertex, defines),
                               read_stage(sources, GL_FRAGMENT_SHADER, fragment, defines)}));
}

void Program::dispatch(int across, int down, int deep) const {
  const auto groups = [](int invocations, GLuint group) {
    return (static_cast<GLuint>(invocations) + group - 1) / group;
  };
  use();
  glDispatchCompute(groups(across, group_[0]), groups(down, group_[1]), groups(deep, group_[2]));
}

std::size_t Program::groups(std::size_t count) const {
  return (count + invocations() - 1) / invocations();
}

void Program::set(const char* uniform, int value) const {
  glProgramUniform1i(name(), location(*this, uniform), value);
}
void Program::set(const char* uniform, unsigned value) const {
  glProgramUniform1ui(name(), location(*this, uniform), value);
}
void Program::set(const char* uniform, float value) const {
  glProgramUniform1f(name(), location(*this, uniform), value);
}
void Program::set(const char* uniform, const Eigen::Vector2f& v) const {
  glProgramUniform2f(name(), location(*this, uniform), v.x(), v.y());
}
void Program::set(const char* uniform, const Eigen::Vector3f& v) const {
  glProgramUniform3f(name(), location(*this, uniform), v.x(), v.y(), v.z());
}
void Program::set(const char* uniform, const Eigen::Vector4f& v) const {
  glProgramUniform4f(name(), location(*this, uniform), v.x(), v.y(), v.z(), v.w());
}
void Program::set(const char* uniform, const Eigen::Vector2i& v) const {
  glProgramUniform2i(name(), location(*this, uniform), v.x(), v.y());
}
void Program::set(const char* uniform, const Eigen::Matrix4f& m) const {
  glProgramUniformMatrix4fv(name(), location(*this, uniform), 1, GL_FALSE, m.data());
}

}  // namespace foresight::gl
