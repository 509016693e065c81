#include "session/recording.hpp"

#include <atomic>
#include <climits>
#include <condition_variable>
#include <future>
#include <mutex>
#include <thread>

#include "scene/run_folder.hpp"
#include "scene/scene_reader.hpp"
#include "scene/target_folder.hpp"
#include "tests/scene/test_run.hpp"

namespace foresight::recording_test {
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

/// The camera and the ball both move along x with time; pairs in `lost` (counted from 1) have no pose.
class AlongX final : public PoseSource {
 public:
  explicit AlongX(std::optional<int> lost = {}) : lost_(lost) {}
  PairPoses poses_of(const StereoPair& pair) override {
    PairPoses out;
    ++count_;
    out.predicted_px = 0.25 * count_;
    out.quality = count_ == lost_ ? "lost" : "tags";
    if (count_ == lost_) return out;
    Pose right = at(pair.right.time);
    right.translation().x() += 0.065;
    out.T_world_camera = {at(pair.left.time), right};
    for (std::size_t i = 0; i < 2; ++i) {
      const RobotTime time = i ? pair.right.time : pair.left.time;
      out.scene[i] = {time, StateStatus::exact, {Pose::Identity(), at(time)}};
    }
    return out;
  }

 private:
  static Pose at(RobotTime time) {
    Pose pose = Pose::Identity();
    pose.translation().x() = to_seconds(time - RobotTime{});
    return pose;
  }
  std::optional<int> lost_;
  int count_ = 0;
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
    options_.lenses.left = options_.lenses.right = Lens(p);
    options_.lenses.T_left_right.translation().x() = 0.065;
    Mesh triangle;
    triangle.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    triangle.triangles = {{0, 1, 2}};
    Pose above = Pose::Identity();
    above.translation().z() = 2;
    options_.scene = std::make_shared<const SceneModel>(
        std::vector<Node>{{"o'table", triangle, -1, above}, {"ball", triangle, 0, above, true}}, 0.007);
  }

  /// From cameras that fall silent after so many frames; `offset` of the right one's clock.
  RecordingResult record_from(int left, int right, RecordingLimits limits = {}, Duration offset = 0ns) {
    PairingOptions pairing;
    pairing.tolerance = 4ms;  // of a period of 10 ms: an image has one partner only
    Film film({left, right});
    StereoCamera cameras(std::make_unique<FilmCamera>(film, Side::left, 0ns),
                         std::make_unique<FilmCamera>(film, Side::right, offset), film, pairing);
    LiveFrameOptions room_for_all;  // however late a thread gets its turn
    room_for_all.waiting = 1000;
    LiveFrames frames(std::make_shared<AlongX>(), film, room_for_all);
    RunRecorder recorder(folder_ / "run", options_, frames.subscribe(1000));
    return record(cameras, frames, recorder, limits, film, [this] { return stop_; });
  }

