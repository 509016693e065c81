// A served robot and its operator in stepped time, recorded: what is in the file, the run that comes of it, and what
// the recorded commands do to a robot that hears them again.
#include <fstream>
#include <opencv2/imgcodecs.hpp>

#include "common/error.hpp"
#include "link/control_wire/control_wire.hpp"
#include "link/dds/topics.hpp"
#include "link/operator_side/pair_intake.hpp"
#include "link/recording/line_recorder.hpp"
#include "link/recording/mcap_reader.hpp"
#include "link/recording/playback.hpp"
#include "link/recording/rig_files.hpp"
#include "link/recording/run_export.hpp"
#include "link/robot_side/rig_identity.hpp"
#include "link/robot_side/served_operator.hpp"
#include "link/robot_side/state_sender.hpp"
#include "scene/run_folder.hpp"
#include "session/live_scene.hpp"
#include "tests/robot_devices/live_robot.hpp"
#include "tests/scene/test_run.hpp"
#include "tests/support/private_network.hpp"

namespace foresight::link::line_test {
namespace {

using namespace std::chrono_literals;
using testing::ContainsRegex;
using testing::HasSubstr;
namespace fs = std::filesystem;

const Topic kToRobot{"rt/foresight/control/operator/messages", kFromOperatorType, Delivery::newest, 64};

DrawNonce counting(Nonce from) {
  return [from]() mutable { return ++from; };
}

ControlDeskOptions desk_options(const Identity& identity, Nonce from) {
  ControlDeskOptions out;
  out.identity = identity;
  out.draw = counting(from);
  return out;
}

ControlSeatOptions seat_options(const Identity& identity) {
  ControlSeatOptions out;
  out.identity = identity;
  out.draw = counting(1'000'000);
  return out;
}

fs::path rig_file() {
  return source_folder() / "configs" / "minerva.yaml";
}

/// All messages of a file, by topic.
std::map<std::string, std::vector<Bytes>> messages_of(const fs::path& file) {
  std::map<std::string, std::vector<Bytes>> out;
  McapVisitor visitor;
  visitor.message = [&](const McapMessage& m) {
    EXPECT_EQ(m.channel.schema->encoding.empty(), false) << m.channel.topic;
    out[m.channel.topic].emplace_back(m.data.begin(), m.data.end());
    EXPECT_EQ(m.sequence, out[m.channel.topic].size()) << "nothing was dropped";
    return true;
  };
  std::ifstream stream(file, std::ios::binary);
  const McapOutcome outcome = read_mcap(stream, file.string(), visitor);
  EXPECT_TRUE(outcome.whole) << outcome.trouble;
  return out;
}

/// A robot that an operator moves over the line, while it is recorded.
class RecordedLine : public PrivateNetworkTest {
 protected:
  void SetUp() override {
    PrivateNetworkTest::SetUp();
    if (IsSkipped()) return;
    robot_.get_moving();
    robot_.robot().submit(robot_.command(false));
    robot_.run(2s);
    seat_.want_control(true);
    const fs::path files[] = {rig_file(), source_folder() / "configs" / "arm.urdf"};
    const std::string rig = attach_rig(file_.head(), files, 0);
    file_.head().add_metadata(kRecordingFacts, {{"rig", rig}, {"mock", "yes"}});
  }

  void tick(ServedOperator& served, const LinePositions& positions, bool deadman) {
    robot_.run(10ms);
    const RobotTime now = robot_.clock().now();
    const OperatorTime here{now.ns};
    operator_line_.receive(seat_, robot_.clock());
    seat_.advance(here);
    if (seat_.status(here).phase == ControlSeatStatus::Phase::holding) seat_.command(here, positions, deadman);
    operator_line_.send(seat_);
    states_.step(now);
    recorder_.step(now);
    file_.step();
    Commander* const commander = &served;
    serve(std::span(&commander, 1), robot_.robot(), now);
  }

  /// The elbow goes by 0.2 rad; a pair every 0.1 s of it. Returns where it began.
  double move_and_send_pairs() {
    for (int i = 0; i < 300 && !seat_.state().ready; ++i) tick(served_, seat_.begin(), false);
    EXPECT_TRUE(seat_.state().ready);
    for (int i = 0; i < 5; ++i) tick(served_, seat_.begin(), false);
    LinePositions positions = seat_.begin();
    const std::size_t elbow = robot_.joint("elbow");
    const double begin = positions[elbow];
    for (int i = 0; i < 200; ++i) {
      tick(served_, positions, true);
      positions[elbow] = begin + 0.2 * std::min(1.0, i / 150.0);
      if (i % 10 != 0) continue;
      frames_->put(next_pair());
      pairs_.step(0ns);
    }
    EXPECT_NEAR(robot_.shaft(elbow).position, begin + 0.2, 0.02);
    for (int i = 0; i < 5; ++i) tick(served_, positions, false);
    return begin;
  }

