// Runs that the tests of the program replay.
#pragma once

#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>

#include "tests/scene/test_run.hpp"

namespace foresight {

/// A copy of a small synthetic run: 96 x 72, 8 images, 30 per second, a moving arm.
class SmallRun : public TempFolder {
 public:
  /// `option`: one more of `foresight synth`, such as "--stereo".
  explicit SmallRun(const std::string& option = {});

  /// Reads, changes and writes each image of the left camera.
  void change_images(const std::function<cv::Mat(const cv::Mat&)>& change) const;
  /// Keeps only the first `count` lines with data of `list`.
  void keep(const std::string& list, int count) const;
};

/// That run forwards and backwards again and again, `interval_s` between two images.
class LoopedRun : public TempFolder {
 public:
  LoopedRun(int images, double interval_s);
};

/// The rig configs/NAME with images of `size` ("160, 120"), `rate_hz` of them a second: drawing them, and lighting and
/// painting the lab as finely as they show it, is most of the work and not what is tested. Written into `folder` with
/// what it refers to.
std::string small_rig(const std::string& name, const TempFolder& folder, const std::string& size = "160, 120",
                      int rate_hz = 5);

nlohmann::json read_json(const std::filesystem::path& file);

/// `report` without what differs from run to run: times.
nlohmann::json without_times(nlohmann::json report);

/// Names of the files in `folder`, sorted.
std::vector<std::string> names_in(const std::filesystem::path& folder);

}  // namespace foresight
