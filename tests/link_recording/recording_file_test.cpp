// Recordings on disks that are slow, full or gone, and of programs that are killed.
#include <fcntl.h>
#include <gmock/gmock.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <random>

#include "common/error.hpp"
#include "link/messages/message_types.hpp"
#include "link/recording/mcap_reader.hpp"
#include "link/recording/message_definitions.hpp"
#include "link/recording/recording_file.hpp"
#include "tests/scene/test_run.hpp"

namespace foresight::link::recording_file_test {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;
namespace fs = std::filesystem;

struct Content {
  std::vector<std::uint32_t> sequences;
  std::map<std::string, std::map<std::string, std::string>> metadata;
  McapOutcome outcome;
};

Content read(const fs::path& file) {
  Content out;
  McapVisitor visitor;
  visitor.message = [&](const McapMessage& message) {
    out.sequences.push_back(message.sequence);
    return true;
  };
  visitor.metadata = [&](const std::string& name, const auto& texts) { out.metadata[name] = texts; };
  std::ifstream stream(file, std::ios::binary);
  out.outcome = read_mcap(stream, file.string(), visitor);
  return out;
}

class RecordingFiles : public testing::Test {
 protected:
  std::size_t add_channel(RecordingFile& file) {
    return file.add_channel("/joint_states", JointStateMessage::kType, {{"kept", "no"}});
  }
  fs::path path() const { return folder_ / "a.mcap"; }