  std::shared_ptr<LiveFrame> next_pair() {
    auto frame = std::make_shared<LiveFrame>();
    frame->number = sent_.size() + 1;
    for (ColourImage* image : {&frame->pair.left, &frame->pair.right}) {
      image->time = robot_.clock().now();
      image->bgr = cv::Mat(240, 320, CV_8UC3);
      const int shift = static_cast<int>(3 * sent_.size());
      for (int y = 0; y < 240; ++y)
        for (int x = 0; x < 320; ++x)
          image->bgr.at<cv::Vec3b>(y, x) = cv::Vec3b::all(cv::saturate_cast<uchar>((x + y + shift) % 400 / 2));
    }
    frame->quality = "encoders";
    frame->joints = {frame->pair.left.time, StateStatus::exact, {}, {}};
    for (std::size_t i = 0; i < robot_.rig().joints.size(); ++i) {
      frame->joints.positions.push_back(robot_.shaft(i).position);
      frame->joints.known.push_back(true);
    }
    PosedFrame posed;
    posed.left.T_world_camera = Pose(Eigen::Translation3d(0.01 * static_cast<double>(sent_.size()), 0, 1));
    posed.right.emplace().T_world_camera = posed.left.T_world_camera * scene_.lenses()->T_left_right;
    frame->posed = posed;
    sent_.push_back(frame);
    return frame;
  }

  void finish() {
    recorder_.step(robot_.clock().now());
    file_.finish(recorder_.remarks());
    EXPECT_EQ(file_.trouble(), "");
  }

