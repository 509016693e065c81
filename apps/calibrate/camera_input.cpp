#include "apps/calibrate/camera_input.hpp"

#include "calibration/target/corner_files.hpp"
#include "common/error.hpp"
#include "common/text.hpp"

namespace foresight {
namespace {

std::array<int, 2> parse_size(const std::string& text) {
  if (text.empty()) return {0, 0};
  const auto x = text.find('x');
  const auto w = parse_integer(text.substr(0, x));
  const auto h = x == std::string::npos ? std::nullopt : parse_integer(text.substr(x + 1));
  if (!w || !h || *w < 16 || *h < 16 || *w > 32768 || *h > 32768)
    throw InputError("--size", in_quotes(text) + " is no image size", "give WIDTHxHEIGHT in pixels, such as 640x480");
  return {static_cast<int>(*w), static_cast<int>(*h)};
}

RigViews read_file(const std::filesystem::path& path, const CameraInput& input, bool pair) {
  const std::optional<Board> board =
      input.board.empty() ? std::nullopt : std::optional<Board>(parse_board(input.board));
  RigViews views = pair ? rig_views(read_stereo_corners(path, board)) : rig_views(read_corners(path, board));
  const auto size = parse_size(input.size);
  for (std::size_t c = 0; c < 2; ++c)
    if (views.width[c] == 0) views.width[c] = size[0], views.height[c] = size[1];
  return views;
}

}  // namespace

void add_camera_input(CLI::App& command, CameraInput& input, bool pair) {
  command.add_option("--corners", input.corners,
                     pair ? "Corners found before: mrcal .vnl, or a folder with cam0/ and cam1/"
                          : "Corners found before: mrcal .vnl, or a folder of .csv");
  command.add_option("--board", input.board, "KIND:COLSxROWS:SIZE_M, such as chessboard:9x6:0.025");
  command.add_option("--test-corners", input.test_corners, "Corners that only score, not solve");
  command.add_option("--size", input.size, "WIDTHxHEIGHT of the images, where --corners does not say it");
}

CameraViewsInput read_camera_input(const CameraInput& input, bool pair) {
  if (!input.corners) throw InputError("--corners", "is missing", "give the corners to calibrate from");
  CameraViewsInput read;
  read.train = read_file(*input.corners, input, pair);
  if (input.test_corners) {
    read.test = read_file(*input.test_corners, input, pair);
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
