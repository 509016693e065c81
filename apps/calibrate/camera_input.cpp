#include "apps/calibrate/camera_input.hpp"

#include <chrono>

#include "apps/command_line/picture_size.hpp"
#include "calibration/target/corner_files.hpp"
#include "calibration/target/image_input.hpp"
#include "common/error.hpp"
#include "common/patient_output.hpp"

namespace foresight {
namespace {

constexpr int kLargestSide = 32768;  // px
constexpr std::chrono::seconds kBetweenLines{2};

RigViews read_corner_file(const std::filesystem::path& path, const CornerInput& input, bool pair) {
  const std::optional<Board> board =
      input.board.empty() ? std::nullopt : std::optional<Board>(parse_board(input.board));
  RigViews views = pair ? rig_views(read_stereo_corners(path, board)) : rig_views(read_corners(path, board));
  const auto size =
      input.size.empty() ? std::array{0, 0} : size_option(input.size, {16, 16}, {kLargestSide, kLargestSide});
  for (std::size_t c = 0; c < 2; ++c)
    if (views.width[c] == 0) views.width[c] = size[0], views.height[c] = size[1];
  return views;
}

void note_dropped(const std::vector<DroppedView>& dropped, std::vector<std::string>& notes) {
  for (const DroppedView& view : dropped) notes.push_back("view " + view.name + " is not used: " + view.reason);
}

/// Lines about images that are looked at, where it takes more than a moment.
LookingAt told_on_stderr() {
  using Time = std::chrono::steady_clock;
  return [last = Time::now()](const std::filesystem::path& file, std::size_t before, std::size_t all) mutable {
    if (Time::now() - last < kBetweenLines) return;
    last = Time::now();
    patient_stderr().say("calibrate: looking for the board in image " + std::to_string(before + 1) + " of " +
                         std::to_string(all) + ", " + file.string() + "\n");
  };
}

RigViews find_in_images(const CornerInput& input, CameraViewsInput& read) {
  if (input.board.empty())
    throw InputError("--board", "is missing", "say what is in the images, such as chessboard:9x6:0.025");
  const Board board = parse_board(input.board);
  if (input.images) {
    const FoundCorners found = find_in_folder(*input.images, board, told_on_stderr());
    note_dropped(found.dropped, read.notes);
    read.files = found.files;
    return rig_views(found.corners);
  }
  const FoundStereoCorners found = find_pairs_in_folders(*input.left, *input.right, board, told_on_stderr());
  note_dropped(found.dropped, read.notes);
  read.files = found.files;
  return rig_views(found.corners);
}

void require_one_source(const CornerInput& input, bool pair) {
  const bool images = pair ? input.left && input.right : input.images.has_value();
  const std::string options = pair ? "--left and --right" : "--images";
  if (pair && input.left.has_value() != input.right.has_value())
    throw InputError(input.left ? "--right" : "--left", "is missing", "give both folders of the pair");
  if (input.corners.has_value() == images)
    throw InputError("--corners", images ? "stands beside " + options : "is missing, and so is " + options,
                     "give either corners or images");
}

}  // namespace

void add_camera_input(Command& command, CornerInput& input, bool pair) {
  command
      .add_option("--corners", input.corners,
                  pair ? "Corners found before: mrcal .vnl, or a folder with cam0/ and cam1/"
                       : "Corners found before: mrcal .vnl, or a folder of .csv")
      ->reads();
  if (pair) {
    command.add_option("--left", input.left, "Folder of the left images, or a pattern such as 'pictures/left*.jpg'")
        ->reads();
    command.add_option("--right", input.right, "Folder of the right images, or a pattern")->reads();
  } else {
    command.add_option("--images", input.images, "Folder of images, or a pattern such as 'pictures/left*.jpg'")
        ->reads();
  }
  command.add_option("--board", input.board, "KIND:COLSxROWS:SIZE_M, such as chessboard:9x6:0.025");
  command.add_option("--test-corners", input.test_corners, "Corners that only score, not solve")->reads();
  command.add_option("--size", input.size, "WIDTHxHEIGHT of the images, where --corners does not say it");
}

CameraViewsInput read_camera_input(const CornerInput& input, bool pair) {
  require_one_source(input, pair);
  CameraViewsInput read;
  read.train = input.corners ? read_corner_file(*input.corners, input, pair) : find_in_images(input, read);
  if (input.test_corners) {
    read.test = read_corner_file(*input.test_corners, input, pair);
    const bool same = read.test.p_board.size() == read.train.p_board.size() &&
                      std::equal(read.test.p_board.begin(), read.test.p_board.end(), read.train.p_board.begin(),
                                 [](const auto& a, const auto& b) { return (a - b).norm() < 1e-9; });
    if (!same)
      throw InputError("--test-corners", "they are of another board", "give corners of the board that is solved with");
  } else {
    read.test = subset(read.train, {});
  }
  return read;
}

}  // namespace foresight
