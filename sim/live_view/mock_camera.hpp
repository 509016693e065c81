// The cameras of the mock lab: what a stereo head sees of a live world, in real or in stepped time.
#pragma once

#include <array>
#include <atomic>
#include <future>
#include <memory>
#include <mutex>
#include <thread>

#include "common/clock.hpp"
#include "common/latest_value.hpp"
#include "common/lens.hpp"
#include "drivers/camera/camera.hpp"
#include "drivers/camera/stereo_pairing.hpp"
#include "scene/stereo_lenses.hpp"
#include "sim/light_map.hpp"
#include "sim/live_lab.hpp"
#include "sim/sensor.hpp"

namespace foresight::sim {

class StereoRenderer;

struct MockCameraOptions {
  StereoLenses lenses{{}, {}, T_head_left_right()};  ///< of even width
  double rate = 30;                                  ///< frames per second, > 0
  Sensor sensor = {.noise = 1.5};                    ///< its exposure drift is not used
  double light_coarser = 4;                          ///< LightMap's; fewer triangles to draw
  /// Where every part truly stands, asked as the shafts are; empty: LiveLab::true_state().
  std::function<LabState(RobotTime)> state = {};
  /// Lights the world anew for images of a state that differs: shadows move with what throws them. In real time that
  /// takes a third of the renderer's time at most, and shadows come later. Else the light is that of the world at rest,
  /// and moving parts carry theirs along.
  bool moving_light = false;
};

/// The renderer behind both cameras: a thread of its own, with its own OpenGL context, asks where the shafts were in
/// the middle of the exposure, draws both images and hands each camera its newest one. Both cameras see the same
/// instant; there is no motion blur and no rolling shutter. Any thread.
///
/// In real time the renderer goes on by itself and leaves instants out that it has no time for; it gets as much of a
/// busy machine as others do, as nothing can be operated without images. At a SteppedClock, images belong to instants a
/// period apart since the cameras started, are drawn when a camera is asked for them, and are the same on every run; a
/// camera that is asked late gets the newest instant.
class MockStereo {
 public:
  /// Exposure at which the picture has its right brightness, 100 us units as V4L2 has it.
  static constexpr std::int64_t kExposure = 80, kLongestExposure = 300;

  /// Lights the world, which takes seconds. `shafts` is called on the renderer's thread (in stepped time, while the
  /// clock's own waits for it); `clock` must outlive this.
  /// Throws InputError (rate, odd width, lenses of two sizes).
  MockStereo(std::shared_ptr<const LiveLab> world, ShaftsAt shafts, const MockCameraOptions& options, Clock& clock);
  ~MockStereo();

  void set_rate(double rate);  ///< from the next start on
  double rate() const { return options_.rate; }
  const std::shared_ptr<const LiveLab>& world() const { return world_; }
  const StereoLenses& lenses() const { return options_.lenses; }
  const Pose& T_left_right() const { return lenses().T_left_right; }
  const Lens& lens(Side side) const { return side == Side::left ? lenses().left : lenses().right; }
  /// The world's time 0: T_world_ball and so on.
  RobotTime epoch() const { return epoch_; }

  /// Seconds of CPU time, for `foresight bench camera`: of the renderer's thread in handing over finished images, and
  /// of the threads that call the cameras' wait_frame (0 where none runs).
  double copying_cpu_s() const { return copying_cpu_s_; }
  double consumers_cpu_s() const;
  std::uint64_t skipped() const { return skipped_; }  ///< instants for which the renderer was too slow

 private:
  friend class MockCamera;
  void open(Side side);  ///< throws what OpenGL throws
  void close(Side side) noexcept;
  CameraStatus wait_frame(Side side, std::uint64_t last, Duration timeout, CameraFrame& out) noexcept;
  CameraStatus wait_stepped(Side side, std::uint64_t last, Duration timeout, CameraFrame& out) noexcept;
  Duration period() const { return seconds(1 / options_.rate); }
  void render(const std::stop_token& stop, std::promise<void>& ready) noexcept;
  void run_real(const std::stop_token& stop, StereoRenderer& renderer);
  void run_stepped(const std::stop_token& stop, StereoRenderer& renderer);
  bool draw(StereoRenderer& renderer, RobotTime end_of_exposure, std::uint64_t number);
  void light_anew(StereoRenderer& renderer, const LabState& state);
  void hand_over(StereoRenderer& renderer, bool wait);

  const std::shared_ptr<const LiveLab> world_;
  const ShaftsAt shafts_;
  MockCameraOptions options_;
  Clock& clock_;
  const RobotTime epoch_;
  const bool stepped_;
  std::unique_ptr<LightMap> light_;
  LightMap::Irradiance irradiance_;
  LabState lit_;  // the state that the light is of; of the renderer's thread
  RobotTime light_due_;
  std::array<LatestValue<CameraFrame>, 2> newest_;
  std::atomic<std::int64_t> exposure_{kExposure};
  std::array<std::atomic<clockid_t>, 2> consumers_{};
  std::atomic<double> copying_cpu_s_ = 0;
  std::atomic<std::uint64_t> skipped_ = 0;
  std::mutex mutex_;  // open_, thread_
  std::array<bool, 2> open_{};
  RobotTime opened_;                        // the first camera, after none was open
  LatestValue<std::uint64_t> asked_;        // stepped time: number of the instant to draw
  std::array<std::uint64_t, 2> in_hand_{};  // stepped time: number of the frame in newest_; of the clock's thread
  std::jthread thread_;
};

/// YUYV. One control: exposure_time_absolute, which both cameras share. CameraFrame::time is the instant for
/// which the shafts were asked: the true middle of the exposure.
class MockCamera final : public Camera {
 public:
  MockCamera(std::string name, Side side, std::shared_ptr<MockStereo> stereo);
  ~MockCamera() override { stop(); }

  const std::string& name() const noexcept override { return name_; }
  void start() override;
  void stop() noexcept override;
  CameraStatus wait_frame(Duration timeout, CameraFrame& out) noexcept override;
  const CameraSettings& settings() const noexcept override { return settings_; }
  std::vector<CameraControl> controls() override;
  void set_control(const std::string& control, std::int64_t value) override;
  CameraCounters counters() const noexcept override { return counters_; }
  /// Of both cameras, to the nearest 100 us. Throws as set_control().
  void set_exposure(Duration exposure) {
    set_control("exposure_time_absolute", exposure / std::chrono::microseconds(100));
  }

 private:
  std::string name_;
  Side side_;
  std::shared_ptr<MockStereo> stereo_;
  CameraSettings settings_;
  CameraCounters counters_;
  std::optional<std::uint64_t> last_;
  bool started_ = false;
};

/// A motion for worlds without drives: the arm works, the head looks about; `t` in seconds.
std::optional<double> shafts_in_motion(std::string_view joint, double t);

}  // namespace foresight::sim
