#include "tests/support/golden.hpp"
#include "tests/support/folders.hpp"

#include <cstdlib>
#include <filesystem>
#include <opencv2/imgcodecs.hpp>

namespace foresight {

testing::AssertionResult matches_golden(const cv::Mat& made, const std::string& name,
                                        const GoldenTolerance& tolerance) {
  const std::filesystem::path file = source_folder() / "tests/golden" / (name + ".png");
  const char* update = std::getenv("FORESIGHT_UPDATE_GOLDEN");
  if (update && std::string(update) == "1") {
    cv::imwrite(file.string(), made, {cv::IMWRITE_PNG_COMPRESSION, 9});
    return testing::AssertionSuccess() << "written";
  }
  const cv::Mat golden = cv::imread(file.string(), cv::IMREAD_UNCHANGED);
  if (golden.empty()) return testing::AssertionFailure() << file << " is missing; FORESIGHT_UPDATE_GOLDEN=1 writes it";
  if (golden.size() != made.size() || golden.type() != made.type())
    return testing::AssertionFailure() << name << ": size or type differ: " << golden.size() << " and " << made.size();

  double sum = 0;
  std::size_t differing = 0;
  const int channels = made.channels();
  for (int y = 0; y < made.rows; ++y) {
    for (int x = 0; x < made.cols; ++x) {
      int most = 0;
      for (int c = 0; c < channels; ++c) {
        const int d = std::abs(made.ptr<uchar>(y)[x * channels + c] - golden.ptr<uchar>(y)[x * channels + c]);
        sum += d;
        most = std::max(most, d);
      }
      differing += most > tolerance.step;
    }
  }
  const double pixels = static_cast<double>(made.total());
  const double mean = sum / (pixels * channels), share = static_cast<double>(differing) / pixels;
  if (mean <= tolerance.mean && share <= tolerance.share) return testing::AssertionSuccess();
  const auto copy = std::filesystem::temp_directory_path() / ("foresight_golden_" + name + ".png");
  cv::imwrite(copy.string(), made);
  return testing::AssertionFailure() << name << ": mean difference " << mean << " (at most " << tolerance.mean << "), "
                                     << 100 * share << " % of pixels differ (at most " << 100 * tolerance.share
                                     << " %); what was made: " << copy;
}

}  // namespace foresight
