#include "link/robot_side/pair_coder.hpp"

#include <opencv2/imgcodecs.hpp>

namespace foresight::link {

PairCoder jpeg_coder(int quality) {
  return [settings = std::vector<int>{cv::IMWRITE_JPEG_QUALITY, quality}](const LiveFrame& frame, StereoFrame& out) {
    out.coding = kJpeg;
    return cv::imencode(".jpg", frame.pair.left.bgr, out.left.data, settings) &&
           cv::imencode(".jpg", frame.pair.right.bgr, out.right.data, settings);
  };
}

}  // namespace foresight::link
