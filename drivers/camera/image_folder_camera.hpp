// Numbered image files, played as a camera.
#pragma once

#include <filesystem>

#include "common/clock.hpp"
#include "drivers/camera/camera.hpp"

namespace foresight {

/// Plays the files of a folder whose names end in a number ("left_0001.png"), in the order of these numbers, one per
/// frame period. A file that cannot be read is a corrupt frame. Has no controls. Sleeps on `clock`.
class ImageFolderCamera final : public Camera {
 public:
  struct Options {
    std::string prefix;  ///< only files whose names begin so, up to the number ("left_"); "" for all
    double rate = 30;    ///< frames per second, > 0
    bool repeat = true;  ///< from the first again; otherwise lost at the end
  };
  /// `clock` must outlive this. Throws InputError (no such folder, no such files, two of one number, bad rate).
  ImageFolderCamera(std::string name, const std::filesystem::path& folder, const Options& options, Clock& clock);

  const std::string& name() const noexcept override { return name_; }
  void start() override;  ///< size and format (bgr) are those of the first image
  void stop() noexcept override;
  CameraStatus wait_frame(Duration timeout, CameraFrame& out) noexcept override;
  const CameraSettings& settings() const noexcept override { return settings_; }
  std::vector<CameraControl> controls() override { return {}; }
  void set_control(const std::string& control, std::int64_t value) override;
  CameraCounters counters() const noexcept override { return counters_; }

 private:
  std::string name_;
  std::filesystem::path folder_;
  Options options_;
  Clock& clock_;
  std::vector<std::filesystem::path> files_;
  CameraSettings settings_;
  CameraCounters counters_;
  RobotTime start_;
  std::uint64_t next_ = 0;
  bool started_ = false;
};

}  // namespace foresight
