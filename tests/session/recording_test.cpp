#include "session/recording.hpp"

#include <atomic>
#include <climits>
#include <condition_variable>
#include <future>
#include <mutex>
#include <thread>

#include "scene/run_folder.hpp"
#include "scene/scene_reader.hpp"
#include "sim/run_files.hpp"
#include "tests/scene/test_run.hpp"

namespace foresight {
namespace {

using namespace std::chrono_literals;
namespace fs = std::filesystem;
using testing::HasSubstr;

constexpr int kWidth = 16, kHeight = 12;

/// Two cameras' common time. It moves by the frames that they deliver, and while both have none; never by itself.
class Film final : public Clock {
 public:
  explicit Film(std::array<int, 2> last) : last_(last) {}
  RobotTime now() const noexcept override { return RobotTime{ns_}; }
  void sleep_until(RobotTime time) noexcept override {
    for (std::int64_t was = ns_; was < time.ns && !ns_.compare_exchange_weak(was, time.ns);) {
    }
  }

  /// Number of the side's next frame, from 1 on; neither side runs more than one ahead. 0: it has none, or the other
  /// one is not as far.
  int next(std::size_t side, Duration timeout) noexcept {
    std::this_thread::sleep_for(1ms);  // lest it takes a whole core
    std::unique_lock lock(mutex_);
    if (count_[side] >= last_[side]) {
      silent_[side] = true;
      if (silent_[1 - side]) sleep_until(now() + timeout);
      return 0;
    }
    const auto other_is_as_far = [&] { return silent_[1 - side] || count_[1 - side] >= count_[side]; };
    if (!changed_.wait_for(lock, 100ms, other_is_as_far)) return 0;
    changed_.notify_all();
    const int number = ++count_[side];
    sleep_until(time_of(number));
    return number;
  }
  static RobotTime time_of(int number) { return RobotTime{} + number * 10ms; }

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  const std::array<int, 2> last_;
  std::array<int, 2> count_{};
  std::array<bool, 2> silent_{};  // has come back for a frame after its last
  std::atomic<std::int64_t> ns_ = 0;
};

/// Frames of one colour that tells their number, so that the two images of a pair show the same. `offset` shifts its
/// clock.
class FilmCamera final : public Camera {
 public:
  FilmCamera(Film& film, Side side, Duration offset)
      : film_(film), side_(static_cast<std::size_t>(side)), offset_(offset), image_(kHeight, kWidth, CV_8UC3) {}
  const std::string& name() const noexcept override { return name_; }
  void start() override {}
  void stop() noexcept override {}
  CameraStatus wait_frame(Duration timeout, CameraFrame& out) noexcept override {
    const int number = film_.next(side_, timeout);
    if (number == 0) return CameraStatus::timeout;
    image_.setTo(cv::Scalar::all(number % 256));
    out = {};
    out.width = image_.cols;
    out.height = image_.rows;
    out.stride = image_.step[0];
    out.bytes = {image_.data, image_.total() * 3};
    out.time = Film::time_of(number) + offset_;
    return CameraStatus::ok;
  }
  const CameraSettings& settings() const noexcept override { return settings_; }
  std::vector<CameraControl> controls() override { return {}; }
  void set_control(const std::string&, std::int64_t) override {}
  CameraCounters counters() const noexcept override { return {}; }

 private:
  std::string name_ = "camera";
  Film& film_;
  std::size_t side_;
  Duration offset_;
  cv::Mat image_;
  CameraSettings settings_;
};

class Recording : public testing::Test {
 protected:
  Recording() {
    Lens::Parameters p;
    p.width = kWidth;
    p.height = kHeight;
    p.fx = p.fy = 20;
    p.cx = 7.5;
    p.cy = 5.5;
    options_.left = options_.right = Lens(p);
    options_.T_left_right.translation().x() = 0.065;
    options_.poses = [](RobotTime time) {
      RecordedPoses poses;
      poses.T_world_left.translation().x() = to_seconds(time - RobotTime{});
      poses.T_world_node.emplace_back("ball", poses.T_world_left);
      return poses;
    };
    Mesh triangle;
    triangle.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    triangle.triangles = {{0, 1, 2}};
    Pose above = Pose::Identity();
    above.translation().z() = 2;
    const SceneModel scene({{"o'table", triangle, -1, above}, {"ball", triangle, 0, above}}, 0.007);
    options_.write_scene = [scene](const fs::path& folder) { sim::write_model(folder, scene); };
  }

  /// From cameras that fall silent after so many frames; `offset` of the right one's clock.
  RecordingResult record_from(int left, int right, RecordingLimits limits = {}, Duration offset = 0ns) {
    PairingOptions pairing;
    pairing.tolerance = 4ms;  // of a period of 10 ms: an image has one partner only
    Film film({left, right});
    StereoCamera cameras(std::make_unique<FilmCamera>(film, Side::left, 0ns),
                         std::make_unique<FilmCamera>(film, Side::right, offset), film, pairing);
    RunRecorder recorder(folder_ / "run", options_);
    return record(cameras, recorder, limits, film, [this] { return stop_; });
  }

