// From folders of pictures to corners: reading, finding and refusing, on all cores.
#pragma once

#include <array>
#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "calibration/target/find_corners.hpp"

namespace foresight {

/// A view that is not used, and why, in words for the user.
struct DroppedView {
  std::string name;
  std::string reason;
};

/// Files of views, by the views' names: left or the only one, right.
using PicturesOfViews = std::map<std::string, std::array<std::filesystem::path, 2>>;

struct FoundCorners {
  Board board;  ///< with what was found from the images
  CornerSet corners;
  std::vector<DroppedView> dropped;
  PicturesOfViews files;
};

struct FoundStereoCorners {
  Board board;
  StereoCorners corners;
  std::vector<DroppedView> dropped;  ///< named after the file, or after the pair
  PicturesOfViews files;
};

/// Pictures of a folder (png jpg jpeg bmp pgm tif tiff), or those that a pattern in the last part of
/// the path names ("pictures/left*.png"); sorted by the numbers in their names. Throws InputError
/// where there is none.
std::vector<std::filesystem::path> list_images(const std::filesystem::path& folder);

/// Files of both cameras that belong together, [left, right]: by name (split_side()) or, where no name fits and both
/// hold equally many, by order. Throws like list_images(), and where nothing fits.
std::vector<std::array<std::filesystem::path, 2>> list_pairs(const std::filesystem::path& left,
                                                             const std::filesystem::path& right);

/// Told before each file that is looked at, how many have been before and how many there are. One call at a time, from
/// any thread.
using LookingAt = std::function<void(const std::filesystem::path& file, std::size_t before, std::size_t all)>;

/// Views in the order of list_images(), named by the stem of their files. Left out with a reason:
/// images without the board, and blurred ones (sharpness below half the median). Throws InputError:
/// no image, unreadable image, sizes that differ (naming two), the board in none (naming what fits).
FoundCorners find_in_folder(const std::filesystem::path& folder, const Board& board, const LookingAt& looking = {});

/// The same for these files, at least one, in their order.
FoundCorners find_in_files(const std::vector<std::filesystem::path>& files, const Board& board,
                           const LookingAt& looking = {});

/// Pairs by name (split_side() of the path's file name); where no name fits and both folders hold
/// equally many, by their order. A blurred image drops its pair; a board seen by one camera
/// stays for that camera's sake. Throws like find_in_folder, and where no pair shows the board.
FoundStereoCorners find_pairs_in_folders(const std::filesystem::path& left, const std::filesystem::path& right,
                                         const Board& board, const LookingAt& looking = {});

}  // namespace foresight
