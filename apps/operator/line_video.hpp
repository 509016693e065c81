// The best video that a line could have carried in place of stereo pairs: one eye alone, by the line's own encoder,
// each picture in as many bytes as the pair of the same instant took.
#pragma once

#include "link/coding/pair_coder.hpp"

namespace foresight {

/// One thread.
class LineVideo {
 public:
  /// The next picture: `left`, CV_8UC3, of `captured`, in about `bytes`. Nothing of it gets lost. Throws what
  /// PairEncoder::encode() does.
  void add(RobotTime captured, const cv::Mat& left, std::size_t bytes);
  /// As it looks at the other end; empty before the first.
  const cv::Mat& newest() const { return newest_; }

 private:
  std::unique_ptr<PairEncoder> encoder_ = make_pair_encoder(Coding::h264);
  std::unique_ptr<PairDecoder> decoder_ = make_pair_decoder();
  std::uint32_t number_ = 0;
  cv::Mat newest_;
};

}  // namespace foresight
