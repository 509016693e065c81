#include "apps/operator/seat_measures.hpp"

#include <opencv2/imgproc.hpp>

#include "apps/view_outputs.hpp"
#include "pictures/picture_file.hpp"

namespace foresight {
namespace {

constexpr double kMoved = 10;             // grey levels between two true images
constexpr std::size_t kLeastMoved = 100;  // pixels that are worth a figure

/// 255 where two images differ by more than kMoved in any channel.
cv::Mat moved_mask(const cv::Mat& one, const cv::Mat& other, const cv::Mat& seen) {
  cv::Mat difference, out;
  cv::absdiff(one, other, difference);
  std::vector<cv::Mat> channels;
  cv::split(difference, channels);
  for (std::size_t i = 1; i < channels.size(); ++i) channels[0] = cv::max(channels[0], channels[i]);
  cv::threshold(channels[0], out, kMoved, 255, cv::THRESH_BINARY);
  return out & seen;
}

}  // namespace

void SeatMeasures::Mean::add(std::optional<double> value) {
  if (!value) return;
  sum_ += *value;
  ++count_;
}

std::optional<double> SeatMeasures::Mean::mean() const {
  return count_ ? std::optional(sum_ / static_cast<double>(count_)) : std::nullopt;
}

SeatMeasures::SeatMeasures(RunRecord record, std::optional<std::filesystem::path> out)
    : out_(std::move(out)), record_(std::move(record)) {
  for (const char* folder : {"shown", "delayed", "true"})
    if (out_) make_folder(*out_ / folder);
}

void SeatMeasures::show(ShownPicture picture) {
  shown_.push_back(std::move(picture));
}

void SeatMeasures::saw(RobotTime captured, const cv::Mat& image) {
  truths_[captured] = image;
  while (truths_.begin()->first < captured - kTruthKept) truths_.erase(truths_.begin());
  while (!shown_.empty() && shown_.front().instant <= captured + kSameInstant) {
    if (const cv::Mat truth = image_at(shown_.front().instant); !truth.empty()) measure(shown_.front(), truth);
    shown_.pop_front();
  }
}

cv::Mat SeatMeasures::image_at(RobotTime time) const {
  const auto found = truths_.lower_bound(time - kSameInstant);
  return found != truths_.end() && found->first <= time + kSameInstant ? found->second : cv::Mat();
}

void SeatMeasures::measure(ShownPicture& shown, const cv::Mat& truth) {
  const cv::Mat seen = seen_mask(shown.predicted);
  const ImageComparison all(truth, seen);
  FrameRecord record;
  record.stem = shown.stem;
  record.time_s = 1e-9 * static_cast<double>(shown.instant.ns);
  record.delay_s = to_seconds(shown.instant - shown.newest);
  record.predicted = all.measure(shown.predicted);
  record.delayed = all.measure(shown.delayed);
  record.coverage = measure_coverage(shown.predicted);
  if (!shown.video.empty()) video_.add(all.psnr_db(shown.video));
  ages_.add(record.delay_s);
  invalid_ += shown.invalid ? 1 : 0;
  ++measured_;
  if (!shown.doubt.empty()) {
    const bool fell_back = !shown.newest_instead.empty();
    trust_of_pictures_.push_back(
        {shown.stem, trust_.add(shown.predicted, shown.doubt, shown.exact, truth, fell_back), shown.newest_instead});
  }
  if (const cv::Mat before = image_at(shown.newest); !before.empty()) measure_moved(shown, truth, before, seen);
  if (without_line_)
    if (const cv::Mat view = without_line_(shown.instant); !view.empty()) zero_.add(all.psnr_db(view));
  keeper_.offer(record, shown.delayed, shown.predicted, truth);
  write_pictures(shown, truth);
  record_.frames.push_back(record);
}

void SeatMeasures::measure_moved(const ShownPicture& shown, const cv::Mat& truth, const cv::Mat& before,
                                 const cv::Mat& seen) {
  const cv::Mat moved = moved_mask(truth, before, seen);
  const auto count = static_cast<std::size_t>(cv::countNonZero(moved));
  moved_share_.add(static_cast<double>(count) / std::max(1, cv::countNonZero(seen)));
  if (count < kLeastMoved) return;
  const ImageComparison there(truth, moved);
  moving_predicted_.add(there.psnr_db(shown.predicted));
  moving_delayed_.add(there.psnr_db(shown.delayed));
  if (!shown.video.empty()) moving_video_.add(there.psnr_db(shown.video));
}

void SeatMeasures::write_pictures(const ShownPicture& shown, const cv::Mat& truth) const {
  if (!out_) return;
  const std::string name = shown.stem + ".png";
  write_png(*out_ / "shown" / name, shown.predicted);
  write_png(*out_ / "delayed" / name, shown.delayed);
  write_png(*out_ / "true" / name, truth);
}

SeatFidelity SeatMeasures::finish() {
  SeatFidelity out;
  const Summary all = summarise(record_);
  if (all.frames > 0) {
    out.predicted_db = all.predicted.psnr_db.mean;
    out.delayed_db = all.delayed.psnr_db.mean;
  }
  out.zero_delay_db = zero_.mean();
  out.video_db = video_.mean();
  out.moving_video_db = moving_video_.mean();
  out.moving_predicted_db = moving_predicted_.mean();
  out.moving_delayed_db = moving_delayed_.mean();
  out.moving_share = moved_share_.mean();
  out.image_age_s = ages_.mean();
  out.invalid_share = measured_ ? static_cast<double>(invalid_) / static_cast<double>(measured_) : 1;
  out.trust = trust_.figures();
  out.trust_of_pictures = std::move(trust_of_pictures_);
  if (out.trust.exact_share) record_.notes.push_back(to_sentence(out.trust));
  out.instants = keeper_.instants();
  out.record = std::move(record_);
  return out;
}

}  // namespace foresight
