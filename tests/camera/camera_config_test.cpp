#include "drivers/camera/camera_config.hpp"

#include "scene/yaml_fields.hpp"
#include "tests/scene/test_run.hpp"

namespace foresight::camera_config_test {
namespace {

using testing::HasSubstr;

/// A valid section whose text a test changes.
class CamerasOfARig : public testing::Test {
 protected:
  std::string text_ = R"(pairing_tolerance_s: 0.005
left: {driver: v4l2, device: /dev/video0, format: mjpeg, size_px: [640, 480], rate_hz: 60, exposure_s: 0.004,
       readout_s: 0.01, controls: {gain: 7, brightness: -3}}
right: {driver: v4l2, serial: A2, format: mjpeg, rate_hz: 60}
)";

  StereoConfig read() { return read_stereo_config(YamlMap::load(folder_.write("rig.yaml", text_))); }
  std::string error_with(const std::string& what, const std::string& instead) {
    const std::string kept = text_;
    const auto at = text_.find(what);
    EXPECT_NE(at, std::string::npos) << what;
    text_.replace(at, what.size(), instead);
    const std::string error = input_error([&] { read(); });
    text_ = kept;
    return error;
  }
  TempFolder folder_;
};

TEST_F(CamerasOfARig, AreReadWhole) {
  const StereoConfig config = read();
  EXPECT_EQ(config.pairing.tolerance, seconds(0.005));
  EXPECT_FALSE(config.mock());
  const CameraConfig& left = config.camera(Side::left);
  EXPECT_EQ(left.driver, CameraDriver::v4l2);
  EXPECT_EQ(left.device, "/dev/video0");
  EXPECT_EQ(left.settings.format, PixelFormat::mjpeg);
  EXPECT_EQ(left.settings.width, 640);
  EXPECT_EQ(left.settings.height, 480);
  EXPECT_EQ(left.settings.rate, 60);
  EXPECT_EQ(left.settings.exposure, seconds(0.004));
  EXPECT_EQ(left.settings.readout, seconds(0.01));
  EXPECT_EQ(left.settings.controls, (std::map<std::string, std::int64_t>{{"gain", 7}, {"brightness", -3}}));
  EXPECT_EQ(config.camera(Side::right).device, "serial:A2");
}

TEST_F(CamerasOfARig, TheToleranceFollowsTheRate) {
  text_.erase(0, text_.find("left"));
  EXPECT_LT(to_seconds(read().pairing.tolerance), 0.5 / 60);
}

TEST_F(CamerasOfARig, EveryMistakeHasItsMessage) {
  const auto expect = [&](const char* what, const char* instead, std::initializer_list<const char*> words) {
    const std::string message = error_with(what, instead);
    EXPECT_THAT(message, HasSubstr("rig.yaml")) << instead;
    for (const char* word : words) EXPECT_THAT(message, HasSubstr(word)) << instead;
  };
  expect("left:", "lift:", {"lift", "left"});
  expect("driver: v4l2", "driver: v4l", {"left.driver", "'v4l'", "v4l2"});
  expect("format: mjpeg", "format: jpeg", {"jpeg", "mjpeg"});
  expect("exposure_s: 0.004", "exposure: 0.004", {"exposure", "did you mean 'exposure_s'"});
  expect("rate_hz: 60", "rate: 60", {"did you mean 'rate_hz'"});
  expect("pairing_tolerance_s", "pairing_tolerance", {"did you mean 'pairing_tolerance_s'"});
  expect("exposure_s: 0.004", "exposure_s: 4", {"exposure_s", "longer than a frame period"});
  expect("exposure_s: 0.004", "exposure_s: .nan", {"exposure_s"});
  expect("rate_hz: 60", "rate_hz: -1", {"rate_hz", "above 0"});
  expect("rate_hz: 60", "rate_hz: 30", {"another rate_hz"});
  expect("size_px: [640, 480]", "size_px: [640]", {"size_px", "2"});
  expect("size_px: [640, 480]", "size_px: [640.5, 480]", {"size_px", "whole numbers"});
  expect("pairing_tolerance_s: 0.005", "pairing_tolerance_s: 0.01", {"half a frame period", "0.0083"});
  expect("serial: A2", "device: /dev/video0", {"same device", "/dev/video0"});
  expect("serial: A2", "serial: A2, device: x", {"beside a device"});
  expect("serial: A2, ", "", {"device", "missing"});
  expect("gain: 7", "gain: high", {"gain", "integer"});
  expect("gain: 7", "gain: 7, gain: 8", {"gain", "twice"});
  expect("driver: v4l2, serial: A2, format: mjpeg", "driver: mock", {"another world"});
  expect("driver: v4l2, serial: A2, format: mjpeg", "driver: images, device: x, format: mjpeg", {"format", "images"});
  expect("driver: v4l2, serial: A2", "driver: libcamera, serial: A2", {"serial", "libcamera"});
  expect("serial: A2", "serial: A2, lens: none.yaml", {"none.yaml", "no file"});
}

TEST_F(CamerasOfARig, MockOnesNeedNoDevice) {
  text_ = "left: {driver: mock, size_px: [320, 240]}\nright: {driver: mock, size_px: [320, 240]}\n";
  EXPECT_TRUE(read().mock());
  EXPECT_THAT(error_with("driver: mock", "driver: mock, device: x"), HasSubstr("device"));
  EXPECT_THAT(error_with("[320, 240]", "[322, 240]"), HasSubstr("another size"));
  EXPECT_THAT(error_with("[320, 240]", "[321, 240]"), HasSubstr("odd width"));
}

TEST_F(CamerasOfARig, TheLensBringsItsSize) {
  folder_.write("left.yaml", kCamera);
  text_.replace(text_.find("size_px: [640, 480]"), 19, "lens: left.yaml");
  const StereoConfig config = read();
  ASSERT_TRUE(config.camera(Side::left).calibration);
  EXPECT_EQ(config.camera(Side::left).settings.width, config.camera(Side::left).calibration->lens.width());
  EXPECT_THAT(error_with("lens: left.yaml", "lens: left.yaml, size_px: [640, 481]"), HasSubstr("calibrated at"));
  EXPECT_THAT(error_with("serial: A2", "serial: A2, lens: left.yaml"), HasSubstr("T_left_right"));
}

TEST(CameraByName, KnowsLibcamera) {
  EXPECT_EQ(camera_by_name("serial:A1").driver, CameraDriver::v4l2);
  EXPECT_EQ(camera_by_name("serial:A1").device, "serial:A1");
  EXPECT_EQ(camera_by_name("libcamera:\\_SB_.PCI0-1").driver, CameraDriver::libcamera);
  EXPECT_EQ(camera_by_name("libcamera:\\_SB_.PCI0-1").device, "\\_SB_.PCI0-1");
}

}  // namespace
}  // namespace foresight::camera_config_test
