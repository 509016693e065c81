#include "link/coding/h264_coder.hpp"

#include <algorithm>
#include <cmath>

namespace foresight {
namespace {

constexpr std::array<double, 4> kSoftness{0, 1.5, 3, 6};         // standard deviation in pixels, of an eye 640 wide
constexpr std::array<double, 4> kFirstShare{1, 0.6, 0.4, 0.25};  // of the bytes of a pair predicted from none
constexpr double kFirstTimes = 3;                                // bytes over wish that such a pair may take
constexpr double kFirstBytes = 0.03;                             // per pixel, until one was coded
constexpr double kTooLarge = 1.5;                                // bytes over wish
constexpr std::size_t kSuddenly = 4;  // a wish that so much less than the last pair took is not waited for
constexpr double kFloor = 2;          // bytes per block of 16 x 16 px: twice of what the coarsest step takes
constexpr double kMostAsked = 2.5, kAskingGain = 0.25;
constexpr double kNoMoreNeeded = 0.5;  // bytes over wish: so little is taken at the finest step

}  // namespace

double H264PairEncoder::area() const {
  return size_.area() * (halved_ ? 0.25 : 1.0);
}

bool H264PairEncoder::is_near_floor(std::size_t wish) const {
  return static_cast<double>(wish) < kFloor * area() / (16 * 16);
}

// Even the coarsest step has a floor: what moves has to be said somehow. A softer picture has a lower one. Far above it
// softness would be one more change that takes bytes, first to blur what was sharp, then to sharpen it again.
std::size_t H264PairEncoder::softness_for(std::size_t wish, bool intra) const {
  if (!intra && !is_near_floor(wish)) return 0;
  if (!intra) return wish * kSuddenly < last_bytes_ ? std::max<std::size_t>(softness_, 2) : softness_;
  const double bytes = area() * (first_bytes_per_px_ > 0 ? first_bytes_per_px_ : kFirstBytes);
  std::size_t softness = 0;
  while (softness + 1 < kSoftness.size() && bytes * kFirstShare[softness] > kFirstTimes * static_cast<double>(wish))
    ++softness;
  return softness;
}

void H264PairEncoder::learn(std::size_t bytes, std::size_t wish, std::size_t softness, bool intra) {
  const double ratio = static_cast<double>(bytes) / static_cast<double>(wish);
  if (intra) {
    first_bytes_per_px_ = static_cast<double>(bytes) / area() / kFirstShare[softness];
    return;
  }
  last_bytes_ = bytes;
  softness_ = softness;
  if (ratio > kTooLarge && is_near_floor(wish)) {
    softness_ = std::min(softness + 1, kSoftness.size() - 1);
  } else if (bytes <= wish && softness > 0) {
    --softness_;
  }
  if (softness > 0) return;
  if (ratio > 1) {
    asked_ = std::max(1.0, asked_ / ratio);
  } else if (ratio > kNoMoreNeeded) {
    asked_ = std::min(asked_ * std::pow(ratio, -kAskingGain), kMostAsked);
  }
}

CodedPair H264PairEncoder::encode(const StereoPicture& picture, const PairWish& wish) {
  check(picture);
  Planes planes = to_planes(picture);
  if (planes.size != size_) {
    lanes_ = {};
    encoders_ = {};
    scale_ = {};
    size_ = planes.size;
  }
  const std::size_t bytes = wish.bytes > kCodedPairHeader ? wish.bytes - kCodedPairHeader : 1;
  if (const bool halved = scale_.halved(planes, bytes); halved != halved_) {
    halved_ = halved;
    lanes_.begin_anew();
    encoders_ = {};
    first_bytes_per_px_ = 0;
    asked_ = 1;
  }
  if (halved_) planes = to_planes(halve(picture));
  for (std::size_t i = 0; i < encoders_.size(); ++i)
    if (lanes_.rests(i)) encoders_[i].reset();
  const auto [lane, reference] = lanes_.place(wish);
  const bool intra = reference == 0;
  std::optional<H264Encoder>& encoder = encoders_[lane];
  if (!encoder) encoder.emplace(planes.size);
  CodedPair pair{.number = wish.number, .captured = picture.captured, .coding = Coding::h264};
  pair.lane = static_cast<std::uint8_t>(lane);
  pair.reference = reference;
  pair.width = picture.left.cols;
  pair.height = picture.left.rows;
  pair.colour = picture.left.channels() == 3;
  pair.stereo = !picture.right.empty();
  pair.halved = halved_;
  const std::size_t softness = softness_for(bytes, intra);
  soften(planes, kSoftness[softness] * planes.size.width / 640);
  const double asked = static_cast<double>(bytes) * (intra || softness > 0 || wish.only_what_arrived ? 1 : asked_);
  pair.data = encoder->encode(planes, static_cast<std::size_t>(asked), intra);
  learn(pair.data.size(), bytes, softness, intra);
  lanes_.coded(lane, wish.number, picture.captured);
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
  const cv::Size whole(pair.width, pair.height);
  const cv::Size coded = pair.halved ? cv::Size((whole.width + 1) / 2, (whole.height + 1) / 2) : whole;
  cv::Size size = even_size(coded.width, coded.height);
  if (pair.stereo) size.height *= 2;
  const std::optional<Planes> planes = lane.decoder->decode(pair.data, size);
  if (!planes) return std::nullopt;
  lane.number = pair.number;
  lane.captured = pair.captured;
  for (Lane& other : lanes_)
    if (lane_rests(other.captured, pair.captured)) other = {};
  StereoPicture out = from_planes(*planes, coded.width, coded.height, pair.colour, pair.stereo);
  if (pair.halved) out = enlarge(out, whole);
  out.captured = pair.captured;
  return out;
}

}  // namespace foresight
