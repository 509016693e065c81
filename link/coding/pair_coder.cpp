#include "link/coding/pair_coder.hpp"

#include <fmt/core.h>

#include "common/error.hpp"
#include "link/coding/h264_coder.hpp"
#include "link/coding/jpeg_coder.hpp"

namespace foresight {
namespace {

class AnyPairDecoder final : public PairDecoder {
 public:
  bool ready(const CodedPair& pair) const override { return pair.coding == Coding::jpeg || h264_.ready(pair); }
  std::optional<StereoPicture> decode(const CodedPair& pair) override {
    return pair.coding == Coding::jpeg ? decode_jpeg(pair) : h264_.decode(pair);
  }

 private:
  H264PairDecoder h264_;
};

}  // namespace

std::unique_ptr<PairEncoder> make_pair_encoder(Coding coding) {
  if (coding == Coding::jpeg) return std::make_unique<JpegPairEncoder>();
  return std::make_unique<H264PairEncoder>();
}

std::unique_ptr<PairDecoder> make_pair_decoder() {
  return std::make_unique<AnyPairDecoder>();
}

void check(const StereoPicture& picture) {
  const cv::Mat& left = picture.left;
  if (left.empty() || (left.type() != CV_8UC1 && left.type() != CV_8UC3))
    throw InputError("a picture to be coded", "it is neither 8-bit grey nor 8-bit BGR", "convert it first");
  if (left.cols > kLargestPictureSide || left.rows > kLargestPictureSide)
    throw InputError("a picture to be coded", fmt::format("it has {} x {} px", left.cols, left.rows),
                     fmt::format("give {} px at most on each side", kLargestPictureSide));
  if (!picture.right.empty() && (picture.right.size() != left.size() || picture.right.type() != left.type()))
    throw InputError("a pair to be coded", "its pictures differ in size or type", "take both with the same settings");
}

}  // namespace foresight
