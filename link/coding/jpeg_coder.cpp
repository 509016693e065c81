#include "link/coding/jpeg_coder.hpp"

#include <algorithm>
#include <cmath>

#include "common/error.hpp"
#include "pictures/decode.hpp"
#include "pictures/encode.hpp"
#include "pictures/image_structure.hpp"

namespace foresight {
namespace {

// Steps of a JPEG's quantiser, six to a doubling as in H.264: 0 is quality 97, 45 is quality 5.
int quality_of(int step) {
  const double scale = 6 * std::exp2(step / 6.0);  // percent of the tables of Annex K
  return static_cast<int>(std::lround(std::clamp(scale < 100 ? 100 - scale / 2 : 5000 / scale, 1.0, 100.0)));
}

constexpr QualityModel::Range kSteps{0, 45};

}  // namespace

std::optional<cv::Mat> decode_jpeg(std::span<const std::uint8_t> bytes, cv::Size size, bool colour) {
  // The structure first: decoders fill with grey what a file lacks, and allocate what its header asks for.
  const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  try {
    const ImageForm form = read_image_form(text, "a JPEG");
    if (cv::Size(form.width, form.height) != size || form.channels != (colour ? 3 : 1)) return std::nullopt;
  } catch (const InputError&) {
    return std::nullopt;
  }
  cv::Mat out = decode_picture(text, colour ? PictureColours::colour : PictureColours::grey).pixels;
  if (out.size() != size) return std::nullopt;
  return out;
}

JpegPairEncoder::JpegPairEncoder() : model_(kSteps, 9, 20, 60'000) {}

CodedPair JpegPairEncoder::encode(const StereoPicture& picture, const PairWish& wish) {
  check(picture);
  CodedPair pair{.number = wish.number, .captured = picture.captured, .coding = Coding::jpeg};
  pair.width = picture.left.cols;
  pair.height = picture.left.rows;
  pair.colour = picture.left.channels() == 3;
  pair.stereo = !picture.right.empty();
  const int step = model_.step_for(wish.bytes);
  const int quality = quality_of(step);
  pair.data = encode_jpeg(picture.left, quality);
  pair.left_bytes = static_cast<std::uint32_t>(pair.data.size());
  if (pair.stereo) {
    const std::vector<std::uint8_t> right = encode_jpeg(picture.right, quality);
    pair.data.insert(pair.data.end(), right.begin(), right.end());
  }
  model_.learn(step, pair.data.size());
  return pair;
}

std::optional<StereoPicture> decode_jpeg(const CodedPair& pair) {
  const std::span<const std::uint8_t> all(pair.data);
  const cv::Size size(pair.width, pair.height);
  StereoPicture out{.left = {}, .right = {}, .captured = pair.captured};
  const std::optional<cv::Mat> left = decode_jpeg(all.first(pair.left_bytes), size, pair.colour);
  if (!left) return std::nullopt;
  out.left = *left;
  if (!pair.stereo) return out;
  const std::optional<cv::Mat> right = decode_jpeg(all.subspan(pair.left_bytes), size, pair.colour);
  if (!right) return std::nullopt;
  out.right = *right;
  return out;
}

}  // namespace foresight
