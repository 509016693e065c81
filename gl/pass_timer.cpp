#include "gl/pass_timer.hpp"

namespace foresight::gl {
namespace {

Query create_timestamp() {
  GLuint name = 0;
  glCreateQueries(GL_TIMESTAMP, 1, &name);
  return Query(name);
}

}  // namespace

PassTimer::PassTimer(bool is_software) : is_software_(is_software) {
  if (is_software) return;
  first_ = create_timestamp();
  last_ = create_timestamp();
}

bool PassTimer::begin() {
  if (waiting_) return false;
  running_ = true;
  if (is_software_)
    began_ = std::chrono::steady_clock::now();
  else
    glQueryCounter(first_.name(), GL_TIMESTAMP);
  return true;
}

void PassTimer::end() {
  if (!running_) return;
  running_ = false;
  if (is_software_) {
    glFinish();
    ms_ = std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - began_).count();
    return;
  }
  glQueryCounter(last_.name(), GL_TIMESTAMP);
  waiting_ = true;
}

std::optional<double> PassTimer::take() {
  if (waiting_) {
    GLint is_there = 0;
    glGetQueryObjectiv(last_.name(), GL_QUERY_RESULT_AVAILABLE, &is_there);
    if (!is_there) return std::nullopt;
    GLuint64 from = 0, to = 0;
    glGetQueryObjectui64v(first_.name(), GL_QUERY_RESULT, &from);
    glGetQueryObjectui64v(last_.name(), GL_QUERY_RESULT, &to);
    waiting_ = false;
    ms_ = static_cast<double>(to - from) * 1e-6;
  }
  return std::exchange(ms_, std::nullopt);
}

}  // namespace foresight::gl
