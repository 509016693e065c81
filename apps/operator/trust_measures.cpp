#include "apps/operator/trust_measures.hpp"

#include <fmt/core.h>

#include <opencv2/imgproc.hpp>

#include "pictures/image_metrics.hpp"
#include "scene/coding_loss.hpp"
#include "seat/shown_fidelity.hpp"

namespace foresight {
namespace {

constexpr double kWrong = 10;  // levels

std::uint64_t count(const cv::Mat& mask) {
  return static_cast<std::uint64_t>(cv::countNonZero(mask));
}

std::optional<double> share(std::uint64_t part, std::uint64_t whole) {
  if (whole == 0) return std::nullopt;
  return static_cast<double>(part) / static_cast<double>(whole);
}

cv::Mat any_channel_wrong(const cv::Mat& predicted, const cv::Mat& truth) {
  cv::Mat bgr, difference, one, out = cv::Mat::zeros(truth.size(), CV_8UC1);
  cv::cvtColor(predicted, bgr, cv::COLOR_BGRA2BGR);
  cv::absdiff(bgr, truth, difference);
  for (int i = 0; i < 3; ++i) {
    cv::extractChannel(difference, one, i);
    out |= one > kWrong;
  }
  return out;
}

}  // namespace

TrustMeasures::Counts& TrustMeasures::Counts::operator+=(const Counts& other) {
  pictures += other.pictures;
  fallbacks += other.fallbacks;
  seen += other.seen;
  exact += other.exact;
  unconfirmed += other.unconfirmed;
  wrong += other.wrong;
  exact_wrong += other.exact_wrong;
  exact_wrong_any += other.exact_wrong_any;
  return *this;
}

TrustFigures TrustMeasures::Counts::figures() const {
  return {share(exact, seen), share(exact_wrong, exact), share(exact_wrong_any, exact),
          share(wrong, seen), share(unconfirmed, seen),  share(fallbacks, pictures)};
}

TrustFigures TrustMeasures::add(const cv::Mat& predicted, const cv::Mat& doubt, const ExactKinds& kinds,
                                const cv::Mat& truth, bool fell_back) {
  const cv::Mat seen = seen_mask(predicted), exact = exact_mask(predicted, doubt, kinds);
  const cv::Mat wrong = (grey_difference(predicted, truth) > kWrong) & seen;
  const Counts one{.pictures = 1,
                   .fallbacks = fell_back ? 1U : 0U,
                   .seen = count(seen),
                   .exact = count(exact),
                   .unconfirmed = count((doubt == kUnconfirmed) & seen),
                   .wrong = count(wrong),
                   .exact_wrong = count(wrong & exact),
                   .exact_wrong_any = count(any_channel_wrong(predicted, truth) & exact)};
  all_ += one;
  return one.figures();
}

std::string to_sentence(const TrustFigures& figures) {
  const auto percent = [](const std::optional<double>& value) {
    return value ? fmt::format("{:.1f} %", 1e2 * *value) : std::string("nothing");
  };
  return fmt::format(
      "Of the seen pixels {} were shown as exact; of those {} were off by more than 10 grey levels ({} in any of red, "
      "green and blue), of all seen pixels {}. {} were not confirmed by a camera. The newest image was shown instead "
      "for {} of the pictures.",
      percent(figures.exact_share), percent(figures.exact_wrong), percent(figures.exact_wrong_any),
      percent(figures.wrong_share), percent(figures.unconfirmed), percent(figures.fallback_share));
}

}  // namespace foresight
