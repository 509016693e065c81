#include <algorithm>
#include <array>
#include <map>
#include <opencv2/aruco/charuco.hpp>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>
#include <set>

#include "calibration/target/board_finders.hpp"
#include "calibration/target/grid_order.hpp"
#include "calibration/target/refine_corners.hpp"
#include "common/counted.hpp"
#include "common/error.hpp"
#include "common/statistics.hpp"
#include "common/text.hpp"

namespace foresight {
namespace {

constexpr double kUsualShare = 0.75;  // marker over square, where nothing is known

const std::vector<std::string>& dictionary_names() {  // in OpenCV's numbering
  static const std::vector<std::string> kNames{
      "DICT_4X4_50",        "DICT_4X4_100",        "DICT_4X4_250",       "DICT_4X4_1000",      "DICT_5X5_50",
      "DICT_5X5_100",       "DICT_5X5_250",        "DICT_5X5_1000",      "DICT_6X6_50",        "DICT_6X6_100",
      "DICT_6X6_250",       "DICT_6X6_1000",       "DICT_7X7_50",        "DICT_7X7_100",       "DICT_7X7_250",
      "DICT_7X7_1000",      "DICT_ARUCO_ORIGINAL", "DICT_APRILTAG_16h5", "DICT_APRILTAG_25h9", "DICT_APRILTAG_36h10",
      "DICT_APRILTAG_36h11"};
  return kNames;
}

struct Markers {
  std::vector<int> ids;
  std::vector<std::vector<cv::Point2f>> corners;
};

Markers detect(const cv::Mat& grey, const cv::Ptr<cv::aruco::Dictionary>& dictionary, int most) {
  Markers all, of_board;
  cv::aruco::detectMarkers(grey, dictionary, all.corners, all.ids);
  for (std::size_t i = 0; i < all.ids.size(); ++i) {
    if (all.ids[i] >= most || std::count(all.ids.begin(), all.ids.end(), all.ids[i]) > 1) continue;
    of_board.ids.push_back(all.ids[i]);
    of_board.corners.push_back(all.corners[i]);
  }
  return of_board;
}

int marker_count(const Board& board) {
  return board.cols * board.rows / 2;
}

cv::Ptr<cv::aruco::CharucoBoard> charuco_board(const Board& board) {
  const auto dictionary = cv::aruco::getPredefinedDictionary(charuco_dictionary(board.family));
  if (dictionary->bytesList.rows < marker_count(board))
    throw InputError("--board",
                     board.family + " has " + counted(dictionary->bytesList.rows, "marker") + ", the board " +
                         std::to_string(marker_count(board)),
                     "name a larger dictionary, such as DICT_6X6_1000");
  const double marker = board.marker_m > 0 ? board.marker_m : kUsualShare * board.size_m;
  return cv::aruco::CharucoBoard::create(board.cols, board.rows, static_cast<float>(board.size_m),
                                         static_cast<float>(marker), dictionary);
}

/// Nearest distance to a neighbour that was found; to `fallback` where none was.
float spacing_of(int id, const std::map<int, cv::Point2f>& points, int cols, float fallback) {
  float nearest = std::numeric_limits<float>::max();
  const cv::Point2f p = points.at(id);
  const auto look = [&](int other) {
    const auto at = points.find(other);
    if (at != points.end()) nearest = std::min(nearest, static_cast<float>(cv::norm(at->second - p)));
  };
  if (id % cols > 0) look(id - 1);
  if (id % cols + 1 < cols) look(id + 1);
  look(id - cols);
  look(id + cols);
  return nearest == std::numeric_limits<float>::max() ? fallback : nearest;
}

}  // namespace

int charuco_dictionary(const std::string& name) {
  const auto& names = dictionary_names();
  const auto at = std::find(names.begin(), names.end(), name);
  if (at == names.end())
    throw InputError("--board", "there is no dictionary " + in_quotes(name), did_you_mean(name, names));
  return static_cast<int>(at - names.begin());
}

FoundPoints find_charuco(const cv::Mat& grey, const Board& board) {
  const auto layout = charuco_board(board);
  const Markers markers = detect(grey, layout->dictionary, marker_count(board));
  if (markers.ids.size() < 2) return {};
  std::vector<cv::Point2f> corners;
  std::vector<int> ids;
  cv::aruco::interpolateCornersCharuco(markers.corners, markers.ids, grey, layout, corners, ids);
  if (ids.size() < 4) return {};
  std::map<int, cv::Point2f> points;
  for (std::size_t i = 0; i < ids.size(); ++i) points[ids[i]] = corners[i];
  float marker_side = 0;
  for (const auto& marker : markers.corners)
    marker_side += static_cast<float>(cv::norm(marker[0] - marker[1]) / static_cast<double>(markers.ids.size()));
  const double marker_over_square = board.marker_m > 0 ? board.marker_m / board.size_m : kUsualShare;
  // The window ends before the corners of the markers in the white squares begin.
  const double share = std::min(0.25, 0.45 * (1 - marker_over_square));
  FoundPoints found;
  for (const auto& [id, p] : points) {
    const float spacing = spacing_of(id, points, board.cols - 1, marker_side / static_cast<float>(marker_over_square));
    const int window = refinement_half_window(spacing, share);
    const cv::Point2f refined = refine_corner(grey, p, window);
    found.corners.push_back({id, {refined.x, refined.y}, corner_noise(grey, refined, window)});
  }
  return found;
}

std::string fitting_dictionary(const Board& board, const std::vector<cv::Mat>& greys) {
  std::string best;
  std::size_t most = 1;
  const auto& names = dictionary_names();
  std::set<int> sizes;
  for (std::size_t i = 0; i < names.size(); ++i) {
    const auto dictionary = cv::aruco::getPredefinedDictionary(static_cast<int>(i));
    if (dictionary->bytesList.rows < marker_count(board)) continue;
    // DICT_6X6_50 is the beginning of DICT_6X6_100: one of them tells.
    if (i < 16 && !sizes.insert(dictionary->markerSize).second) continue;
    std::set<int> seen;
    std::size_t total = 0;
    for (const cv::Mat& grey : greys) total += detect(grey, dictionary, marker_count(board)).ids.size();
    if (total > most) best = names[i];
    most = std::max(most, total);
  }
  return best;
}

std::optional<double> marker_share(const Board& board, const std::vector<cv::Mat>& greys) {
  Board unit = board;
  unit.size_m = 1;
  unit.marker_m = 0.5;
  const auto layout = charuco_board(unit);
  std::vector<double> shares;
  for (const cv::Mat& grey : greys) {
    const Markers markers = detect(grey, layout->dictionary, marker_count(board));
    if (markers.ids.size() < 4) continue;
    // Centres of markers lie at centres of squares, whatever the size of the markers.
    std::vector<cv::Point2f> image, squares;
    for (std::size_t i = 0; i < markers.ids.size(); ++i) {
      cv::Point2f centre_board, centre_image;
      for (int c = 0; c < 4; ++c) {
        const cv::Point3f& p = layout->objPoints[static_cast<std::size_t>(markers.ids[i])][static_cast<std::size_t>(c)];
        centre_board += cv::Point2f(p.x, p.y) / 4;
        centre_image += markers.corners[i][static_cast<std::size_t>(c)] / 4;
      }
      squares.push_back(centre_board);
      image.push_back(centre_image);
    }
    const cv::Mat H = cv::findHomography(image, squares);
    if (H.empty()) continue;
    for (const auto& corners : markers.corners) {
      std::vector<cv::Point2f> flat;
      cv::perspectiveTransform(corners, flat, H);
      shares.push_back(std::sqrt(cv::contourArea(flat)));
    }
  }
  if (shares.empty()) return std::nullopt;
  return std::clamp(median(std::move(shares)), 0.1, 0.95);
}

}  // namespace foresight
