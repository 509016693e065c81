#include "tests/camera/emulated_cameras.hpp"

#include <algorithm>
#include <cstdlib>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "drivers/camera/v4l2_device.hpp"

namespace foresight {
namespace {

using namespace std::chrono_literals;
namespace fs = std::filesystem;

cv::Mat thumbnail(const cv::Mat& image) {
  cv::Mat out;
  cv::resize(image, out, {image.cols / 8, image.rows / 8}, 0, 0, cv::INTER_AREA);
  return out;
}

}  // namespace

EmulatedCamera::EmulatedCamera(std::size_t side, const fs::path& pictures) {
  const fs::path program = fs::read_symlink("/proc/self/exe").parent_path() / "usb_camera";
  const std::string command = program.string() + " " + std::to_string(side) + " " + (side == 0 ? "left" : "right") +
                              " " + pictures.string() + " >/dev/null";
  process_ = popen(command.c_str(), "we");
}

void EmulatedCamera::disturb(const char* what) {
  std::fprintf(process_, "%s\n", what);
  std::fflush(process_);
}

std::array<std::unique_ptr<EmulatedCamera>, 2> EmulatedCameras::emulated_;

void EmulatedCameras::SetUp() {
  const char* const run = std::getenv("FORESIGHT_PICTURES");
  if (run == nullptr) GTEST_SKIP() << "FORESIGHT_PICTURES names no stereo run; see scripts/test-devices";
  if (!fs::exists("/sys/devices/platform/vhci_hcd.0/attach")) GTEST_SKIP() << "no vhci_hcd.0; modprobe vhci-hcd";
  for (std::size_t side : {0, 1}) {
    folders_[side] = fs::path(run) / (side == 0 ? "rgb" : "rgb_right");
    std::vector<fs::path> files;
    for (const auto& entry : fs::directory_iterator(folders_[side])) files.push_back(entry.path());
    std::sort(files.begin(), files.end());
    for (const fs::path& file : files) pictures_[side].push_back(cv::imread(file.string()));
    for (const cv::Mat& picture : pictures_[side]) thumbnails_[side].push_back(thumbnail(picture));
  }
  for (std::size_t side : {0, 1})
    if (!emulated_[side]) plug_in(side);
}

void EmulatedCameras::TearDownTestSuite() {
  for (auto& camera : emulated_) camera.reset();
}

std::string EmulatedCameras::selector(std::size_t side) {
  return std::string("serial:") + kNames[side];
}

bool EmulatedCameras::is_there(std::size_t side) {
  return v4l2::find_device(v4l2::system_calls(), selector(side), "test").has_value();
}

void EmulatedCameras::plug_in(std::size_t side) {
  // One after the other: the controller takes no second device while it resets the first.
  emulated_[side] = std::make_unique<EmulatedCamera>(side, folders_[side]);
  for (int i = 0; i < 600 && !is_there(side); ++i) clock_.sleep_until(clock_.now() + 50ms);
  ASSERT_TRUE(is_there(side)) << "camera " << kNames[side] << " did not appear";
}

CameraSettings EmulatedCameras::settings_of(std::size_t side, PixelFormat format, double rate) const {
  CameraSettings out;
  out.width = pictures_[side][0].cols;
  out.height = pictures_[side][0].rows;
  out.format = format;
  out.rate = rate;
  return out;
}

std::unique_ptr<StereoCamera> EmulatedCameras::pair_of(std::unique_ptr<Camera> left, std::unique_ptr<Camera> right) {
  PairingOptions options;
  options.largest_age = 5s;  // a machine that is held up is late
  return std::make_unique<StereoCamera>(std::move(left), std::move(right), clock_, options);
}

bool EmulatedCameras::becomes(Camera& camera, CameraStatus wanted) {
  CameraFrame frame;
  for (int i = 0; i < 100; ++i)
    if (camera.wait_frame(200ms, frame) == wanted) return true;
  return false;
}

std::size_t EmulatedCameras::number_of(std::size_t side, const cv::Mat& image) const {
  const cv::Mat small = thumbnail(image);
  std::size_t best = 0;
  double least = 1e300;
  for (std::size_t i = 0; i < thumbnails_[side].size(); ++i) {
    const double difference = cv::norm(small, thumbnails_[side][i], cv::NORM_L1);
    if (difference < least) {
      least = difference;
      best = i;
    }
  }
  return best;
}

void EmulatedCameras::expect_the_lab(Camera& camera, std::size_t side, int frames) {
  const char* const format = to_string(camera.settings().format);
  CameraFrame frame;
  RobotTime last{};
  std::size_t number = 0, changes = 0;
  for (int i = 0; i < frames; ++i) {
    ASSERT_EQ(camera.wait_frame(2s, frame), CameraStatus::ok) << format;
    EXPECT_GT(frame.time, last);
    EXPECT_LT(std::chrono::abs(clock_.now() - frame.time), 2s);  // an emulated machine is slow, and may be held up
    last = frame.time;
    cv::Mat image;
    ASSERT_EQ(to_bgr(frame, image), Conversion::ok);
    const std::size_t shown = number_of(side, image);
    if (i > 0 && shown != number) ++changes;
    number = shown;
    // Half the colours' resolution, and JPEG's quantisation, cost that much; a wrong matrix or picture far more.
    EXPECT_GT(cv::PSNR(image, pictures_[side][shown]), 28) << format << " picture " << shown;
  }
  // Not all: after a pause of just all pictures the next frame shows the same one.
  EXPECT_GE(changes + 2, static_cast<std::size_t>(frames)) << "the picture stands still";
}

}  // namespace foresight
