#include "drivers/camera/libcamera_unplug.hpp"

#include <gmock/gmock.h>
#include <unistd.h>

namespace foresight::libcam::libcamera_unplug_test {
namespace {

namespace fs = std::filesystem;

TEST(LibcameraUnplug, FindsTheUsbInterfacesOfAnId) {
  const fs::path bus = fs::path(testing::TempDir()) / ("usb_" + std::to_string(getpid()));
  for (const char* name : {"1-2", "1-2:1.0", "1-2:1.1", "1-2.4:1.0", "2-12:1.0", "3-2:1.0", "usb1"})
    fs::create_directories(bus / name);
  using testing::UnorderedElementsAre;
  EXPECT_THAT(usb_interfaces("\\_SB_.PCI0.XHCI-2.4:1.0-046d:082d", bus), UnorderedElementsAre(bus / "1-2.4:1.0"));
  EXPECT_THAT(usb_interfaces("\\_SB_.PCI0.XHCI-2:1.0-046d:082d", bus),
              UnorderedElementsAre(bus / "1-2:1.0", bus / "3-2:1.0"));
  for (const char* other :
       {"", "-", "--", "platform/vimc.0 Sensor B", "/base/soc/i2c0mux/i2c@1/ov5647@36", "-9:1.0-1:2"})
    EXPECT_TRUE(usb_interfaces(other, bus).empty()) << other;
  EXPECT_TRUE(usb_interfaces("\\_SB_-2:1.0-046d:082d", bus / "none").empty());
  fs::remove_all(bus);
}

class Countable final : public Session {
 public:
  Countable(int& alive, const bool& gone) : alive_(alive), gone_(gone) { ++alive_; }
  ~Countable() override { --alive_; }
  std::optional<Finished> wait(Duration) noexcept override { return std::nullopt; }
  bool give_back(std::size_t) noexcept override { return false; }
  bool gone() const noexcept override { return gone_; }
  const CameraSettings& settings() const noexcept override { return settings_; }
  std::size_t buffers() const noexcept override { return 0; }
  std::size_t stride() const noexcept override { return 0; }
  std::vector<CameraControl> controls() const override { return {}; }
  void set_control(const std::string&, std::int64_t) override {}

 private:
  int& alive_;
  const bool& gone_;
  CameraSettings settings_;
};

TEST(LibcameraUnplug, SessionsEndWhenTheyWereTold) {
  int alive = 0;
  bool left = false, right = false;
  VanishedSessions sessions;
  sessions.add(std::make_unique<Countable>(alive, left));
  sessions.add(std::make_unique<Countable>(alive, right));
  sessions.end_those_told();
  EXPECT_EQ(alive, 2);
  right = true;
  sessions.end_those_told();
  EXPECT_EQ(alive, 1);
  left = true;
  sessions.end_those_told();
  EXPECT_EQ(alive, 0);
}

}  // namespace
}  // namespace foresight::libcam::libcamera_unplug_test
