// The views of a calibration as a reader wants to see them: numbered as in their set, with what was found in each.
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <opencv2/core.hpp>
#include <span>
#include <string>
#include <vector>

namespace foresight {

/// A point in an image of its full size, px.
struct ShownPoint {
  Eigen::Vector2d found;
  Eigen::Vector2d predicted;  ///< by the solution; not finite: not known
};

/// An arrow's length over that of the error that it shows.
inline constexpr double kArrow = 20;

/// The picture in `file`, made small: a green ring where each point was found, and an arrow towards where the solution
/// has it, kArrow times too long. Throws what read_picture() does.
cv::Mat draw_view(const std::filesystem::path& file, std::span<const ShownPoint> points);

/// The number in each name where every name has another one, else 1, 2, ...
std::vector<int> view_numbers(const std::vector<std::string>& names);

/// At most `most` indices below `count`, evenly.
std::vector<std::size_t> some_of(std::size_t count, std::size_t most);

}  // namespace foresight
