// Made-up pages of all colours, and what an image shows of them.
#pragma once

#include <random>

#include "texture_gpu/exposure.hpp"

namespace foresight {

class ColouredPages {
 public:
  explicit ColouredPages(std::size_t count) : pages_(count) {
    for (AtlasPage& page : pages_) {
      pointers_.push_back(&page);
      seen_.push_back({0.4f, 0, any_(random_), any_(random_)});
    }
  }
  const std::vector<AtlasPage*>& pages() const { return pointers_; }
  /// As the first image shows them.
  const std::vector<ExposureSample>& samples() const { return seen_; }
  /// As an image does whose red and blue are that many times as large (their logarithms), with noise; a share of the
  /// samples shows something else.
  std::vector<ExposureSample> samples(double log_red, double log_blue, float outliers = 0) {
    std::normal_distribution<float> noise(0, 0.02f);
    std::vector<ExposureSample> samples = seen_;
    for (ExposureSample& sample : samples) {
      const bool other = any_(random_) + 0.5f < outliers;
      sample.log_red += static_cast<float>(log_red) + noise(random_) + (other ? any_(random_) : 0);
      sample.log_blue += static_cast<float>(log_blue) + noise(random_) + (other ? any_(random_) : 0);
    }
    return samples;
  }

 private:
  std::mt19937 random_{5};
  std::uniform_real_distribution<float> any_{-0.5f, 0.5f};
  std::vector<AtlasPage> pages_;
  std::vector<AtlasPage*> pointers_;
  std::vector<ExposureSample> seen_;
};

}  // namespace foresight
