// A pair of USB cameras under the kernel's usbcore and uvcvideo, which are emulated (tests/devices/usb_camera) and show
// the stereo images of a run. Needs "modprobe vhci-hcd uvcvideo", root, and the run's folder in FORESIGHT_PICTURES.
#pragma once

#include <gtest/gtest.h>

#include <cstdio>
#include <filesystem>
#include <opencv2/core.hpp>

#include "common/clock.hpp"
#include "drivers/camera/stereo_camera.hpp"

namespace foresight {

/// Plugged in from construction to destruction.
class EmulatedCamera {
 public:
  EmulatedCamera(std::size_t side, const std::filesystem::path& pictures);
  ~EmulatedCamera() { pclose(process_); }
  EmulatedCamera(const EmulatedCamera&) = delete;
  EmulatedCamera& operator=(const EmulatedCamera&) = delete;

  void disturb(const char* what);  ///< UvcStream::disturb()

 private:
  std::FILE* process_;
};

/// The tests of a suite share the cameras: to plug one in takes seconds. Skips where they cannot be.
class EmulatedCameras : public testing::Test {
 protected:
  void SetUp() override;
  static void TearDownTestSuite();

  static std::string selector(std::size_t side);  ///< of the V4L2 driver; 0: left
  static bool is_there(std::size_t side);
  void plug_in(std::size_t side);
  CameraSettings settings_of(std::size_t side, PixelFormat format, double rate) const;
  std::unique_ptr<StereoCamera> pair_of(std::unique_ptr<Camera> left, std::unique_ptr<Camera> right);
  static bool becomes(Camera& camera, CameraStatus wanted);  ///< among the next 100
  /// Until that is true of the pair's status, 15 s at most.
  template <typename Condition>
  static bool comes_to(StereoCamera& stereo, Condition condition) {
    for (int i = 0; i < 150; ++i) {
      stereo.take(std::chrono::milliseconds(100));
      if (condition(stereo.status())) return true;
    }
    return false;
  }
  /// The number of the picture that looks most like `image`.
  std::size_t number_of(std::size_t side, const cv::Mat& image) const;
  /// Frames of now, each of another picture than the one before, and the colours are right.
  void expect_the_lab(Camera& camera, std::size_t side, int frames);

  static constexpr const char* kNames[] = {"left", "right"};
  static std::array<std::unique_ptr<EmulatedCamera>, 2> emulated_;
  MonotonicClock clock_;
  std::array<std::filesystem::path, 2> folders_;
  std::array<std::vector<cv::Mat>, 2> pictures_, thumbnails_;
};

}  // namespace foresight
