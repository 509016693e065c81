#include "calibration/target/capture_session.hpp"

#include <cstdio>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "common/atomic_file.hpp"
#include "common/error.hpp"
#include "common/text.hpp"

namespace foresight {
namespace {

namespace fs = std::filesystem;

cv::Mat grey_of(const cv::Mat& image) {
  if (image.channels() == 1) return image;
  cv::Mat grey;
  cv::cvtColor(image, grey, cv::COLOR_BGR2GRAY);
  return grey;
}

void write_png(const fs::path& file, const cv::Mat& image) {
  std::vector<uchar> bytes;
  cv::imencode(".png", image, bytes, {cv::IMWRITE_PNG_COMPRESSION, 1});
  write_file_atomically(file, {reinterpret_cast<const char*>(bytes.data()), bytes.size()});
}

void write_line(cv::Mat& picture, int line, const std::string& text, const cv::Scalar& colour) {
  const double size = picture.cols / 1100.0;
  const cv::Point at(cvRound(12 * size), cvRound((28 + 30 * line) * size));
  cv::putText(picture, text, at, cv::FONT_HERSHEY_SIMPLEX, 0.8 * size, cv::Scalar::all(0),
              std::max(3, cvRound(4 * size)), cv::LINE_AA);
  cv::putText(picture, text, at, cv::FONT_HERSHEY_SIMPLEX, 0.8 * size, colour, std::max(1, cvRound(1.5 * size)),
              cv::LINE_AA);
}

}  // namespace

CaptureSession::CaptureSession(const Board& board, const Options& options) : board_(board), options_(options) {
  for (const char* side : {"left", "right"}) {
    const fs::path folder = options.out / side;
    std::error_code error;
    fs::create_directories(folder, error);
    if (error) throw RuntimeFailure("cannot make " + folder.string() + ": " + error.message(), "choose another --out");
    if (!fs::is_empty(folder))
      throw InputError(folder.string(), "already holds files", "name a new folder, or empty it");
  }
  if (!options.pictures.empty()) fs::create_directories(options.pictures);
}

CaptureGuide::Verdict CaptureSession::show(const cv::Mat& left, const cv::Mat& right) {
  const cv::Mat greys[2] = {grey_of(left), grey_of(right)};
  if (!guide_) {
    size_ = left.size();
    guide_.emplace(board_, size_, true, options_.guide);
  }
  if (left.size() != size_)
    throw InputError("the left camera", "changed its image size", "calibrate one resolution at a time");
  if (!finder_) {
    board_ = complete_board(board_, {greys[0], greys[1]});
    if (board_.kind != BoardKind::charuco || !board_.family.empty()) finder_.emplace(board_);
  }
  std::optional<FoundBoard> found[2];
  if (finder_)
    for (int i = 0; i < 2; ++i) found[i] = finder_->find(greys[i]);
  const CaptureGuide::Verdict verdict = guide_->offer(found[0], found[1]);
  if (verdict.taken) {
    char name[16];
    std::snprintf(name, sizeof name, "%03d.png", guide_->views());
    write_png(options_.out / "left" / name, left);
    write_png(options_.out / "right" / name, right);
  }
  if (!options_.pictures.empty())
    write_png(options_.pictures / "now.png", capture_picture(left, found[0], *guide_, verdict));
  return verdict;
}

cv::Mat capture_picture(const cv::Mat& image, const std::optional<FoundBoard>& found, const CaptureGuide& guide,
                        const CaptureGuide::Verdict& verdict) {
  cv::Mat picture;
  if (image.channels() == 1)
    cv::cvtColor(image, picture, cv::COLOR_GRAY2BGR);
  else
    picture = image.clone();
  const cv::Scalar green(80, 220, 80), amber(60, 190, 255);
  if (found)
    for (const Corner& corner : found->corners)
      cv::circle(picture, {cvRound(corner.pixel.x()), cvRound(corner.pixel.y())}, std::max(2, picture.cols / 200),
                 verdict.taken ? green : amber, cv::FILLED, cv::LINE_AA);
  if (const cv::Mat map = guide.uncertainty(32, 24); !map.empty()) {
    cv::Mat scaled, colours;
    double least = 0, most = 0;
    cv::minMaxLoc(map, &least, &most);
    cv::Mat(map / most * 255).convertTo(scaled, CV_8U);
    cv::applyColorMap(scaled, colours, cv::COLORMAP_VIRIDIS);
    const cv::Size small(picture.cols / 4, picture.rows / 4);
    cv::resize(colours, colours, small, 0, 0, cv::INTER_LINEAR);
    colours.copyTo(
        picture(cv::Rect(picture.cols - small.width, picture.rows - small.height, small.width, small.height)));
    write_line(picture, 3, "uncertainty " + readable(least, 2) + " to " + readable(most, 2) + " px (map: lower right)",
               cv::Scalar::all(255));
  }
  if (found)
    write_line(picture, 2,
               "sharpness " + readable(found->quality.sharpness, 2) + ", tilt " + readable(found->quality.tilt_deg, 0) +
                   " deg",
               cv::Scalar::all(255));
  write_line(picture, 0,
             std::to_string(guide.views()) + " views, " + readable(100 * guide.coverage(), 0) + " % of the image; " +
                 (verdict.taken ? "taken" : verdict.reason),
             verdict.taken ? green : amber);
  const std::string wish = guide.wish();
  write_line(picture, 1,
             guide.enough() ? "enough"
             : wish.empty() ? "a few more views, each another way"
                            : wish,
             cv::Scalar::all(255));
  return picture;
}

}  // namespace foresight
