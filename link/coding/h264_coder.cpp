#include "link/coding/h264_coder.hpp"

#include <algorithm>

namespace foresight {
namespace {

constexpr std::array<double, 4> kSoftness{0, 1.5, 3, 6};  // standard deviation in pixels, of an eye 640 wide
constexpr double kTooLarge = 1.5;                         // bytes over wish
constexpr std::size_t kSuddenly = 4;  // a wish that so much less than the last pair took is not waited for

}  // namespace

// Even the coarsest step has a floor: what moves has to be said somehow. A softer picture has a lower one.
std::size_t H264PairEncoder::softness_for(std::size_t wish) const {
  if (wish * kSuddenly < last_bytes_) return std::max<std::size_t>(softness_, 2);
  return softness_;
}

void H264PairEncoder::learn(std::size_t bytes, std::size_t wish, std::size_t softness) {
  last_bytes_ = bytes;
  softness_ = softness;
  if (static_cast<double>(bytes) > kTooLarge * static_cast<double>(wish)) {
    softness_ = std::min(softness + 1, kSoftness.size() - 1);
  } else if (bytes <= wish && softness > 0) {
    --softness_;
  }
}

CodedPair H264PairEncoder::encode(const StereoPicture& picture, const PairWish& wish) {
  check(picture);
  Planes planes = to_planes(picture);
  if (planes.size != size_) {
    lanes_ = {};
    encoders_ = {};
    size_ = planes.size;
  }
  const auto [lane, reference] = lanes_.place(wish);
  const bool intra = reference == 0;
  std::optional<H264Encoder>& encoder = encoders_[lane];
  if (!encoder) encoder.emplace(size_);
  const std::size_t bytes = wish.bytes > kCodedPairHeader ? wish.bytes - kCodedPairHeader : 1;
  CodedPair pair{.number = wish.number, .captured = picture.captured, .coding = Coding::h264};
  pair.lane = static_cast<std::uint8_t>(lane);
  pair.reference = reference;
  pair.width = picture.left.cols;
  pair.height = picture.left.rows;
  pair.colour = picture.left.channels() == 3;
  pair.stereo = !picture.right.empty();
  const std::size_t softness = softness_for(bytes);
  soften(planes, kSoftness[softness] * picture.left.cols / 640);
  pair.data = encoder->encode(planes, bytes, intra);
  if (!intra) learn(pair.data.size(), bytes, softness);
  lanes_.coded(lane, wish.number);
  return pair;
}

bool H264PairDecoder::ready(const CodedPair& pair) const {
  return pair.reference == 0 || lanes_[pair.lane].number == pair.reference;
}

std::optional<StereoPicture> H264PairDecoder::decode(const CodedPair& pair) {
  Lane& lane = lanes_[pair.lane];
  // What was overtaken by a newer begin of its lane would throw that back.
  if (!ready(pair) || pair.number <= lane.number) return std::nullopt;
  if (!lane.decoder || pair.reference == 0) lane.decoder.emplace();
  lane.number = 0;
  cv::Size size = even_size(pair.width, pair.height);
  if (pair.stereo) size.height *= 2;
  const std::optional<Planes> planes = lane.decoder->decode(pair.data, size);
  if (!planes) return std::nullopt;
  lane.number = pair.number;
  StereoPicture out = from_planes(*planes, pair.width, pair.height, pair.colour, pair.stereo);
  out.captured = pair.captured;
  return out;
}

}  // namespace foresight
