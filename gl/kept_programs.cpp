#include "gl/kept_programs.hpp"

#include <utility>

namespace foresight::gl {
namespace {

thread_local KeptPrograms* g_in_use = nullptr;

}  // namespace

KeptPrograms::Use::Use(KeptPrograms& store) : before_(std::exchange(g_in_use, &store)) {}

KeptPrograms::Use::~Use() {
  g_in_use = before_;
}

KeptPrograms::~KeptPrograms() {
  for (const auto& [sources, programs] : spares_)
    for (const GLuint program : programs) glDeleteProgram(program);
}

KeptPrograms* KeptPrograms::in_use() {
  return g_in_use;
}

std::optional<GLuint> KeptPrograms::take(const std::string& sources) {
  const auto spares = spares_.find(sources);
  if (spares == spares_.end() || spares->second.empty()) return std::nullopt;
  const GLuint program = spares->second.back();
  spares->second.pop_back();
  made(program, sources);
  return program;
}

bool KeptPrograms::keep(GLuint program) {
  auto made = sources_.extract(program);
  if (!made) return false;
  spares_[made.mapped()].push_back(program);
  return true;
}

}  // namespace foresight::gl
