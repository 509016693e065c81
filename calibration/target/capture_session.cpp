#include "calibration/target/capture_session.hpp"

#include <fmt/core.h>

#include <opencv2/imgproc.hpp>

#include "calibration/target/capture_picture.hpp"
#include "common/error.hpp"

namespace foresight {
namespace {

namespace fs = std::filesystem;

cv::Mat grey_of(const cv::Mat& image) {
  if (image.channels() == 1) return image;
  cv::Mat grey;
  cv::cvtColor(image, grey, cv::COLOR_BGR2GRAY);
  return grey;
}

}  // namespace

CaptureSession::CaptureSession(const Board& board, const Options& options) : board_(board), options_(options) {
  for (const fs::path& folder : folders()) {
    std::error_code error;
    fs::create_directories(folder, error);
    if (error) throw RuntimeFailure("cannot make " + folder.string() + ": " + error.message(), "choose another --out");
    if (!fs::is_empty(folder))
      throw InputError(folder.string(), "already holds files", "name a new folder, or empty it");
  }
}

std::vector<fs::path> CaptureSession::folders() const {
  if (!options_.stereo) return {options_.out};
  return {options_.out / "left", options_.out / "right"};
}

CaptureProgress CaptureSession::progress() const {
  if (guide_) return guide_->progress();
  return CaptureGuide(board_, {1, 1}, options_.stereo, options_.guide).progress();
}

CaptureSession::Outcome CaptureSession::show(const cv::Mat& left, const cv::Mat& right, bool at_once) {
  const std::array<const cv::Mat*, 2> images{&left, &right};
  const std::size_t count = options_.stereo ? 2 : 1;
  std::vector<cv::Mat> greys;
  for (std::size_t i = 0; i < count; ++i) greys.push_back(grey_of(*images[i]));
  if (!guide_) {
    sizes_ = {left.size(), right.size()};
    guide_.emplace(board_, left.size(), options_.stereo, options_.guide);
  }
  for (std::size_t i = 0; i < count; ++i)
    if (images[i]->size() != sizes_[i])
      throw InputError(i == 0 ? "the left camera" : "the right camera", "changed its image size",
                       "calibrate one resolution at a time");
  if (!finder_) {
    board_ = complete_board(board_, greys);
    if (board_.kind != BoardKind::charuco || !board_.family.empty()) finder_.emplace(board_);
  }
  Outcome outcome;
  if (finder_)
    for (std::size_t i = 0; i < count; ++i) outcome.found[i] = finder_->find(greys[i]);
  outcome.verdict = guide_->offer(outcome.found[0], outcome.found[1], at_once);
  if (!outcome.verdict.taken) return outcome;
  const std::string name = fmt::format("{:03}.png", guide_->views());
  const auto out = folders();
  for (std::size_t i = 0; i < count; ++i) write_picture(out[i] / name, *images[i]);
  return outcome;
}

}  // namespace foresight
