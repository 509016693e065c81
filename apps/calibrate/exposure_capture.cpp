#include "apps/calibrate/exposure_capture.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cstdio>
#include <set>

#include "calibration/target/capture_picture.hpp"
#include "common/atomic_file.hpp"
#include "common/counted.hpp"
#include "common/error.hpp"
#include "common/stop_signal.hpp"

namespace foresight {
namespace {

using namespace std::chrono_literals;

constexpr Duration kUnit = 100us;
constexpr Duration kPicturesSilent = 5s;  // without a picture
constexpr int kSettle = 5;                // pictures after a start or a change
constexpr std::size_t kFewestExposures = 3;
constexpr int kLeastRatio = 2;

class ReopenedCameras final : public ExposedCameras {
 public:
  ReopenedCameras(std::function<std::unique_ptr<CaptureSource>(Duration)> open, const Clock& clock)
      : open_(std::move(open)), clock_(clock) {}

  CaptureImages take(Duration exposure) override {
    const std::unique_ptr<CaptureSource> source = open_(exposure);
    source->start();
    int seen = 0;
    for (RobotTime heard = clock_.now(); clock_.now() - heard <= kPicturesSilent && !stop_requested();) {
      auto images = source->take(100ms);
      if (!images) continue;
      heard = clock_.now();
      if (++seen <= kSettle) continue;
      source->stop();
      return *std::move(images);
    }
    const std::string why = source->silent_because();
    source->stop();
    if (stop_requested()) return {};
    throw RuntimeFailure("no picture came" + (why.empty() ? "" : ": " + why),
                         "check the cables, and `foresight doctor`");
  }

 private:
  std::function<std::unique_ptr<CaptureSource>(Duration)> open_;
  const Clock& clock_;
};

class ExposedMockCameras final : public ExposedCameras {
 public:
  ExposedMockCameras(OpenStereo opened, SteppedClock& clock)
      : mock_(opened.mock), source_(stepped_source(std::move(opened), clock)) {
    source_->start();
  }
  ~ExposedMockCameras() override { source_->stop(); }

  CaptureImages take(Duration exposure) override {
    sim::MockCamera("mock", Side::left, mock_).set_exposure(exposure);  // of both
    for (int i = 0; i < kSettle; ++i)
      if (auto images = source_->take(seconds(1 / mock_->rate()))) return *std::move(images);
    throw RuntimeFailure("the mock cameras give no picture: " + source_->silent_because(), "see `foresight doctor`");
  }

 private:
  std::shared_ptr<sim::MockStereo> mock_;
  std::unique_ptr<CaptureSource> source_;
};

}  // namespace

std::unique_ptr<ExposedCameras> reopened_cameras(std::function<std::unique_ptr<CaptureSource>(Duration)> open,
                                                 const Clock& clock) {
  return std::make_unique<ReopenedCameras>(std::move(open), clock);
}

std::unique_ptr<ExposedCameras> exposed_mock_cameras(OpenStereo opened, SteppedClock& clock) {
  return std::make_unique<ExposedMockCameras>(std::move(opened), clock);
}

std::vector<Duration> exposure_times(const std::vector<double>& all, Duration longest) {
  std::vector<Duration> out;
  for (const double s : all) {
    const double units = s * 1e4;
    if (!(units > 0.99) || std::abs(units - std::round(units)) > 1e-6)
      throw InputError("--exposures", fmt::format("{:g} s is no whole number of 0.1 ms", s),
                       "give exposure times such as 0.0005 0.001 0.002 0.004 0.008 0.016 0.03");
    out.push_back(std::llround(units) * kUnit);
    if (out.back() > longest)
      throw InputError("--exposures",
                       fmt::format("{:g} s is longer than these cameras expose, {:g} s", s, to_seconds(longest)),
                       "give shorter ones; real cameras expose longer at a smaller --rate");
  }
  const std::set<Duration> different(out.begin(), out.end());
  if (different.size() < kFewestExposures || different.size() < out.size())
    throw InputError("--exposures",
                     different.size() < out.size() ? "the same exposure time is given twice"
                                                   : "only " + counted(out.size(), "exposure time") + " is given",
                     "give 3 and more, better 7, each about twice the one before");
  if (*different.rbegin() < kLeastRatio * *different.begin())
    throw InputError("--exposures", "the longest is less than twice the shortest",
                     "give a series over a factor of 8 or more");
  return out;
}

bool take_exposure_series(ExposedCameras& cameras, const ExposureSeries& series) {
  poll_stop_signals();
  std::string table = "# picture seconds\n";
  std::size_t taken = 0;
  for (const Duration exposure : series.exposures) {
    const CaptureImages images = cameras.take(exposure);
    if (stop_requested() || images.left.empty()) break;
    const std::string name = fmt::format("exposure{:02d}.png", ++taken);
    for (const auto& [side, picture] : {std::pair{"left", images.left}, {"right", images.right}}) {
      if (picture.empty()) continue;
      const std::filesystem::path folder = series.stereo ? series.out / side : series.out;
      std::filesystem::create_directories(folder);
      write_picture(folder / name, picture);
    }
    table += fmt::format("{} {:g}\n", name, to_seconds(exposure));
    write_file_atomically(series.out / "exposures.txt", table);
    std::fprintf(stderr, "capture: %s of %zu, exposed for %g ms\n", name.c_str(), series.exposures.size(),
                 1e3 * to_seconds(exposure));
  }
  return !stop_requested();
}

}  // namespace foresight
