// A coder of nothing, with the sizes and the lanes of a real one: trials of the line as long as a drive, in a second.
#pragma once

#include <array>
#include <cmath>
#include <random>

#include "link/coding/encoder_lanes.hpp"

namespace foresight {

/// Pairs take about what is wished for, as far as their kind can: seeded, log-normally spread. Lanes are
/// those of H264PairEncoder.
class ModelPairEncoder final : public PairEncoder {
 public:
  struct Options {
    double spread = 0.2;                                     ///< of the logarithm of a pair's bytes
    std::size_t least_intra = 4'000, least_predicted = 700;  ///< at the coarsest step
    std::size_t most = 90'000;                               ///< at the finest
    unsigned seed = 1;
  };
  ModelPairEncoder() : ModelPairEncoder(Options{}) {}
  explicit ModelPairEncoder(const Options& options) : options_(options), random_(options.seed) {}

  CodedPair encode(const StereoPicture& picture, const PairWish& wish) override {
    const auto [lane, reference] = lanes_.place(wish);
    CodedPair pair{.number = wish.number, .captured = picture.captured, .coding = Coding::h264};
    pair.lane = static_cast<std::uint8_t>(lane);
    pair.reference = reference;
    pair.width = picture.left.cols;
    pair.height = picture.left.rows;
    // Box and Muller: the library's own normal distribution differs between libraries.
    const double u = (static_cast<double>(random_() >> 11) + 0.5) * 0x1p-53,
                 v = static_cast<double>(random_() >> 11) * 0x1p-53;
    const double normal = std::sqrt(-2 * std::log(u)) * std::cos(2 * M_PI * v);
    const double bytes = static_cast<double>(wish.bytes) * std::exp(options_.spread * normal);
    const auto least = reference == 0 ? options_.least_intra : options_.least_predicted;
    pair.data.resize(std::clamp(static_cast<std::size_t>(bytes), least, options_.most));
    lanes_.coded(lane, wish.number, picture.captured);
    return pair;
  }
  void arrived(std::uint32_t number) override { lanes_.arrived(number); }
  void gone(std::uint32_t number) override { lanes_.gone(number); }
  void begin_anew() override { lanes_.begin_anew(); }

 private:
  Options options_;
  std::mt19937_64 random_;
  EncoderLanes lanes_;
};

/// Shows a grey pixel as bright as the pair's number says.
class ModelPairDecoder final : public PairDecoder {
 public:
  bool ready(const CodedPair& pair) const override {
    return pair.reference == 0 || newest_[pair.lane] == pair.reference;
  }
  std::optional<StereoPicture> decode(const CodedPair& pair) override {
    if (!ready(pair) || pair.number <= newest_[pair.lane]) return std::nullopt;
    newest_[pair.lane] = pair.number;
    StereoPicture out{.left = cv::Mat(1, 1, CV_8UC1, cv::Scalar(pair.number % 256)), .captured = pair.captured};
    return out;
  }

 private:
  std::array<std::uint32_t, kMostLanes> newest_{};
};

}  // namespace foresight