  TempFolder folder_;
  SteppedClock clock_;
};

TEST_F(RecordingFiles, ChunksAreOnTheDiskOnceTheyAreASecondOld) {
  RecordingFile file(path(), clock_);
  const std::size_t channel = add_channel(file);
  std::size_t put = 0;
  for (int step = 0; step < 40; ++step) {  // 0.1 s each
    EXPECT_TRUE(file.put(channel, clock_.now().ns, clock_.now().ns, std::vector<std::uint8_t>(100)));
    ++put;
    file.step();
    const Content so_far = read(path());  // as it would be if the program ended here
    EXPECT_GE(so_far.sequences.size() + 11, put);
    EXPECT_FALSE(so_far.outcome.whole);
    clock_.sleep_until(clock_.now() + 100ms);
  }
  file.finish({{"/joint_states", "came 40"}});
  const Content content = read(path());
  EXPECT_TRUE(content.outcome.whole) << content.outcome.trouble;
  EXPECT_EQ(content.sequences.size(), put);
  EXPECT_EQ(content.metadata.at("foresight.end").at("/joint_states"), "came 40");
  EXPECT_EQ(file.counts().written, put);
  EXPECT_EQ(file.counts().dropped, 0u);
}

// The disk is a pipe that nobody empties: put() comes back all the same, what has no room is counted, and numbers of
// messages tell where it is missing.
TEST_F(RecordingFiles, ADiskThatStandsStillHoldsUpNobody) {
  ASSERT_EQ(::mkfifo(path().c_str(), 0600), 0);
  const UniqueFd reader(::open(path().c_str(), O_RDONLY | O_NONBLOCK));
  RecordingFileOptions options;
  options.room = 1'000'000;
  options.chunk_bytes = 100'000;
  MonotonicClock clock;
  RecordingFile file(path(), clock, options);
  const std::size_t channel = add_channel(file);
  file.start();
  std::uint64_t dropped = 0;
  for (int i = 0; i < 1000; ++i) dropped += file.put(channel, i, i, std::vector<std::uint8_t>(10'000, 1)) ? 0 : 1;
  EXPECT_GE(dropped, 750u);  // 10 MB came, 1 MB may wait, 1 MB may be the thread's; what the pipe holds is little
  EXPECT_EQ(file.counts().dropped, dropped);
  EXPECT_EQ(file.trouble(), "");

  std::string came;  // now the disk works again
  std::jthread disk([&](const std::stop_token& stop) {
    std::vector<char> some(1 << 16);
    for (;;) {
      const ssize_t size = ::read(reader.get(), some.data(), some.size());
      if (size > 0) came.append(some.data(), static_cast<std::size_t>(size));
      if (size <= 0 && stop.stop_requested()) return;
      if (size <= 0) std::this_thread::sleep_for(1ms);
    }
  });
  file.finish({});
  disk.request_stop();
  disk.join();
  std::istringstream stream(came);
  std::vector<std::uint32_t> sequences;
  McapVisitor visitor;
  visitor.message = [&](const McapMessage& message) {
    sequences.push_back(message.sequence);
    return true;
  };
  EXPECT_TRUE(read_mcap(stream, "pipe", visitor).whole);
  EXPECT_EQ(sequences.size() + dropped, 1000u);
  EXPECT_TRUE(std::ranges::is_sorted(sequences));
}

// As a file that may not grow any further; then it is closed properly, and the words say what is the case.
TEST_F(RecordingFiles, AFullDiskEndsItInOrder) {
  const auto before = std::signal(SIGXFSZ, SIG_IGN);
  rlimit limit{};
  ::getrlimit(RLIMIT_FSIZE, &limit);
  const rlim_t soft = limit.rlim_cur;
  {
    RecordingFileOptions options;
    options.chunk_bytes = 20'000;
    RecordingFile file(path(), clock_, options);
    const std::size_t channel = add_channel(file);
    limit.rlim_cur = 100'000;
    ::setrlimit(RLIMIT_FSIZE, &limit);
    std::mt19937 random(3);
    std::vector<std::uint8_t> data(1000);
    for (int i = 0; i < 200; ++i) {
      for (std::uint8_t& byte : data) byte = static_cast<std::uint8_t>(random());
      file.put(channel, i, i, data);
      file.step();
    }
    EXPECT_THAT(file.trouble(), HasSubstr("a.mcap (File too large)"));
    EXPECT_GT(file.counts().dropped, 90u);
    file.finish({});
  }
  limit.rlim_cur = soft;
  ::setrlimit(RLIMIT_FSIZE, &limit);
  std::signal(SIGXFSZ, before);
  const Content content = read(path());
  EXPECT_TRUE(content.outcome.whole) << content.outcome.trouble;
  EXPECT_GE(content.sequences.size(), 60u);
}

TEST_F(RecordingFiles, ADiskThatIsFullFromTheBeginningIsRefused) {
  RecordingFileOptions options;
  options.spare_bytes = 1e18;
  EXPECT_THROW(RecordingFile(path(), clock_, options), RuntimeFailure);
  EXPECT_THROW(RecordingFile("/nowhere/at/all.mcap", clock_), RuntimeFailure);
}

// 20 times, at any instant.
TEST_F(RecordingFiles, AKilledRecorderLeavesAFileThatOpens) {
  for (int round = 0; round < 20; ++round) {
    int pipe[2];
    ASSERT_EQ(::pipe(pipe), 0);
    const pid_t child = ::fork();
    if (child == 0) {
      MonotonicClock clock;
      RecordingFileOptions options;
      options.chunk_bytes = 30'000;
      RecordingFile file(path(), clock, options);
      const std::size_t channel = add_channel(file);
      for (int i = 0;; ++i) {
        file.put(channel, i, i, std::vector<std::uint8_t>(static_cast<std::size_t>(500 + i % 97), 1));
        file.step();
        if (i == 500 && ::write(pipe[1], "x", 1) != 1) ::_exit(1);
      }
    }
    char some = 0;
    ASSERT_EQ(::read(pipe[0], &some, 1), 1);
    ::usleep(static_cast<useconds_t>(37 * round));
    ::kill(child, SIGKILL);
    ::waitpid(child, nullptr, 0);
    ::close(pipe[0]);
    ::close(pipe[1]);
    const Content content = read(path());
    EXPECT_GE(content.sequences.size(), 400u);
    EXPECT_THAT(content.outcome.trouble, HasSubstr("the file ends"));
    for (std::size_t i = 0; i < content.sequences.size(); ++i) ASSERT_EQ(content.sequences[i], i + 1);
  }
}

TEST(MessageDefinitions, AreThoseOfRos2) {
  const MessageDefinition joints = message_definition(JointStateMessage::kType);
  EXPECT_EQ(joints.name, "sensor_msgs/msg/JointState");
  EXPECT_EQ(joints.encoding, "ros2msg");
  const std::string line(80, '=');
  EXPECT_EQ(joints.text,
            "std_msgs/Header header\nstring[] name\nfloat64[] position\nfloat64[] velocity\nfloat64[] effort\n" + line +
                "\nMSG: std_msgs/Header\nbuiltin_interfaces/Time stamp\nstring frame_id\n" + line +
                "\nMSG: builtin_interfaces/Time\nint32 sec\nuint32 nanosec\n");
  EXPECT_THAT(message_definition(CameraInfoMessage::kType).text,
              HasSubstr("float64[9] k\nfloat64[9] r\nfloat64[12] p\n"));
  EXPECT_THAT(message_definition(StereoFrame::kType).text, HasSubstr("uint8[] data\n"));
  for (const MessageType& type : message_types())
    EXPECT_EQ(message_definition(type.name).encoding, "ros2msg") << type.name;
}

TEST(MessageDefinitions, WhatRos2CannotSayStaysIdlAndStrangersKeepTheirName) {
  const MessageDefinition control = message_definition("foresight_msgs::msg::dds_::FromOperator_");
  EXPECT_EQ(control.encoding, "omgidl");
  EXPECT_EQ(control.name, "foresight_msgs::msg::dds_::FromOperator_");
  EXPECT_THAT(control.text, HasSubstr("@final union FromOperatorBody_ switch (long) {\n"));
  EXPECT_THAT(control.text, HasSubstr("  case 6:  foresight_msgs::msg::dds_::SetPoint_ set_point;\n"));
  const MessageDefinition stranger = message_definition("geometry_msgs::msg::dds_::WrenchStamped_");
  EXPECT_EQ(stranger.name, "geometry_msgs/msg/WrenchStamped");
  EXPECT_EQ(stranger.encoding, "");
  EXPECT_EQ(stranger.text, "");
}

}  // namespace
}  // namespace foresight::link::recording_file_test
