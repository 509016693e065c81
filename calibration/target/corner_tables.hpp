// The rows of corner files, checked one by one (corner_files.hpp says what they look like).
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "calibration/target/corner_set.hpp"

namespace foresight {

/// One image of an mrcal .vnl file.
struct VnlImage {
  std::string name;             ///< as in the file
  int line = 0;                 ///< of its first row
  std::vector<Corner> corners;  ///< those that were seen, ascending
};

/// `points`: how many the board has, and so rows of every image that shows it. Throws InputError
/// naming file and line.
std::vector<VnlImage> read_vnl(const std::filesystem::path& file, std::size_t points);

/// One row of a kalibr-like CSV file.
struct TagRow {
  std::string where;  ///< "file:line"
  long long tag = 0;
  long long corner = 0;
  Eigen::Vector2d pixel;
  Eigen::Vector3d p_board;
};

/// May be empty where the file is. Throws InputError naming file and line.
std::vector<TagRow> read_tag_table(const std::filesystem::path& file);

}  // namespace foresight
