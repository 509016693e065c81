// A coder of nothing, with the sizes and the lanes of a real one: trials of the line as long as a drive, in a second.
#pragma once

#include <array>
#include <cmath>
#include <random>

#include "link/coding/pair_coder.hpp"

namespace foresight {

/// Pairs take about what is wished for, as far as their kind can: seeded, log-normally spread. Lanes as
/// H264PairEncoder has them.
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
    Lane& lane = choose(wish);
    CodedPair pair{.number = wish.number, .captured = picture.captured, .coding = Coding::h264};
    pair.lane = static_cast<std::uint8_t>(&lane - lanes_.data());
    pair.reference = lane.broken ? 0 : lane.number;
    pair.width = picture.left.cols;
    pair.height = picture.left.rows;
    // Box and Muller: the library's own normal distribution differs between libraries.
    const double u = (static_cast<double>(random_() >> 11) + 0.5) * 0x1p-53,
                 v = static_cast<double>(random_() >> 11) * 0x1p-53;
    const double normal = std::sqrt(-2 * std::log(u)) * std::cos(2 * M_PI * v);
    const double bytes = static_cast<double>(wish.bytes) * std::exp(options_.spread * normal);
    const auto least = lane.broken ? options_.least_intra : options_.least_predicted;
    pair.data.resize(std::clamp(static_cast<std::size_t>(bytes), least, options_.most));
    lane = {.number = wish.number, .arrived = false, .broken = false};
    return pair;
  }
  void arrived(std::uint32_t number) override {
    for (Lane& lane : lanes_)
      if (lane.number == number) lane.arrived = true;
  }
  void gone(std::uint32_t number) override {
    for (Lane& lane : lanes_)
      if (lane.number == number) lane.broken = true;
  }

 private:
  struct Lane {
    std::uint32_t number = 0;
    bool arrived = false, broken = true;
  };
  Lane& choose(const PairWish& wish) {
    Lane *newest = nullptr, *unused = nullptr, *on_the_way = nullptr;
    for (Lane& lane : lanes_) {
      if (lane.broken) {
        if (!unused) unused = &lane;
        continue;
      }
      if (!on_the_way || lane.number > on_the_way->number) on_the_way = &lane;
      if ((lane.arrived || !wish.only_what_arrived) && (!newest || lane.number > newest->number)) newest = &lane;
    }
    return newest ? *newest : unused ? *unused : *on_the_way;
  }

  Options options_;
  std::mt19937_64 random_;
  std::array<Lane, kMostLanes> lanes_;
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
