// Stands in for libcamera_library.cpp in builds without libcamera.
#include "common/error.hpp"
#include "drivers/camera/libcamera_session.hpp"

namespace foresight::libcam {
namespace {

class Absent final : public Library {
 public:
  std::vector<std::string> cameras() override { fail(); }
  std::shared_ptr<Session> open(const std::string&, const CameraSettings&, const std::string&) override { fail(); }

 private:
  [[noreturn]] static void fail() {
    throw RuntimeFailure("built without libcamera", "install libcamera-dev and rebuild, or use the v4l2 driver");
  }
};

}  // namespace

Library& library() {
  static Absent absent;
  return absent;
}

bool is_built_in() noexcept {
  return false;
}

}  // namespace foresight::libcam
