// AprilTags in live images.
#pragma once

#include <memory>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

namespace foresight {

struct DetectedTag {
  int id = 0;
  std::array<Eigen::Vector2d, 4>
      corners;        ///< px, pixel centres at integers; lower left, lower right, upper right, upper left of the print
  double margin = 0;  ///< decision margin of libapriltag, 8-bit values
};

/// libapriltag 3.3 with what suits images that come 30 times a second. One thread.
class TagDetector {
 public:
  struct Options {
    std::string family = "tag36h11";
    double decimate = 2;        ///< quads are looked for in an image so many times smaller; corners in the whole one
    double least_margin = 25;   ///< weaker detections are dropped
    double least_side_px = 12;  ///< smaller tags are dropped: their corners are worth little
  };

  /// Throws InputError for a family that libapriltag does not have.
  explicit TagDetector(const Options& options);
  ~TagDetector();

  /// Tags of `grey` (CV_8UC1); one that is found twice or touches the border is left out. Ascending by id.
  std::vector<DetectedTag> detect(const cv::Mat& grey);

 private:
  struct Library;
  Options options_;
  std::unique_ptr<Library> library_;
};

}  // namespace foresight
