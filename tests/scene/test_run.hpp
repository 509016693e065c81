// A small valid run in a temporary folder, which a test then damages.
#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <unistd.h>
#include <atomic>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <opencv2/imgcodecs.hpp>
#include <string>

#include "common/error.hpp"
#include "tests/support/folders.hpp"

namespace foresight {

/// Removed with all its content at the end of its life.
class TempFolder {
 public:
  TempFolder() {
    static std::atomic<int> count = 0;
    path_ = std::filesystem::canonical(std::filesystem::temp_directory_path()) /
            ("foresight_" + std::to_string(getpid()) + "_" + std::to_string(count++));
    std::filesystem::create_directories(path_);
  }
  ~TempFolder() { std::filesystem::remove_all(path_); }
  TempFolder(const TempFolder&) = delete;

  const std::filesystem::path& path() const { return path_; }
  std::filesystem::path operator/(const std::string& name) const { return path_ / name; }

  std::filesystem::path write(const std::string& name, const std::string& content) const {
    const auto file = path_ / name;
    std::filesystem::create_directories(file.parent_path());
    std::ofstream(file, std::ios::binary) << content;
    return file;
  }
  std::string read(const std::string& name) const {
    std::ifstream stream(path_ / name, std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), {}};
  }

 private:
  std::filesystem::path path_;
};

/// The text of the InputError that `action` throws; "no error" where it throws nothing.
template <typename Action>
std::string input_error(Action&& action) {
  try {
    action();
  } catch (const InputError& error) {
    return error.what();
  }
  return "no error";
}

/// Matches a message that names a place, a fault and a cure, each by a part of its text.
inline auto says(const std::string& where, const std::string& what, const std::string& cure) {
  return testing::AllOf(testing::HasSubstr(where), testing::HasSubstr(what), testing::HasSubstr("; "),
                        testing::HasSubstr(cure));
}

inline const std::string kCamera = R"(image_width: 8
image_height: 6
camera_name: test
camera_matrix: {rows: 3, cols: 3, data: [10, 0, 3.5, 0, 11, 2.5, 0, 0, 1]}
distortion_model: plumb_bob
distortion_coefficients: {rows: 1, cols: 5, data: [0.1, -0.02, 0.001, 0.002, 0.003]}
)";

inline const std::string kTriangle = R"(ply
format ascii 1.0
element vertex 3
property float x
property float y
property float z
element face 1
property list uchar int vertex_indices
end_header
0 0 1
1 0 1
0 1 1
3 0 1 2
)";

inline std::string encoded(const std::string& extension, const cv::Mat& pixels) {
  std::vector<uchar> bytes;
  cv::imencode(extension, pixels, bytes);
  return {bytes.begin(), bytes.end()};
}

/// 8 x 6 pixels, each another value.
inline cv::Mat test_pixels(int type = CV_8UC3) {
  cv::Mat pixels(6, 8, type);
  for (int i = 0; i < static_cast<int>(pixels.total() * pixels.elemSize()); ++i)
    pixels.data[i] = static_cast<uchar>(i * 37);
  return pixels;
}

/// Three images at 1700000000 s and every 0.1 s after, with a pose each; one triangle.
class TestRun : public TempFolder {
 public:
  TestRun() {
    write("camera.yaml", kCamera);
    write("scene.ply", kTriangle);
    write("rgb.txt", "# time file\n1700000000.000000001 rgb/a.png\n1700000000.1 rgb/b.png\n1700000000.2 rgb/c.jpg\n");
    write("trajectory.txt", "1700000000.0 0 0 0 0 0 0 1\n1700000000.1 1 0 0 0 0 0 1\n1700000000.2 2 0 0 0 0 0 1\n");
    write("rgb/a.png", encoded(".png", test_pixels()));
    write("rgb/b.png", encoded(".png", test_pixels(CV_8UC1)));
    write("rgb/c.jpg", encoded(".jpg", test_pixels()));
  }
};

/// Skips the test where `folder` is absent.
#define FORESIGHT_NEED_DATA(folder)                     \
  if (!std::filesystem::exists(data_folder() / folder)) \
  GTEST_SKIP() << "no recorded data at " << data_folder() / folder << "; set FORESIGHT_DATA"

}  // namespace foresight
