// Each eye a JPEG (ITU-T T.81) of its own: nothing builds on anything.
#pragma once

#include "link/coding/pair_coder.hpp"
#include "link/coding/quality_model.hpp"

namespace foresight {

/// Nothing where the bytes, which may be anything, are no whole JPEG of that size, in colour or not.
std::optional<cv::Mat> decode_jpeg(std::span<const std::uint8_t> bytes, cv::Size size, bool colour);

class JpegPairEncoder final : public PairEncoder {
 public:
  JpegPairEncoder();
  CodedPair encode(const StereoPicture& picture, const PairWish& wish) override;
  void arrived(std::uint32_t) override {}
  void gone(std::uint32_t) override {}

 private:
  QualityModel model_;
};

/// Nothing where the data is no such pair of JPEGs, whole and of the pair's size.
std::optional<StereoPicture> decode_jpeg(const CodedPair& pair);

}  // namespace foresight
