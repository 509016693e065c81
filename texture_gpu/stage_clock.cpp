#include "texture_gpu/stage_clock.hpp"

#include "common/cpu_time.hpp"

namespace foresight {

double process_cpu_ms() {
  return 1e3 * cpu_seconds(CLOCK_PROCESS_CPUTIME_ID);
}

void StageClock::record(const char* stage) {
  GLuint query = 0;
  if (software_) {
    glFinish();
  } else {
    if (queries_.size() <= marks_.size()) {
      GLuint name = 0;
      glCreateQueries(GL_TIMESTAMP, 1, &name);
      queries_.emplace_back(name);
    }
    query = queries_[marks_.size()].name();
    glQueryCounter(query, GL_TIMESTAMP);
  }
  marks_.push_back({stage, process_cpu_ms(), query});
}

void StageClock::start() {
  marks_.clear();
  record("");
}

void StageClock::mark(const char* stage) {
  record(stage);
}

std::vector<StageCost> StageClock::read() {
  std::vector<StageCost> out;
  const auto gpu_ns = [](GLuint query) {
    GLuint64 ns = 0;
    glGetQueryObjectui64v(query, GL_QUERY_RESULT, &ns);
    return static_cast<double>(ns);
  };
  for (std::size_t i = 1; i < marks_.size(); ++i) {
    if (!marks_[i].stage) continue;
    StageCost time{marks_[i].stage, marks_[i].cpu_ms - marks_[i - 1].cpu_ms, std::nullopt};
    if (!software_) time.gpu_ms = (gpu_ns(marks_[i].query) - gpu_ns(marks_[i - 1].query)) * 1e-6;
    bool merged = false;
    for (StageCost& earlier : out) {
      if (earlier.name != time.name) continue;
      earlier.cpu_ms += time.cpu_ms;
      if (time.gpu_ms) earlier.gpu_ms = earlier.gpu_ms.value_or(0) + *time.gpu_ms;
      merged = true;
    }
    if (!merged) out.push_back(std::move(time));
  }
  return out;
}

}  // namespace foresight
