// Both eyes as one H.264 picture, in lanes (pair_coder.hpp) of one stream each.
#pragma once

#include <array>

#include "link/coding/encoder_lanes.hpp"
#include "link/coding/h264_stream.hpp"
#include "link/coding/pair_coder.hpp"
#include "link/coding/picture_scale.hpp"

namespace foresight {

class H264PairEncoder final : public PairEncoder {
 public:
  CodedPair encode(const StereoPicture& picture, const PairWish& wish) override;
  void arrived(std::uint32_t number) override { lanes_.arrived(number); }
  void gone(std::uint32_t number) override { lanes_.gone(number); }
  void begin_anew() override { lanes_.begin_anew(); }

 private:
  double area() const;  // px of both eyes, as they are coded
  bool is_near_floor(std::size_t wish) const;
  std::size_t softness_for(std::size_t wish, bool intra) const;
  void learn(std::size_t bytes, std::size_t wish, std::size_t softness, bool intra);

  EncoderLanes lanes_;
  std::array<std::optional<H264Encoder>, kMostLanes> encoders_;  // one a lane
  cv::Size size_;                                                // of the planes of whole pictures
  PictureScale scale_;
  bool halved_ = false;
  std::size_t softness_ = 0;       // of the next picture, so that it fits its wish
  std::size_t last_bytes_ = 0;     // of the last predicted pair
  double asked_ = 1;               // times the wish: what the library is asked for, as it gives less
  double first_bytes_per_px_ = 0;  // of pairs that are predicted from none, were they not softened
};

class H264PairDecoder {
 public:
  bool ready(const CodedPair& pair) const;
  std::optional<StereoPicture> decode(const CodedPair& pair);

 private:
  struct Lane {
    std::optional<H264Decoder> decoder;
    std::uint32_t number = 0;  // of the last pair decoded; 0: none that could be built on
    RobotTime captured{};      // likewise
  };
  std::array<Lane, kMostLanes> lanes_;
};

}  // namespace foresight
