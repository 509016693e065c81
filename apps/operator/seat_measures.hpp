// What an operator was shown, against what the camera saw at the instants that it was shown for, once that is known.
#pragma once

#include <deque>
#include <filesystem>
#include <functional>
#include <map>
#include <opencv2/core.hpp>
#include <optional>
#include <string>
#include <vector>

#include "apps/operator/trust_measures.hpp"
#include "apps/replay_report/instants.hpp"
#include "apps/replay_report/replay_report.hpp"
#include "common/time.hpp"

namespace foresight {

/// As it was shown.
struct ShownPicture {
  RobotTime instant;      ///< that it was shown for
  RobotTime newest;       ///< capture instant of `delayed`
  std::string stem;       ///< file name
  cv::Mat predicted;      ///< CV_8UC4, as PredictedView::read()
  cv::Mat delayed;        ///< CV_8UC3: the newest image that had come
  cv::Mat video = {};     ///< likewise, as a video of one eye in the same bytes would have it; empty: not made
  bool invalid = false;   ///< prediction was not to be trusted
  cv::Mat doubt = {};     ///< CV_8UC1 (display/doubt_kinds.hpp); empty: trust is not measured
  ExactKinds exact = {};  ///< of doubt, of which pixels were shown as exact
  std::string newest_instead = {};  ///< why the newest image was shown instead; "" where it was not
};

struct PictureTrust {
  std::string stem;
  TrustFigures figures;
  std::string newest_instead;  ///< as in ShownPicture
};

/// Means over the pictures that were measured; nothing where none could be.
struct SeatFidelity {
  std::optional<double> predicted_db, delayed_db, zero_delay_db;  ///< PSNR over all seen pixels
  std::optional<double> moving_predicted_db, moving_delayed_db;   ///< over those that changed over the delay
  std::optional<double> video_db, moving_video_db;                ///< as delayed_db: ShownPicture::video
  std::optional<double> moving_share;                             ///< of the seen pixels
  double invalid_share = 0;                                       ///< of pictures without a prediction to trust
  std::optional<double> image_age_s;                              ///< of the newest image against the shown instant
  TrustFigures trust;                                             ///< of pictures with their doubt
  std::vector<PictureTrust> trust_of_pictures;                    ///< each of these
  RunRecord record;
  std::vector<Instant> instants;
};

/// One thread. Remembers what the camera saw for kTruthKept.
class SeatMeasures {
 public:
  static constexpr Duration kTruthKept = std::chrono::seconds(20);
  /// A picture and an image belong to the same instant.
  static constexpr Duration kSameInstant = std::chrono::milliseconds(1);

  /// The view of the instant as it would be without a line: CV_8UC4, or empty.
  using WithoutLine = std::function<cv::Mat(RobotTime)>;

  /// `record`: described. `out`: folder for shown/, delayed/ and true/, which are made. Throws RuntimeFailure.
  SeatMeasures(RunRecord record, std::optional<std::filesystem::path> out);
  void compare_without_line(WithoutLine view) { without_line_ = std::move(view); }

  /// Instants in their order.
  void show(ShownPicture picture);
  /// What the left camera saw (CV_8UC3); in the order of their instants. Measures what was shown for it.
  void saw(RobotTime captured, const cv::Mat& image);

  /// Pictures whose instant is still to come.
  bool waits() const { return !shown_.empty(); }
  std::uint64_t measured() const { return measured_; }
  /// What saw() was told of that instant; empty where it was not, or no longer.
  cv::Mat image_at(RobotTime time) const;
  SeatFidelity finish();

 private:
  class Mean {
   public:
    void add(std::optional<double> value);
    std::optional<double> mean() const;

   private:
    double sum_ = 0;
    std::size_t count_ = 0;
  };

  void measure(ShownPicture& shown, const cv::Mat& truth);
  void measure_moved(const ShownPicture& shown, const cv::Mat& truth, const cv::Mat& before, const cv::Mat& seen);
  void write_pictures(const ShownPicture& shown, const cv::Mat& truth) const;

  std::optional<std::filesystem::path> out_;
  WithoutLine without_line_;
  std::deque<ShownPicture> shown_;
  std::map<RobotTime, cv::Mat> truths_;
  std::uint64_t measured_ = 0, invalid_ = 0;
  Mean zero_, moving_predicted_, moving_delayed_, video_, moving_video_, moved_share_, ages_;
  TrustMeasures trust_;
  std::vector<PictureTrust> trust_of_pictures_;
  InstantKeeper keeper_{4};
  RunRecord record_;
};

}  // namespace foresight
