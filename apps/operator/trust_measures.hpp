// How much of what was shown was said to be exact, and was it? Against what the robot's camera saw at the instant.
#pragma once

#include <cstdint>
#include <opencv2/core.hpp>
#include <optional>
#include <string>

#include "display/doubt_kinds.hpp"

namespace foresight {

/// Over all pictures; nothing where no pixel was there to ask about.
struct TrustFigures {
  std::optional<double> exact_share;      ///< of the pixels with a colour of an image, those said to be exact
  std::optional<double> exact_wrong;      ///< of those, the ones that differ from the truth by more than 10 grey levels
  std::optional<double> exact_wrong_any;  ///< likewise, by more than 10 levels in any of red, green and blue
  std::optional<double> wrong_share;      ///< of all pixels with a colour of an image, by grey
  std::optional<double> unconfirmed;      ///< of the same, those that no camera has confirmed (doubt_kinds.hpp)
  std::optional<double> fallback_share;   ///< of pictures, those for which the newest image was shown instead
};
/// A full sentence for a report.
std::string to_sentence(const TrustFigures& figures);

class TrustMeasures {
 public:
  /// `predicted`: CV_8UC4; `doubt`, `kinds`: as they were when it was shown; `truth`: CV_8UC3 of the same size.
  /// Returns the figures of this picture.
  TrustFigures add(const cv::Mat& predicted, const cv::Mat& doubt, const ExactKinds& kinds, const cv::Mat& truth,
                   bool fell_back);
  TrustFigures figures() const { return all_.figures(); }

 private:
  struct Counts {
    std::uint64_t pictures = 0, fallbacks = 0;
    std::uint64_t seen = 0, exact = 0, unconfirmed = 0, wrong = 0, exact_wrong = 0, exact_wrong_any = 0;

    Counts& operator+=(const Counts& other);
    TrustFigures figures() const;
  };
  Counts all_;
};

}  // namespace foresight
