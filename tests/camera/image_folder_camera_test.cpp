#include "drivers/camera/image_folder_camera.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <fstream>
#include <opencv2/imgcodecs.hpp>

#include "common/error.hpp"

namespace foresight::image_folder_camera_test {
namespace {

using namespace std::chrono_literals;

class ImageFolder : public testing::Test {
 protected:
  ImageFolder() : folder_(std::filesystem::path(testing::TempDir()) / ("image_folder_" + std::to_string(getpid()))) {
    std::filesystem::create_directories(folder_);
    for (int i : {1, 2, 10}) write("left_" + std::to_string(i) + ".png", i);
    write("right_1.png", 99);
    std::ofstream(folder_ / "notes_1.txt") << "no image";
  }
  ~ImageFolder() override { std::filesystem::remove_all(folder_); }
  void write(const std::string& name, int value) {
    cv::imwrite((folder_ / name).string(), cv::Mat(4, 6, CV_8UC3, cv::Scalar::all(value)));
  }

  std::filesystem::path folder_;
  SteppedClock clock_;
};

TEST_F(ImageFolder, PlaysInOrderOfNumbersAtTheRate) {
  ImageFolderCamera camera("left", folder_, {.prefix = "left_", .rate = 10, .repeat = false}, clock_);
  camera.start();
  EXPECT_EQ(camera.settings().width, 6);
  CameraFrame frame;
  EXPECT_EQ(camera.wait_frame(50ms, frame), CameraStatus::timeout);
  for (int value : {1, 2, 10}) {
    ASSERT_EQ(camera.wait_frame(200ms, frame), CameraStatus::ok);
    EXPECT_EQ(frame.bytes[0], value);
    EXPECT_EQ(frame.time, clock_.now());
    cv::Mat out;
    EXPECT_EQ(to_bgr(frame, out), Conversion::ok);
  }
  EXPECT_EQ(Duration{clock_.now().ns}, 300ms);
  EXPECT_EQ(camera.wait_frame(200ms, frame), CameraStatus::lost) << "at the end";
}

TEST_F(ImageFolder, RepeatsAndSkipsWhatWasMissed) {
  ImageFolderCamera camera("left", folder_, {.prefix = "left_", .rate = 10, .repeat = true}, clock_);
  camera.start();
  CameraFrame frame;
  for (int i = 0; i < 7; ++i) ASSERT_EQ(camera.wait_frame(200ms, frame), CameraStatus::ok);
  EXPECT_EQ(frame.sequence, 6u);
  EXPECT_EQ(frame.bytes[0], 1);
  clock_.sleep_until(clock_.now() + 1s);
  ASSERT_EQ(camera.wait_frame(200ms, frame), CameraStatus::ok);
  ASSERT_EQ(camera.wait_frame(200ms, frame), CameraStatus::ok);
  EXPECT_GT(frame.sequence, 15u);
  EXPECT_GT(camera.counters().gaps, 7u);
}

TEST_F(ImageFolder, ADamagedFileIsACorruptFrame) {
  std::ofstream(folder_ / "left_2.png") << "no image";
  ImageFolderCamera camera("left", folder_, {.prefix = "left_", .rate = 10, .repeat = false}, clock_);
  camera.start();
  CameraFrame frame;
  EXPECT_EQ(camera.wait_frame(1s, frame), CameraStatus::ok);
  EXPECT_EQ(camera.wait_frame(1s, frame), CameraStatus::corrupt);
  EXPECT_EQ(camera.wait_frame(1s, frame), CameraStatus::ok);
}

TEST_F(ImageFolder, SaysWhatIsWrong) {
  EXPECT_THROW(ImageFolderCamera("left", folder_ / "none", {}, clock_), InputError);
  EXPECT_THROW(ImageFolderCamera("left", folder_, {}, clock_), InputError) << "left_1 and right_1";
  EXPECT_THROW(ImageFolderCamera("left", folder_, {.prefix = "l", .rate = 1, .repeat = true}, clock_), InputError);
  EXPECT_THROW(ImageFolderCamera("left", folder_, {.prefix = "left_", .rate = 0, .repeat = true}, clock_), InputError);
}

}  // namespace
}  // namespace foresight::image_folder_camera_test