  /// What the recorder gets of pairs that come without a pose, or with one of `poses`.
  std::shared_ptr<FrameQueue> queue_of(const std::vector<StereoPair>& pairs, std::shared_ptr<PoseSource> poses = {},
                                       std::size_t room = 100) {
    LiveFrames frames(poses ? poses : std::make_shared<AlongX>(), clock_);
    auto queue = frames.subscribe(room);
    for (const StereoPair& pair : pairs) {
      frames.add(pair);
      frames.step();
    }
    return queue;
  }
  RecorderCounts write(std::shared_ptr<FrameQueue> queue) {
    return RunRecorder(folder_ / "run", options_, std::move(queue)).finish("");
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

  fs::path unfinished() const { return unfinished_beside(folder_ / "run").at(0); }

  static constexpr int kForever = INT_MAX;
  TempFolder folder_;
  SteppedClock clock_;
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

TEST_F(Recording, KeepsWhatTheRegistrationSays) {
  options_.tags = folder_.write("map.txt", "1 0 0 0 0\n");
  std::vector<StereoPair> pairs;
  for (int i = 1; i <= 5; ++i) pairs.push_back(pair_at(20 * i));
  const RecorderCounts counts = write(queue_of(pairs, std::make_shared<AlongX>(3)));
  EXPECT_EQ(counts.written, 5u);
  EXPECT_EQ(counts.without_pose, 1u);
  const RunFolder run = RunFolder::open(folder_ / "run", {});
  ASSERT_EQ(run.frames().size(), 4u) << "what is lost has no pose, and is no frame";
  for (const RunFrame& frame : run.frames())
    EXPECT_NEAR(frame.left.T_world_camera.translation().x(), to_seconds(frame.left.time - RobotTime{}), 1e-6);
  EXPECT_THAT(folder_.read("run/without_pose.txt"),
              testing::AllOf(HasSubstr("0.060000000 rgb/000002.png"), HasSubstr("0.060000000 rgb_right/000002.png")));
  EXPECT_EQ(run.frames()[1].left.pose_status, StateStatus::exact);
  EXPECT_DOUBLE_EQ(run.frames()[1].left.predicted_px.value(), 0.5);
  EXPECT_THAT(folder_.read("run/registration.txt"), HasSubstr("lost 0.75"));
  EXPECT_EQ(folder_.read("run/tags.txt"), "1 0 0 0 0\n");
}

TEST_F(Recording, TheRightImagesPoseIsOfItsOwnInstant) {
  StereoPair early = pair_at(50), late = pair_at(90);
  early.right.time = RobotTime{45'000'000};  // before the first pose of a left one
  late.right.time = RobotTime{94'000'000};
  write(queue_of({early, late}));
  const RunFolder run = RunFolder::open(folder_ / "run", {});
  ASSERT_EQ(run.frames().size(), 2u);
  for (const RunFrame& frame : run.frames()) {
    EXPECT_EQ(frame.right.value().pose_status, StateStatus::exact);
    EXPECT_NEAR(frame.right->T_world_camera.translation().x(), 0.065 + to_seconds(frame.right->time - RobotTime{}),
                1e-9);
  }
}

TEST_F(Recording, WithoutPosesLeavesTheTrajectoryToOthers) {
  options_.posed = false;
  EXPECT_EQ(write(queue_of({pair_at(1), pair_at(2)}, std::make_shared<AlongX>(1))).without_pose, 0u);
  EXPECT_FALSE(fs::exists(folder_ / "run/trajectory.txt"));
  EXPECT_THAT(folder_.read("run/rgb.txt"), HasSubstr("0.001000000 rgb/000000.png"));
}

TEST_F(Recording, KeepsEveryLens) {
  for (const LensModel model : {LensModel::plumb_bob, LensModel::rational_polynomial, LensModel::equidistant}) {
    Lens::Parameters p = options_.lenses.left.parameters();
    p.model = model;
    p.d = {-0.11, 0.012, 0.0003, -0.0004};
    if (model != LensModel::equidistant) p.d[4] = 0.0017;
    if (model == LensModel::rational_polynomial) p.d[5] = 0.21, p.d[6] = -0.013, p.d[7] = 1.0 / 3;
    options_.lenses.left = options_.lenses.right = Lens(p);
    write(queue_of({pair_at(1)}));
    const RunFolder run = RunFolder::open(folder_ / "run", {});
    for (const Lens& lens : {run.lens_left(), run.lens_right().value()}) {
      EXPECT_EQ(lens.parameters().model, model);
      EXPECT_EQ(lens.parameters().d, p.d) << to_string(model);
    }
  }
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
  std::vector<StereoPair> pairs;
  for (int i = 1; i <= 20; ++i) pairs.push_back(pair_at(i));
  const auto queue = queue_of(pairs, {}, 3);  // so slow that it begins when all have come
  const RecorderCounts counts = write(queue);
  EXPECT_EQ(counts.written, 3u);
  EXPECT_EQ(counts.dropped, 17u);
  const RunFolder run = RunFolder::open(folder_ / "run", {});
  ASSERT_EQ(run.frames().size(), 3u);
  EXPECT_EQ(run.frames()[0].left.time, RobotTime{18'000'000}) << "the oldest go";
  EXPECT_THAT(folder_.read("run/record.yaml"), HasSubstr("dropped_by_disk: 17"));
}

TEST_F(Recording, WaitsForASlowDiskWhereItIsToldTo) {
  LiveFrames frames(std::make_shared<AlongX>(), clock_);
  const auto queue = frames.subscribe(3, /*waits=*/true);
  std::jthread camera([&] {
    for (int i = 1; i <= 20; ++i) {
      frames.add(pair_at(i));
      frames.step();
    }
  });
  RunRecorder recorder(folder_ / "run", options_, queue);
  camera.join();
  const RecorderCounts counts = recorder.finish("");
  EXPECT_EQ(counts.written, 20u);
  EXPECT_EQ(counts.dropped, 0u);
}

TEST_F(Recording, AFullDiskEndsItAndKeepsWhatIsThere) {
  RunRecorder recorder(folder_ / "run", options_, queue_of({pair_at(1)}));
  while (recorder.counts().written == 0) std::this_thread::sleep_for(1ms);
  EXPECT_FALSE(recorder.stopped());
  EXPECT_EQ(recorder.finish("").written, 1u);
  EXPECT_EQ(recorder.fault(), "");

  options_.spare_bytes = 1e18;
  try {
    RunRecorder(folder_ / "other", options_, queue_of({}));
    FAIL();
  } catch (const RuntimeFailure& failure) {
    EXPECT_THAT(failure.what(), HasSubstr("free some disk space"));
  }
  EXPECT_EQ(left_behind(), std::vector<std::string>{"run"});
}

TEST_F(Recording, AFailingWriteLeavesNothing) {
  {
    const auto queue = std::make_shared<FrameQueue>(1);
    RunRecorder recorder(folder_ / "run", options_, queue);
    for (const auto& entry : fs::directory_iterator(folder_.path())) fs::remove_all(entry.path() / "rgb_right");
    queue->put(*queue_of({pair_at(1)})->take(0ns));
    EXPECT_THROW(recorder.finish(""), RuntimeFailure);
  }
  EXPECT_THAT(left_behind(), testing::IsEmpty());
}

TEST_F(Recording, RefusesImagesOfAnotherSize) {
  EXPECT_THAT(input_error([&] { write(queue_of({pair_at(1, 20)})); }),
              testing::AllOf(HasSubstr("left camera"), HasSubstr("20 x 12"), HasSubstr("16 x 12")));
  EXPECT_THAT(left_behind(), testing::IsEmpty());
}

TEST_F(Recording, KeepsWhatCameBeforeAPairThatCannotBeRecorded) {
  RunRecorder recorder(folder_ / "run", options_, queue_of({pair_at(5), pair_at(7), pair_at(6), pair_at(8)}));
  EXPECT_EQ(recorder.finish("").written, 2u);
  EXPECT_THAT(recorder.fault(), HasSubstr("do not ascend"));
  EXPECT_EQ(RunFolder::open(folder_ / "run", {}).frames().size(), 2u);
  EXPECT_EQ(left_behind(), std::vector<std::string>{"run"});
}

TEST_F(Recording, KeepsWhatCameBeforeAFailingWrite) {
  const auto queue = std::make_shared<FrameQueue>(4);
  RunRecorder recorder(folder_ / "run", options_, queue);
  const auto frames = queue_of({pair_at(1), pair_at(2)});
  queue->put(*frames->take(0ns));
  while (recorder.counts().written == 0) std::this_thread::sleep_for(1ms);
  fs::remove_all(unfinished() / "rgb_right");
  queue->put(*frames->take(0ns));
  while (!recorder.stopped()) std::this_thread::sleep_for(1ms);
  EXPECT_THAT(recorder.fault(), HasSubstr("rgb_right"));
  fs::create_directory(unfinished() / "rgb_right");  // for who reads the run
  EXPECT_EQ(recorder.finish("").written, 1u);
  EXPECT_THAT(folder_.read("run/rgb.txt"), testing::Not(HasSubstr("000001.png"))) << "without its partner";
}

TEST_F(Recording, AListThatCannotBeWrittenNamesNoImageWithoutItsPose) {
  const auto queue = std::make_shared<FrameQueue>(4);
  RunRecorder recorder(folder_ / "run", options_, queue);
  const auto frames = queue_of({pair_at(1), pair_at(2)});
  queue->put(*frames->take(0ns));
  while (recorder.counts().written == 0) std::this_thread::sleep_for(1ms);
  fs::rename(unfinished() / "trajectory.txt", folder_ / "aside.txt");
  fs::create_directory(unfinished() / "trajectory.txt");
  queue->put(*frames->take(0ns));
  while (!recorder.stopped()) std::this_thread::sleep_for(1ms);
  EXPECT_THAT(recorder.fault(), HasSubstr("trajectory.txt"));
  fs::remove(unfinished() / "trajectory.txt");
  fs::rename(folder_ / "aside.txt", unfinished() / "trajectory.txt");
  EXPECT_EQ(recorder.finish("").written, 1u);
  EXPECT_EQ(RunFolder::open(folder_ / "run", {}).frames().size(), 1u);
}

TEST_F(Recording, WhatCanBeMadeAgainIsNotKept) {
  options_.irreplaceable = false;
  {
    const RunRecorder recorder(folder_ / "run", options_, queue_of({pair_at(1)}));
    while (recorder.counts().written == 0) std::this_thread::sleep_for(1ms);
  }
  EXPECT_THAT(left_behind(), testing::IsEmpty());
}

// What lies there while it records is what a program leaves that is killed.
TEST_F(Recording, IsARunAtAnyInstant) {
  const auto queue = std::make_shared<FrameQueue>(4);
  RunRecorder recorder(folder_ / "run", options_, queue);
  const auto frames = queue_of({pair_at(1), pair_at(2)});
  for (std::uint64_t pairs = 1; pairs <= 2; ++pairs) {
    queue->put(*frames->take(0ns));
    while (recorder.counts().written < pairs) std::this_thread::sleep_for(1ms);
    EXPECT_EQ(RunFolder::open(unfinished(), {}).frames().size(), pairs);
  }
}

TEST_F(Recording, WithoutFinishKeepsItsPairsBesideTheTarget) {
  for (const char* name : {"run.unfinished-1", "run.unfinished-2"}) {
    const auto queue = queue_of({pair_at(1)});
    {
      const RunRecorder recorder(folder_ / "run", options_, queue);
      while (recorder.counts().written == 0) std::this_thread::sleep_for(1ms);
    }
    EXPECT_EQ(RunFolder::open(folder_ / name, {}).frames().size(), 1u);
  }
  { const RunRecorder without_pairs(folder_ / "run", options_, queue_of({})); }
  EXPECT_EQ(unfinished_beside(folder_ / "run/").size(), 2u);
  EXPECT_EQ(left_behind().size(), 2u);
}

TEST_F(Recording, SaysWhereThePairsAreIfTheFolderCannotBeFinished) {
  const auto queue = queue_of({pair_at(1)});
  RunRecorder recorder(folder_ / "run", options_, queue);
  while (recorder.counts().written == 0) std::this_thread::sleep_for(1ms);
  fs::create_directory(unfinished() / RunRecorder::kMarker);  // in the way of the file
  try {
    recorder.finish("");
    FAIL();
  } catch (const RuntimeFailure& failure) {
    EXPECT_THAT(failure.what(), HasSubstr("what was recorded is in " + (folder_ / "run.unfinished-1").string()));
  }
  EXPECT_EQ(RunFolder::open(folder_ / "run.unfinished-1", {}).frames().size(), 1u);
}

TEST_F(Recording, DoesNotTouchFoldersOfOthers) {
  folder_.write("run/mine.txt", "x");
  EXPECT_THAT(input_error([&] { RunRecorder(folder_ / "run", options_, queue_of({})); }), HasSubstr("not empty"));
  EXPECT_EQ(folder_.read("run/mine.txt"), "x");
}

}  // namespace
}  // namespace foresight::recording_test
