#include "apps/calibrate/capture_source.hpp"

#include <array>

#include "calibration/target/image_input.hpp"
#include "common/error.hpp"
#include "pictures/picture_file.hpp"

namespace foresight {
namespace {

namespace fs = std::filesystem;

class PairSource final : public CaptureSource {
 public:
  explicit PairSource(OpenStereo opened) : opened_(std::move(opened)) {}
  void start() override { opened_.cameras->start(); }
  void stop() noexcept override { opened_.cameras->stop(); }
  std::optional<CaptureImages> take(Duration timeout) override {
    auto pair = opened_.cameras->take(timeout);
    if (!pair) return std::nullopt;
    return CaptureImages{pair->left.bgr, pair->right.bgr};
  }
  std::string silent_because() const override { return fault_text(opened_.cameras->status()); }

 private:
  OpenStereo opened_;
};

class SteppedSource final : public CaptureSource {
 public:
  SteppedSource(OpenStereo opened, SteppedClock& clock) : opened_(std::move(opened)), clock_(clock) {}
  void start() override { opened_.cameras->start_polled(); }
  void stop() noexcept override { opened_.cameras->stop(); }
  std::optional<CaptureImages> take(Duration timeout) override {
    clock_.sleep_until(clock_.now() + timeout);
    opened_.cameras->poll();
    auto pair = opened_.cameras->take(Duration{0});
    if (!pair) return std::nullopt;
    return CaptureImages{pair->left.bgr, pair->right.bgr};
  }
  std::string silent_because() const override { return fault_text(opened_.cameras->status()); }

 private:
  OpenStereo opened_;
  SteppedClock& clock_;
};

class LoneSource final : public CaptureSource {
 public:
  explicit LoneSource(std::unique_ptr<Camera> camera) : camera_(std::move(camera)) {}
  void start() override { camera_->start(); }
  void stop() noexcept override { camera_->stop(); }
  std::optional<CaptureImages> take(Duration timeout) override {
    CameraFrame frame;
    status_ = camera_->wait_frame(timeout, frame);
    CaptureImages out;
    if (status_ != CameraStatus::ok) return std::nullopt;
    if (to_bgr(frame, out.left) == Conversion::ok) return out;
    status_ = CameraStatus::corrupt;
    return std::nullopt;
  }
  std::string silent_because() const override {
    if (status_ == CameraStatus::ok) return {};
    return "camera " + camera_->name() + ": " + to_string(status_);
  }

 private:
  std::unique_ptr<Camera> camera_;
  CameraStatus status_ = CameraStatus::timeout;
};

class FolderSource final : public CaptureSource {
 public:
  explicit FolderSource(const std::vector<std::string>& folders) {
    if (folders.size() == 2) {
      files_ = list_pairs(folders[0], folders[1]);
    } else {
      for (const fs::path& file : list_images(folders.at(0))) files_.push_back({file, {}});
    }
  }
  void start() override { next_ = 0; }
  void stop() noexcept override {}
  std::optional<CaptureImages> take(Duration) override {
    if (at_end()) return std::nullopt;
    const auto& [left, right] = files_[next_++];
    return CaptureImages{read(left), right.empty() ? cv::Mat() : read(right)};
  }
  std::string silent_because() const override { return {}; }
  bool stills() const override { return true; }
  bool at_end() const override { return next_ >= files_.size(); }

 private:
  static cv::Mat read(const fs::path& file) { return read_picture(file, PictureColours::colour); }
  std::vector<std::array<fs::path, 2>> files_;
  std::size_t next_ = 0;
};

}  // namespace

std::unique_ptr<CaptureSource> pair_source(OpenStereo opened) {
  return std::make_unique<PairSource>(std::move(opened));
}

std::unique_ptr<CaptureSource> stepped_source(OpenStereo opened, SteppedClock& clock) {
  return std::make_unique<SteppedSource>(std::move(opened), clock);
}

std::unique_ptr<CaptureSource> lone_source(std::unique_ptr<Camera> camera) {
  return std::make_unique<LoneSource>(std::move(camera));
}

std::unique_ptr<CaptureSource> folder_source(const std::vector<std::string>& folders) {
  return std::make_unique<FolderSource>(folders);
}

}  // namespace foresight