  StereoPair pair_at(std::int64_t ms, int width = kWidth) const {
    const ColourImage image{cv::Mat(kHeight, width, CV_8UC3, cv::Scalar(1, 2, 3)), 0, RobotTime{ms * 1'000'000}, {}};
    return {image, image};
  }

  std::vector<std::string> left_behind() const {
    std::vector<std::string> out;
    for (const auto& entry : fs::directory_iterator(folder_.path())) out.push_back(entry.path().filename());
    return out;
  }

  static constexpr int kForever = INT_MAX;
  TempFolder folder_;
  RecorderOptions options_;
  bool stop_ = false;
};

TEST_F(Recording, IsARunThatCanBeReadBack) {
  RecordingLimits limits;
  limits.count = 5;
  const RecordingResult result = record_from(kForever, kForever, limits, 2ms);
  EXPECT_EQ(result.fault, "");
  EXPECT_EQ(result.counts.written, 5u);
  const RunFolder run = RunFolder::open(folder_ / "run", {});
  ASSERT_EQ(run.frames().size(), 5u);
  EXPECT_EQ(run.unpaired_right(), 0u);
  EXPECT_NEAR(run.T_left_right().translation().x(), 0.065, 1e-12);
  EXPECT_DOUBLE_EQ(run.scene()->accuracy().value(), 0.007);
  EXPECT_NEAR(run.scene()->rest_poses()[1].translation().z(), 4, 1e-12);
  for (const RunFrame& frame : run.frames()) {
    ASSERT_TRUE(frame.right);
    EXPECT_EQ(frame.right->time - frame.left.time, 2ms);
    EXPECT_NEAR(frame.left.T_world_camera.translation().x(), to_seconds(frame.left.time - RobotTime{}), 1e-6);
    EXPECT_NEAR(frame.right->T_world_camera.translation().x(), 0.067 + to_seconds(frame.left.time - RobotTime{}), 1e-6);
    EXPECT_NEAR(run.state_at(frame.left.time).T_world_node[1].translation().x(),
                to_seconds(frame.left.time - RobotTime{}), 1e-6);
    const cv::Mat left = read_run_image(frame.left, run.lens_left()),
                  right = read_run_image(*frame.right, run.lens_left());
    EXPECT_EQ(cv::norm(left, right, cv::NORM_INF), 0);
  }
}

TEST_F(Recording, TakesThePosesOfARegistrationOnItsOwnThread) {
  const auto taker = std::this_thread::get_id();
  int prepared = 0;
  options_.poses = {};
  options_.tags = folder_.write("map.txt", "1 0 0 0 0\n");
  options_.waits = true;
  options_.registration = [&]() -> PairRegistration {
    EXPECT_EQ(std::this_thread::get_id(), taker);
    return [k = ++prepared, taker](const StereoPair& pair) {
      EXPECT_NE(std::this_thread::get_id(), taker);
      RegisteredPose found{Pose::Identity(), 0.25 * k, k == 3 ? "lost" : "tags"};
      found.T_world_left.translation().x() = to_seconds(pair.left.time - RobotTime{});
      return found;
    };
  };
  RunRecorder recorder(folder_ / "run", options_);
  for (int i = 1; i <= 5; ++i) recorder.add(pair_at(20 * i));
  recorder.finish("");
  const RunFolder run = RunFolder::open(folder_ / "run", {});
  ASSERT_EQ(run.frames().size(), 4u) << "what is lost has no pose, and is no frame";
  for (const RunFrame& frame : run.frames())
    EXPECT_NEAR(frame.left.T_world_camera.translation().x(), to_seconds(frame.left.time - RobotTime{}), 1e-6);
  EXPECT_THAT(folder_.read("run/without_pose.txt"),
              testing::AllOf(HasSubstr("0.060000000 rgb/000002.png"), HasSubstr("0.060000000 rgb_right/000002.png")));
  EXPECT_EQ(recorder.counts().without_pose, 1u);
  EXPECT_EQ(run.frames()[1].left.pose_status, StateStatus::exact);
  EXPECT_DOUBLE_EQ(run.frames()[1].left.predicted_px.value(), 0.5);
  EXPECT_THAT(folder_.read("run/registration.txt"), HasSubstr("lost 0.75"));
  EXPECT_EQ(folder_.read("run/tags.txt"), "1 0 0 0 0\n");
}

TEST_F(Recording, KeepsWhatCameBeforeACameraFellSilent) {
  RecordingLimits limits;
  limits.silent_after = 500ms;
  const RecordingResult result = record_from(40, 20, limits);
  EXPECT_THAT(result.fault, HasSubstr("right camera: timeout"));
  EXPECT_GE(result.counts.written, 1u);
  EXPECT_EQ(result.cameras.pairing.pairs, 20u);
  EXPECT_EQ(result.counts.written + result.counts.dropped + result.cameras.dropped, 20u);
  EXPECT_EQ(RunFolder::open(folder_ / "run", {}).frames().size(), result.counts.written);
  EXPECT_EQ(result.cameras.pairing.unpaired[0], 16u) << "of 20; 4 still wait";
  EXPECT_THAT(counts_text(result), HasSubstr("left images without a partner"));
}

TEST_F(Recording, LeavesNothingWhereNoPairCame) {
  RecordingLimits limits;
  limits.silent_after = 300ms;
  try {
    record_from(40, 0, limits);
    FAIL();
  } catch (const RuntimeFailure& failure) {
    EXPECT_THAT(failure.what(), testing::AllOf(HasSubstr("no pair of images came"), HasSubstr("nothing was recorded")));
  }
  EXPECT_THAT(left_behind(), testing::IsEmpty());
}

TEST_F(Recording, ASlowDiskDropsPairsAndCountsThem) {
  std::promise<void> disk;
  options_.registration = [goes_on = disk.get_future().share()]() -> PairRegistration {
    return [goes_on](const StereoPair&) {  // on the thread that writes
      goes_on.wait();
      return RegisteredPose{Pose::Identity(), 0, "tags"};
    };
  };
  options_.waiting = 3;
  RunRecorder recorder(folder_ / "run", options_);
  for (int i = 1; i <= 20; ++i) recorder.add(pair_at(i));
  EXPECT_EQ(recorder.counts().written, 0u);
  EXPECT_EQ(recorder.counts().dropped, 17u);
  disk.set_value();
  const RecorderCounts counts = recorder.finish("");
  EXPECT_EQ(counts.written, 3u) << "those that came first";
  EXPECT_EQ(counts.dropped, 17u);
  const RunFolder run = RunFolder::open(folder_ / "run", {});
  ASSERT_EQ(run.frames().size(), 3u);
  EXPECT_EQ(run.frames()[2].left.time, RobotTime{} + 3ms);
  EXPECT_THAT(folder_.read("run/record.yaml"), HasSubstr("dropped_by_disk: 17"));
}

TEST_F(Recording, WaitsForASlowDiskWhereItIsToldTo) {
  constexpr int kPairs = 20, kWaiting = 3;
  std::atomic<int> added = 0, written = 0;
  // The disk takes each pair only after as many others wait as may; add() is never further ahead of it.
  options_.registration = [&]() -> PairRegistration {
    return [&](const StereoPair&) {
      const int most = std::min(kPairs, written + kWaiting);
      for (int seen = added; seen < most; seen = added) added.wait(seen);
      EXPECT_EQ(added, most);
      ++written;
      return RegisteredPose{Pose::Identity(), 0, "tags"};
    };
  };
  options_.waiting = kWaiting;
  options_.waits = true;
  RunRecorder recorder(folder_ / "run", options_);
  for (int i = 1; i <= kPairs; ++i) {
    recorder.add(pair_at(i));
    ++added;
    added.notify_one();
  }
  const RecorderCounts counts = recorder.finish("");
  EXPECT_EQ(counts.written, 20u);
  EXPECT_EQ(counts.dropped, 0u);
}

TEST_F(Recording, AFullDiskEndsItAndKeepsWhatIsThere) {
  RunRecorder recorder(folder_ / "run", options_);
  recorder.add(pair_at(1));
  while (recorder.counts().written == 0) std::this_thread::sleep_for(1ms);
  EXPECT_FALSE(recorder.stopped());
  EXPECT_EQ(recorder.finish("").written, 1u);

  options_.spare_bytes = 1e18;
  try {
    RunRecorder(folder_ / "other", options_);
    FAIL();
  } catch (const RuntimeFailure& failure) {
    EXPECT_THAT(failure.what(), HasSubstr("free some disk space"));
  }
  EXPECT_EQ(left_behind(), std::vector<std::string>{"run"});
}

TEST_F(Recording, AFailingWriteLeavesNothing) {
  {
    RunRecorder recorder(folder_ / "run", options_);
    for (const auto& entry : fs::directory_iterator(folder_.path())) fs::remove_all(entry.path() / "rgb_right");
    recorder.add(pair_at(1));
    EXPECT_THROW(recorder.finish(""), RuntimeFailure);
  }
  EXPECT_THAT(left_behind(), testing::IsEmpty());
}

TEST_F(Recording, RefusesImagesOfAnotherSizeAndTimesThatGoBack) {
  RunRecorder recorder(folder_ / "run", options_);
  EXPECT_THAT(input_error([&] { recorder.add(pair_at(1, 20)); }),
              testing::AllOf(HasSubstr("left camera"), HasSubstr("20 x 12"), HasSubstr("16 x 12")));
  recorder.add(pair_at(5));
  EXPECT_THAT(input_error([&] { recorder.add(pair_at(5)); }), HasSubstr("do not ascend"));
}

TEST_F(Recording, DoesNotTouchFoldersOfOthers) {
  folder_.write("run/mine.txt", "x");
  EXPECT_THAT(input_error([&] { RunRecorder(folder_ / "run", options_); }), HasSubstr("not empty"));
  EXPECT_EQ(folder_.read("run/mine.txt"), "x");
}

}  // namespace
}  // namespace foresight
