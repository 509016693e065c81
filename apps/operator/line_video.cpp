#include "apps/operator/line_video.hpp"

namespace foresight {

void LineVideo::add(RobotTime captured, const cv::Mat& left, std::size_t bytes) {
  PairWish wish;
  wish.number = ++number_;
  wish.bytes = bytes;
  const CodedPair coded = encoder_->encode({left, cv::Mat(), captured}, wish);
  encoder_->arrived(number_);
  if (auto picture = decoder_->decode(coded)) newest_ = std::move(picture->left);
}

}  // namespace foresight
