// Where `calibrate capture` has its images from: two cameras, a lone one, or folders.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "rig/open_stereo.hpp"

namespace foresight {

struct CaptureImages {
  cv::Mat left, right;  ///< 8 bit, colours; right is empty of a lone camera. Shared: nobody writes into them
};

/// One thread.
class CaptureSource {
 public:
  virtual ~CaptureSource() = default;
  virtual void start() = 0;  ///< throws what Camera::start() throws
  virtual void stop() noexcept = 0;
  /// Of cameras the newest images not yet taken; of folders the next ones. Waits `timeout` at most.
  virtual std::optional<CaptureImages> take(Duration timeout) = 0;
  virtual std::string silent_because() const = 0;  ///< in words; "" where nothing is wrong
  /// Stills: each image counts, and take() gives it only once. False: a film, whose newest image counts.
  virtual bool stills() const { return false; }
  virtual bool at_end() const { return false; }  ///< nothing more will come
};

std::unique_ptr<CaptureSource> pair_source(OpenStereo opened);
/// Mock cameras in stepped time: take() moves `clock`, which they were opened with, and which must outlive the source.
std::unique_ptr<CaptureSource> stepped_source(OpenStereo opened, SteppedClock& clock);
std::unique_ptr<CaptureSource> lone_source(std::unique_ptr<Camera> camera);

/// Of one folder, or of two whose images belong together (list_pairs). Throws InputError.
std::unique_ptr<CaptureSource> folder_source(const std::vector<std::string>& folders);

}  // namespace foresight
