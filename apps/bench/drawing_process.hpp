// A process of its own that draws what this one shows.
#pragma once

#include <sys/types.h>

#include <optional>
#include <string>

#include "display/head/view_share.hpp"
#include "scene/run_folder.hpp"

namespace foresight {

/// Has a run's first images as textures, takes in further ones at 5 Hz but for a pause, and draws views. Made before
/// this process has threads or a context.
class DrawingProcess {
 public:
  /// Begins with the first aim. `most_pixels`: of an eye's view. Throws RuntimeFailure.
  DrawingProcess(const RunFolder& run, std::size_t most_pixels);
  ~DrawingProcess();
  DrawingProcess(const DrawingProcess&) = delete;
  DrawingProcess& operator=(const DrawingProcess&) = delete;

  head::ViewShare& share() { return share_; }
  /// "" while it runs; else how it ended. What it threw it has said itself.
  std::string failure();
  /// What it does now, or did last, in words.
  std::string doing() const;

 private:
  head::ViewShare share_;
  pid_t pid_;
  std::optional<std::string> end_;
};

}  // namespace foresight
