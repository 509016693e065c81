// Measures what each stage of the extraction costs.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "gl/objects.hpp"

namespace foresight {

struct StageCost {
  std::string name;
  double cpu_ms = 0;             ///< CPU time of the whole process: software renderers work in threads of their own
  std::optional<double> gpu_ms;  ///< only where the GPU is one
};

/// Marks stage borders within one image. On a software renderer each mark waits for the commands
/// so far, so that their CPU time lands in the right stage; on a GPU it only records a timestamp,
/// which read() fetches after the image's fence. Belongs to one context.
class StageClock {
 public:
  explicit StageClock(bool software_renderer) : software_(software_renderer) {}

  void start();
  /// Ends the stage that began at the previous mark (or start(), resume()).
  void mark(const char* stage);
  /// What passed since the previous mark counts for no stage.
  void resume() { record(nullptr); }
  /// Call after the fence of the image has passed.
  std::vector<StageCost> read();

 private:
  struct Mark {
    const char* stage;
    double cpu_ms;
    GLuint query;
  };
  void record(const char* stage);

  bool software_;
  std::vector<Mark> marks_;
  std::vector<gl::Query> queries_;
};

/// CPU time that all threads of this process have used, in milliseconds.
double process_cpu_ms();

}  // namespace foresight