  TempFolder folder_;
  fs::path path_ = folder_ / "session.mcap";
  LiveRobot robot_{"minerva.yaml"};
  LiveScene scene_ = live_scene_of(robot_.rig(), /*mock=*/true, {});
  Identity identity_ = rig_identity(robot_.rig(), rig_file(), "test");
  Participant program_{LinkConfig{}, "robot minerva"};
  WallClock wall_{robot_.clock()};
  StateSender states_{program_,      {1, robot_.rig().joint_names()}, robot_.rig(), robot_.robot(), nullptr, wall_,
                      robot_.clock()};
  std::shared_ptr<FrameQueue> frames_ = std::make_shared<FrameQueue>(2);
  FrameSender pairs_{program_,      {1, robot_.rig().joint_names()}, &*scene_.lenses(),
                     frames_,       {LinkCoding::jpeg, 90, 30},      wall_,
                     robot_.clock()};
  ServedOperator served_{program_, robot_.rig().gate_options(), desk_options(identity_, 1000), robot_.clock()};
  SeatLine operator_line_{program_};
  ControlSeat seat_{seat_options(identity_)};
  RecordingFile file_{path_, robot_.clock()};
  LineRecorder recorder_{program_, file_, robot_.clock()};
  std::vector<std::shared_ptr<LiveFrame>> sent_;
};

double psnr(const cv::Mat& a, const cv::Mat& b) {
  const double error = cv::norm(a, b, cv::NORM_L2SQR) / static_cast<double>(a.total() * 3);
  return 10 * std::log10(255 * 255 / error);
}

TEST_F(RecordedLine, EverythingThatIsSaidIsInTheFileAndBecomesARun) {
  move_and_send_pairs();
  finish();
  const auto messages = messages_of(path_);
  EXPECT_EQ(messages.at("/foresight/frames").size(), 20u);
  for (const char* topic :
       {"/joint_states", "/tf", "/tf_static", "/foresight/robot_state", "/diagnostics", "/foresight/set_points",
        "/foresight/control/operator/messages", "/foresight/control/robot/messages"})
    EXPECT_GT(messages.count(topic), 0u) << topic;
  EXPECT_GT(messages.at("/foresight/control/operator/messages").size(), 150u);
  EXPECT_EQ(messages.count("/left/image_raw/compressed"), 0u) << "copies are asked for";

  const RunExport made = export_run({path_, folder_ / "run", {}, {}, false});
  EXPECT_EQ(made.pairs, 20u);
  EXPECT_EQ(made.without_pose, 0u);
  EXPECT_EQ(made.remarks, "");
  const RunFolder run = RunFolder::open(folder_ / "run", {});
  ASSERT_EQ(run.frames().size(), 20u);
  const auto names = robot_.rig().joint_names();
  for (std::size_t i = 0; i < sent_.size(); ++i) {
    const RunImage& image = run.frames()[i].left;
    const LiveFrame& sent = *sent_[i];
    EXPECT_EQ(image.time, sent.pair.left.time);
    EXPECT_TRUE(image.T_world_camera.isApprox(sent.posed->left.T_world_camera, 1e-9));
    ASSERT_TRUE(run.frames()[i].right);
    EXPECT_TRUE(run.frames()[i].right->T_world_camera.isApprox(sent.posed->right->T_world_camera, 1e-9));
    EXPECT_GT(psnr(read_run_image(image, run.lens_left()), sent.pair.left.bgr), 32);
    const auto position = [&](std::string_view joint) -> std::optional<double> {
      const auto at = std::ranges::find(names, joint);
      if (at == names.end()) return std::nullopt;
      return sent.joints.positions[static_cast<std::size_t>(at - names.begin())];
    };
    const SceneState there = run.state_at(image.time),
                     wanted = scene_.state_at(image.time, position, StateStatus::exact);
    ASSERT_EQ(there.T_world_node.size(), wanted.T_world_node.size());
    for (std::size_t node = 0; node < wanted.T_world_node.size(); ++node)
      EXPECT_TRUE(there.T_world_node[node].isApprox(wanted.T_world_node[node], 1e-6)) << i << ", node " << node;
  }
}

// Pieces of H.264, which the robot sends because somebody else reports: what that one could decode is in the run.
TEST_F(RecordedLine, PairsOfAThinLineBecomeARunToo) {
  const auto queue = std::make_shared<FrameQueue>(2);
  FrameSender thin(program_, {1, robot_.rig().joint_names()}, &*scene_.lenses(), queue, {LinkCoding::h264, 90, 30},
                   wall_, robot_.clock());
  PairIntake intake(42, {}, robot_.clock());
  Reader pieces(program_, topics::pieces());
  Writer reports(program_, topics::reports());
  std::vector<LineFramePtr> shown;
  for (int i = 0; i < 300; ++i) {
    robot_.run(10ms);
    recorder_.step(robot_.clock().now());
    file_.step();
    if (i >= 30 && i % 10 == 0) queue->put(next_pair());
    thin.step(0ns);
    pieces.take<StereoPiece>({}, [&](StereoPiece&& piece, const Sample&) {
      if (const LineFramePtr frame = intake.take(piece, RobotClockTracker())) shown.push_back(frame);
    });
    if (const auto report = intake.report()) reports.write(*report);
  }
  finish();
  ASSERT_GT(shown.size(), 20u);
  const RunExport made = export_run({path_, folder_ / "run", {}, {}, false});
  EXPECT_EQ(made.pairs, shown.size());
  EXPECT_EQ(made.remarks, "");
  const RunFolder run = RunFolder::open(folder_ / "run", {});
  for (std::size_t i = 0; i < shown.size(); ++i) {
    const RunImage& image = run.frames()[i].left;
    EXPECT_EQ(image.time, shown[i]->image[0].captured);
    EXPECT_TRUE(image.T_world_camera.isApprox(*shown[i]->image[0].T_world_camera, 1e-9));
    EXPECT_EQ(cv::norm(read_run_image(image, run.lens_left()), shown[i]->image[0].bgr, cv::NORM_INF), 0);
  }

  Playback playback(RobotTime{1}, 1, {});  // whole pairs with JPEGs
  std::size_t played = 0;
  McapVisitor visitor;
  visitor.message = [&](const McapMessage& message) {
    for (const Playback::Message& one : playback.take(message)) {
      if (one.topic->name != topics::frames().name) continue;
      const auto frame = from_cdr<StereoFrame>(one.cdr);
      EXPECT_TRUE(frame && objection(*frame).empty());
      const cv::Mat picture = cv::imdecode(frame->right.data, cv::IMREAD_COLOR);
      EXPECT_GT(psnr(picture, shown.at(played++)->image[1].bgr), 35);
    }
    return true;
  };
  std::ifstream stream(path_, std::ios::binary);
  EXPECT_TRUE(read_mcap(stream, "session.mcap", visitor).whole);
  EXPECT_EQ(played, shown.size());
}

// The stream has gone on for a while; who records reports nothing, and asks for nothing.
TEST_F(RecordedLine, ARecorderThatComesLateHasPairsFromThenOn) {
  const auto queue = std::make_shared<FrameQueue>(2);
  FrameSender thin(program_, {1, robot_.rig().joint_names()}, &*scene_.lenses(), queue, {LinkCoding::h264, 90, 30},
                   wall_, robot_.clock());
  PairIntake intake(42, {}, robot_.clock());
  Reader pieces(program_, topics::pieces());
  Writer reports(program_, topics::reports());
  std::vector<LineFramePtr> before, since;
  constexpr int kComes = 150;
  for (int i = 0; i < 300; ++i) {
    robot_.run(10ms);
    if (i >= kComes) {
      recorder_.step(robot_.clock().now());
      file_.step();
    }
    if (i % 10 == 0) queue->put(next_pair());
    thin.step(0ns);
    pieces.take<StereoPiece>({}, [&](StereoPiece&& piece, const Sample&) {
      if (const LineFramePtr frame = intake.take(piece, RobotClockTracker()))
        (i < kComes ? before : since).push_back(frame);
    });
    if (const auto report = intake.report()) reports.write(*report);
  }
  finish();
  ASSERT_GT(before.size(), 8u);
  ASSERT_GT(since.size(), 8u);
  const RunExport made = export_run({path_, folder_ / "run", {}, {}, false});
  EXPECT_GE(made.pairs + 2, since.size());
  const RunFolder run = RunFolder::open(folder_ / "run", {});
  for (const auto& [left, right] : run.frames()) {
    const auto shown =
        std::ranges::find(since, left.time, [](const LineFramePtr& frame) { return frame->image[0].captured; });
    ASSERT_NE(shown, since.end());
    EXPECT_EQ(cv::norm(read_run_image(left, run.lens_left()), (*shown)->image[0].bgr, cv::NORM_INF), 0);
  }
}

// The same robot, and one that was started anew, hear all that the operator said once more.
TEST_F(RecordedLine, RecordedCommandsMoveNothing) {
  move_and_send_pairs();
  finish();
  const std::size_t elbow = robot_.joint("elbow");
  const std::vector<Bytes> said = messages_of(path_).at("/foresight/control/operator/messages");
  Writer stranger(program_, kToRobot);
  ServedOperator again(program_, robot_.rig().gate_options(), desk_options(identity_, 5000), robot_.clock());
  for (ServedOperator* const served : {&served_, &again}) {
    for (int i = 0; i < 300; ++i) {  // the operator has gone
      robot_.run(10ms);
      Commander* const commander = served;
      serve(std::span(&commander, 1), robot_.robot(), robot_.clock().now());
    }
    robot_.expect_at_rest("the operator has gone");
    const double before = robot_.shaft(elbow).position;
    const std::uint64_t followed = served->desk().counts().followed;
    for (const Bytes& message : said) {
      stranger.write(message);
      robot_.run(10ms);
      Commander* const commander = served;
      serve(std::span(&commander, 1), robot_.robot(), robot_.clock().now());
      ASSERT_NE(robot_.robot().status().gate.state, GateState::following);
    }
    EXPECT_EQ(served->desk().counts().followed, followed);
    EXPECT_NEAR(robot_.shaft(elbow).position, before, 1e-3);
    robot_.expect_at_rest("whatever is played");
  }
}

TEST_F(RecordedLine, AnExportSaysWhatItLacks) {
  finish();
  const auto words = [&](const RunExportOptions& options) {
    try {
      export_run(options);
    } catch (const InputError& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  EXPECT_THAT(words({path_, folder_ / "run", {}, {}, false}), HasSubstr("has no pair of images that can be used"));
  EXPECT_FALSE(fs::exists(folder_ / "run"));
  {
    RecordingFile bare(folder_ / "bare.mcap", robot_.clock());
    bare.finish({});
  }
  EXPECT_THAT(words({folder_ / "bare.mcap", folder_ / "run", {}, {}, false}), HasSubstr("has no rig in it"));
}

// As of a head that was not homed all the while.
TEST_F(RecordedLine, PairsWithoutAnyPoseAreNoRun) {
  for (int i = 0; i < 20; ++i) {
    tick(served_, seat_.begin(), false);
    const auto pair = next_pair();
    pair->posed.reset();
    frames_->put(pair);
    pairs_.step(0ns);
  }
  finish();
  try {
    export_run({path_, folder_ / "run", {}, {}, false});
    ADD_FAILURE() << "was exported";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), ContainsRegex("session.mcap: has [0-9]+ pairs of images, and no pose of any"));
    EXPECT_THAT(error.what(), HasSubstr("home the robot's head before you record"));
  }
  for (const auto& left : fs::directory_iterator(folder_.path())) EXPECT_EQ(left.path(), path_);
}

TEST(RigFiles, NothingIsUnpackedElsewhere) {
  UnpackedRig rig;
  const std::vector<std::uint8_t> data{1, 2};
  for (const char* name : {"rig/../../elsewhere", "rig/../..", "rig//../../x"})
    EXPECT_THROW(rig.take(name, data), InputError) << name;
  rig.take("/etc/passwd", data);  // none of a rig's
  rig.take("rig/a/b.yaml", data);
  EXPECT_TRUE(fs::exists(rig.file("rig/a/b.yaml")));
}

}  // namespace
}  // namespace foresight::link::line_test
