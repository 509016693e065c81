#include "tests/target/drawn_board.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <opencv2/aruco/charuco.hpp>
#include <opencv2/imgproc.hpp>

#include "calibration/tags/tag_family.hpp"
#include "calibration/target/board_finders.hpp"

namespace foresight {
namespace {

struct Print {
  cv::Mat texture;
  Eigen::Vector2d origin;  // of the texture's corner, board frame, metres
  double px_per_metre = 0;
};

constexpr int kCell = 120;  // texture pixels per size_m

void draw_chessboard(const Board& board, cv::Mat& picture) {
  for (int row = 0; row <= board.rows; ++row)
    for (int col = 0; col <= board.cols; ++col)
      if ((row + col) % 2 == 0) picture(cv::Rect((col + 1) * kCell, (row + 1) * kCell, kCell, kCell)).setTo(30);
}

void draw_tags(const Board& board, TagRows rows, cv::Mat& picture) {
  const double pitch = kCell * (1 + board.gap_m / board.size_m);
  for (int row = 0; row < board.rows; ++row)
    for (int col = 0; col < board.cols; ++col) {
      const int counted = rows == TagRows::from_above ? row : board.rows - 1 - row;
      cv::Mat tag;
      cv::resize(tag_image(board.family, counted * board.cols + col), tag, {kCell, kCell}, 0, 0, cv::INTER_NEAREST);
      tag.copyTo(picture(cv::Rect(kCell + cvRound(col * pitch), kCell + cvRound(row * pitch), kCell, kCell)));
    }
}

Print print(const Board& board, TagRows rows) {
  Print print;
  const double k = kCell / board.size_m;
  print.px_per_metre = k;
  Eigen::Vector2d most = Eigen::Vector2d::Zero();
  for (const Eigen::Vector3d& p : board_points(board)) most = most.cwiseMax(p.head<2>());
  const double rim = board.kind == BoardKind::chessboard || board.kind == BoardKind::charuco ? 2 : 1;
  print.origin = Eigen::Vector2d::Constant(-rim * board.size_m);
  print.texture = cv::Mat(cvRound(most.y() * k) + cvRound(2 * rim) * kCell,
                          cvRound(most.x() * k) + cvRound(2 * rim) * kCell, CV_8U, cv::Scalar(230));
  switch (board.kind) {
    case BoardKind::chessboard: draw_chessboard(board, print.texture); break;
    case BoardKind::apriltag: draw_tags(board, rows, print.texture); break;
    case BoardKind::circles:
      for (const Eigen::Vector3d& p : board_points(board))
        cv::circle(
            print.texture,
            cv::Point(cvRound((p.x() + board.size_m) * k * 16 - 8), cvRound((p.y() + board.size_m) * k * 16 - 8)),
            kCell * 16 / 4, cv::Scalar(30), cv::FILLED, cv::LINE_AA, 4);
      break;
    case BoardKind::charuco: {
      const auto layout = cv::aruco::CharucoBoard::create(
          board.cols, board.rows, static_cast<float>(board.size_m), static_cast<float>(board.marker_m),
          cv::aruco::getPredefinedDictionary(charuco_dictionary(board.family)));
      cv::Mat picture;
      layout->draw({board.cols * kCell, board.rows * kCell}, picture);
      picture.copyTo(print.texture(cv::Rect(kCell, kCell, picture.cols, picture.rows)));
      break;
    }
  }
  return print;
}

DrawnView draw(const Board& board, const Print& paper, int width, int height, const Pose& T_camera_board) {
  const double f = width;
  const auto pixel = [&](const Eigen::Vector3d& p) -> Eigen::Vector2d {
    return f * (T_camera_board * p).hnormalized() + Eigen::Vector2d((width - 1) / 2.0, (height - 1) / 2.0);
  };
  Eigen::Matrix3d plane;  // plane coordinates to the ray's direction
  plane << T_camera_board.linear().leftCols<2>(), T_camera_board.translation();
  const Eigen::Matrix3d inverse = plane.inverse();
  constexpr int kSamples = 4;
  cv::Mat x(height * kSamples, width * kSamples, CV_32F), y(x.size(), CV_32F), fine;
  for (int row = 0; row < x.rows; ++row)
    for (int col = 0; col < x.cols; ++col) {
      const double u = (col + 0.5) / kSamples - 0.5, v = (row + 0.5) / kSamples - 0.5;
      const Eigen::Vector2d p =
          (inverse * Eigen::Vector3d((u - (width - 1) / 2.0) / f, (v - (height - 1) / 2.0) / f, 1)).hnormalized();
      x.at<float>(row, col) = static_cast<float>((p.x() - paper.origin.x()) * paper.px_per_metre - 0.5);
      y.at<float>(row, col) = static_cast<float>((p.y() - paper.origin.y()) * paper.px_per_metre - 0.5);
    }
  cv::remap(paper.texture, fine, x, y, cv::INTER_LINEAR, cv::BORDER_CONSTANT, cv::Scalar(140));
  DrawnView view;
  cv::resize(fine, view.grey, {width, height}, 0, 0, cv::INTER_AREA);
  cv::GaussianBlur(view.grey, view.grey, {}, 0.6);
  cv::Mat noise(view.grey.size(), CV_16S), noisy;
  cv::RNG random(7);
  random.fill(noise, cv::RNG::NORMAL, 0, 1.5);
  view.grey.convertTo(noisy, CV_16S);
  cv::Mat(noisy + noise).convertTo(view.grey, CV_8U);

  std::vector<cv::Point2f> points, hull;
  for (const Eigen::Vector3d& p : board_points(board)) {
    view.pixels.push_back(pixel(p));
    points.emplace_back(static_cast<float>(view.pixels.back().x()), static_cast<float>(view.pixels.back().y()));
  }
  cv::convexHull(points, hull);
  view.coverage = cv::contourArea(hull) / (width * height);
  return view;
}

}  // namespace

DrawnView draw_board(const Board& board, int width, int height, double roll_deg, double tilt_deg, TagRows rows) {
  const Print paper = print(board, rows);
  const double w = paper.texture.cols / paper.px_per_metre, h = paper.texture.rows / paper.px_per_metre;
  const double distance = std::max(w / 0.8, h * width / (0.8 * height));
  Pose T = Pose::Identity();
  T.linear() = (Eigen::AngleAxisd(-tilt_deg * CV_PI / 180, Eigen::Vector3d::UnitY()) *
                Eigen::AngleAxisd(roll_deg * CV_PI / 180, Eigen::Vector3d::UnitZ()))
                   .toRotationMatrix();
  T.translation() = Eigen::Vector3d(0, 0, distance) -
                    T.linear() * Eigen::Vector3d(paper.origin.x() + w / 2, paper.origin.y() + h / 2, 0);
  return draw(board, paper, width, height, T);
}

DrawnView draw_board_at(const Board& board, int width, int height, const Pose& T_camera_board) {
  return draw(board, print(board, TagRows::from_above), width, height, T_camera_board);
}

}  // namespace foresight
