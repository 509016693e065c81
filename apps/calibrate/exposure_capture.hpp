// Pictures of what stands still, at one exposure time after the other, as `calibrate photometric` takes them.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "apps/calibrate/capture_source.hpp"

namespace foresight {

/// Cameras of which a picture can be had at any exposure time. One thread.
class ExposedCameras {
 public:
  virtual ~ExposedCameras() = default;
  /// Taken at `exposure`, whole, after whatever was taken before. Blocks. Throws InputError where the cameras do not do
  /// it, RuntimeFailure where no picture comes.
  virtual CaptureImages take(Duration exposure) = 0;
};

/// Real ones: opened anew for each exposure time by `open`, since few drivers change it at an exact picture. The first
/// pictures are not taken: cameras need some to settle.
std::unique_ptr<ExposedCameras> reopened_cameras(std::function<std::unique_ptr<CaptureSource>(Duration)> open,
                                                 const Clock& clock);

/// Both of the mock lab, in stepped time. `clock`: that which they were opened with; it must outlive the result.
std::unique_ptr<ExposedCameras> exposed_mock_cameras(OpenStereo opened, SteppedClock& clock);

struct ExposureSeries {
  std::filesystem::path out;
  std::vector<Duration> exposures;  ///< in the order in which they are taken
  bool stereo = true;
};

/// As --exposures has them. Throws InputError: fewer than 3, two alike, one that is no whole number of 0.1 ms (what
/// V4L2 counts in) or beyond `longest`, all within a factor of 2.
std::vector<Duration> exposure_times(const std::vector<double>& seconds, Duration longest);

/// Writes OUT/left/exposure01.png and so on, OUT/right/ (of a lone camera OUT/exposure01.png) and OUT/exposures.txt,
/// and says on stderr how it goes. False: SIGINT or SIGTERM ended it; what was taken stays. Throws what take() throws,
/// and RuntimeFailure where it cannot write.
bool take_exposure_series(ExposedCameras& cameras, const ExposureSeries& series);

}  // namespace foresight
