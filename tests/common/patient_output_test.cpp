#include "common/patient_output.hpp"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <array>
#include <csignal>

namespace foresight {
namespace {

using namespace std::chrono_literals;

class PatientOutputTest : public testing::Test {
 protected:
  PatientOutputTest() { std::signal(SIGPIPE, SIG_IGN); }  // as the program does
};

/// A pipe that is full: who writes into it waits until somebody reads.
class FullPipe {
 public:
  FullPipe() {
    if (pipe(ends_) != 0) throw std::runtime_error("no pipe");
    fcntl(ends_[1], F_SETFL, O_NONBLOCK);
    while (write(ends_[1], ".", 1) == 1) ++filled_;
    fcntl(ends_[1], F_SETFL, 0);
  }
  ~FullPipe() {
    close(ends_[0]);  // ends a write that still waits
    close(ends_[1]);
  }
  int in() const { return ends_[1]; }
  /// All that comes until `output` has nothing left, without what filled the pipe.
  std::string read_all(PatientOutput& output) {
    std::string all;
    while (!output.finish(0ms) || all.size() < filled_ + 1) all += read_some();
    fcntl(ends_[0], F_SETFL, O_NONBLOCK);
    for (std::string more = read_some(); !more.empty(); more = read_some()) all += more;
    return all.substr(filled_);
  }

 private:
  std::string read_some() {
    std::array<char, 4096> bytes;
    const auto count = read(ends_[0], bytes.data(), bytes.size());
    return count > 0 ? std::string(bytes.data(), static_cast<std::size_t>(count)) : "";
  }
  int ends_[2]{};
  std::size_t filled_ = 0;
};

/// Where it waited, these tests would never end.
TEST_F(PatientOutputTest, WaitsForNobodyWhoDoesNotRead) {
  FullPipe pipe;
  PatientOutput output(pipe.in());
  output.say("one\n");
  output.say("two\n");
  EXPECT_FALSE(output.finish(10ms));
  EXPECT_EQ(pipe.read_all(output), "one\ntwo\n");
  EXPECT_TRUE(output.finish(0ms));
}

TEST_F(PatientOutputTest, EndsWhileNobodyReads) {
  FullPipe pipe;
  PatientOutput(pipe.in()).say("nobody reads this\n");
}

TEST_F(PatientOutputTest, ShowsTheNewestPictureAfterWhatWasSaid) {
  FullPipe pipe;
  PatientOutput output(pipe.in());
  output.say("first\n");  // may be on its way already: pictures wait behind it
  output.show("old picture\n");
  output.say("second\n");
  output.show("newest picture\n");
  EXPECT_EQ(pipe.read_all(output), "first\nsecond\nnewest picture\n");
}

TEST_F(PatientOutputTest, TellsHowManyLinesNobodyRead) {
  FullPipe pipe;
  PatientOutput output(pipe.in());
  const std::size_t said = PatientOutput::kRoom + 8;
  for (std::size_t i = 0; i < said; ++i) output.say(std::to_string(i) + "\n");
  const std::string read = pipe.read_all(output);
  // The first may have been on its way.
  const bool seven = read.starts_with("0\n[7 lines were not shown: nobody read them]\n8\n");
  EXPECT_TRUE(seven || read.starts_with("[8 lines were not shown: nobody read them]\n8\n")) << read.substr(0, 60);
  EXPECT_TRUE(read.ends_with(std::to_string(said - 1) + "\n"));
}

TEST_F(PatientOutputTest, GoesOnWhereTheReaderIsGone) {
  int ends[2];
  ASSERT_EQ(pipe(ends), 0);
  close(ends[0]);
  PatientOutput output(ends[1]);
  output.say("one\n");
  output.say("two\n");
  EXPECT_TRUE(output.finish(std::chrono::seconds(60)));
  close(ends[1]);
}

}  // namespace
}  // namespace foresight
