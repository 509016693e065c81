// AprilTags in images: the one place that calls libapriltag's detector.
#pragma once

#include <Eigen/Core>
#include <array>
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
  Eigen::Matrix3d H =
      Eigen::Matrix3d::Identity();  ///< from -1..1 across the black square, x right and y down in print, to px
};

/// libapriltag 3.3; the defaults suit images that come 30 times a second. One thread.
class TagDetector {
 public:
  struct Options {
    std::string family = "tag36h11";
    /// Quads are looked for in an image so many times smaller, corners in the whole one; 0: 2 from 1.5
    /// megapixels on, else 1.
    double decimate = 2;
    double least_margin = 25;   ///< weaker detections are dropped
    double least_side_px = 12;  ///< smaller tags are dropped: their corners are worth little
    /// Relative exposure of the levels 0 to 255, ascending (the inverse response that `calibrate photometric` finds):
    /// corners are found in the picture's light. Empty: in its levels, where a camera's usual response puts corners of
    /// black on white 0.3 px too near to the tag's middle.
    std::vector<double> inverse_response = {};
  };

  /// Throws InputError for a family that does not exist (tag_family.hpp), and a response that has not 256 levels.
  explicit TagDetector(const Options& options);
  ~TagDetector();

  /// Tags of `grey` (CV_8UC1); one that is found twice or touches the border is left out. Ascending by id.
  std::vector<DetectedTag> detect(const cv::Mat& grey);

 private:
  struct Library;
  Options options_;
  cv::Mat light_;  // 8-bit light of each level; empty: no response
  std::unique_ptr<Library> library_;
};

}  // namespace foresight
