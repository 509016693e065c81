#include "drivers/can/candump_log.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>

#include <csignal>

#include "common/error.hpp"
#include "tests/can/frames.hpp"
#include "tests/support/folders.hpp"

namespace foresight::candump_log_test {
namespace {

using testing::HasSubstr;

CanFrame parsed(const std::string& text) {
  const ParsedFrame out = parse_can_frame(text);
  EXPECT_TRUE(out.frame) << text << ": " << out.problem;
  return out.frame.value_or(CanFrame{});
}

TEST(CandumpLog, ReadsEveryForm) {
  EXPECT_TRUE(same(parsed("123#DEADBEEF"), frame(0x123, {0xde, 0xad, 0xbe, 0xef})));
  EXPECT_TRUE(same(parsed("7ff#de.ad"), frame(0x7ff, {0xde, 0xad})));
  EXPECT_TRUE(same(parsed("080#"), frame(0x80)));
  EXPECT_TRUE(parsed("1F334455#11").extended);
  EXPECT_EQ(parsed("1F334455#11").id, 0x1f334455u);
  EXPECT_TRUE(parsed("00000001#").extended) << "8 digits mean 29 bits, whatever the value";
  EXPECT_TRUE(parsed("123#R").remote);
  EXPECT_EQ(parsed("123#R5").size, 5);
  EXPECT_EQ(parsed("123#1122334455667788_E").size, 8);
  const CanFrame fd = parsed("123##1" + std::string(24, 'A'));
  EXPECT_TRUE(fd.fd && fd.bit_rate_switch);
  EXPECT_EQ(fd.size, 12);
  EXPECT_FALSE(parsed("123##0").bit_rate_switch);
  const CanFrame error = parsed("20000040#0000000000000000");
  EXPECT_TRUE(error.error && !error.extended);
  EXPECT_EQ(error.id, 0x40u);
}

TEST(CandumpLog, SaysWhatIsWrongWithAFrame) {
  const std::pair<const char*, const char*> cases[] = {{"123", "no #"},
                                                       {"12#", "neither 3 nor 8"},
                                                       {"1G3#", "else than hex"},
                                                       {"800#", "above 7FF"},
                                                       {"123#1", "no pairs"},
                                                       {"123#GG", "no pairs"},
                                                       {"123#112233445566778899", "more than 8"},
                                                       {"123#R9", "not 0 to 8"},
                                                       {"123##", "no hex digit"},
                                                       {"123##0112233445566778899", "CAN FD does not have"},
                                                       {"123#R12", "something"},
                                                       {"60000000#", "above 1FFFFFFF"},
                                                       {"123#11_9", "raw length"},
                                                       {"20000040#R", "error frame"},
                                                       {"", "no #"}};
  for (const auto& [text, problem] : cases) {
    const ParsedFrame out = parse_can_frame(text);
    EXPECT_FALSE(out.frame) << text;
    EXPECT_THAT(out.problem, HasSubstr(problem)) << text;
  }
}

TEST(CandumpLog, WritesWhatCanUtilsWrites) {
  std::array<char, kLongestLogLine> line;
  const auto write = [&](CanFrame f, std::optional<bool> sent = {}) {
    return std::string(line.data(), write_log_line(Duration{1'700'000'000'123'456'789}, "can0", f, sent, line));
  };
  EXPECT_EQ(write(frame(0x23, {0xde, 0xad})), "(1700000000.123456) can0 023#DEAD\n");
  CanFrame remote = frame(0x1f334455);
  remote.extended = remote.remote = true;
  remote.size = 8;
  EXPECT_EQ(write(remote, true), "(1700000000.123456) can0 1F334455#R8 T\n");
  CanFrame error = frame(0x40, {0, 1});
  error.error = true;
  EXPECT_EQ(write(error, false), "(1700000000.123456) can0 20000040#0001 R\n");
}

TEST(CandumpLog, RoundTripsTenThousandRandomFrames) {
  std::mt19937 random(3);
  for (int i = 0; i < 10000; ++i) {
    CanFrame f = random_frame(random);
    if (i % 50 == 0) {
      f = frame(below(random, 0x200), {1, 2, 3, 4, 5, 6, 7, 8});
      f.error = true;
    }
    const std::string text = to_text(f);
    ASSERT_LE(text.size(), kLongestFrameText);
    ASSERT_TRUE(same(parsed(text), f)) << text;
    const auto entry = parse_log_line("(1.000001) vcan12345678901 " + text + " T", "here");
    ASSERT_TRUE(entry && entry->sent == true && same(entry->frame, f)) << text;
  }
}

TEST(CandumpLog, TenThousandMutilatedLinesGiveAFrameOrAnInputError) {
  std::mt19937 random(4);
  int good = 0, bad = 0, empty = 0;
  for (int i = 0; i < 10000; ++i) {
    std::string line = "(1700000000.123456) can0 " + to_text(random_frame(random)) + (i % 2 ? " R" : "");
    const std::uint32_t changes = below(random, 4);
    for (std::uint32_t k = 0; k < changes && !line.empty(); ++k) {
      const std::size_t at = below(random, static_cast<std::uint32_t>(line.size()));
      switch (below(random, 4)) {
        case 0: line[at] = static_cast<char>(random()); break;
        case 1: line.erase(at, 1 + below(random, 20)); break;
        case 2: line.insert(at, 1, "# ()R_.0F"[below(random, 9)]); break;
        default: line.resize(at); break;
      }
    }
    try {
      const auto entry = parse_log_line(line, "file:1");
      ++(entry ? good : empty);
      if (!entry) continue;
      const std::string again = to_text(entry->frame);
      ASSERT_TRUE(same(parsed(again), entry->frame)) << line;
    } catch (const InputError& error) {
      ++bad;
      ASSERT_THAT(error.what(), HasSubstr("file:1: "));
    }
  }
  EXPECT_GT(good, 1000);
  EXPECT_GT(bad, 1000);
  EXPECT_GT(empty, 0);
}

TEST(CandumpReader, NamesFileAndLine) {
  const TempFile file("# a comment\r\n\r\n(0.5) can0 123#11\r\ncan0 70A#00 # boot-up\n(x) can0 1#\n");
  CandumpReader reader(file.path());
  const auto first = reader.next(), second = reader.next();
  ASSERT_TRUE(first && second);
  EXPECT_EQ(first->time, Duration{500'000'000});
  EXPECT_FALSE(second->time);
  EXPECT_EQ(second->frame.id, 0x70au);
  EXPECT_EQ(reader.line(), 4);
  try {
    reader.next();
    FAIL() << "no error";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr(file.path().string() + ":5: a time that is no number"));
    EXPECT_THAT(error.what(), HasSubstr("write it as"));
  }
  EXPECT_THROW(CandumpReader("/nowhere/at/all.log"), InputError);
  EXPECT_THROW(CandumpReader("/tmp"), InputError);
}

TEST(CandumpReader, ReadsTracesOfRealDrives) {
  const auto folder = data_folder() / "can/cia402_traces";
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << folder << " is not here; set FORESIGHT_DATA";
  const std::pair<const char*, int> files[] = {
      {"abb_cm588_boot.log", 3}, {"maxon_epos_pdo_enable.log", 9}, {"epos_ros_canopen_259.log", 15}};
  for (const auto& [name, frames] : files) {
    CandumpReader reader(folder / name);
    int read = 0;
    while (reader.next()) ++read;
    EXPECT_EQ(read, frames) << name;
  }
}

TEST(CandumpWriter, IsReadBack) {
  const TempFile file;
  std::mt19937 random(5);
  std::vector<CanFrame> frames;
  {
    CandumpWriter writer(file.path());
    for (int i = 0; i < 500; ++i) {
      frames.push_back(random_frame(random));
      writer.write(Duration{i * 1'000'000LL}, "can0", frames.back());
    }
  }
  CandumpReader reader(file.path());
  for (int i = 0; i < 500; ++i) {
    const auto entry = reader.next();
    ASSERT_TRUE(entry && same(entry->frame, frames[static_cast<std::size_t>(i)])) << i;
    EXPECT_EQ(entry->time, Duration{i * 1'000'000LL});
  }
  EXPECT_FALSE(reader.next());
}

TEST(CandumpWriter, SaysThatTheDiskIsFull) {
  if (!std::filesystem::exists("/dev/full")) GTEST_SKIP() << "no /dev/full here";
  CandumpWriter writer("/dev/full");
  EXPECT_THROW(
      {
        writer.write(Duration{0}, "can0", frame(1));
        writer.flush();
      },
      RuntimeFailure);
  EXPECT_THROW(CandumpWriter("/nowhere/at/all.log"), RuntimeFailure);
}

// A file's size limit ends writing as a full disk does.
TEST(CandumpWriter, AnEmptyFileGoes) {
  const TempFile file;
  rlimit before{};
  getrlimit(RLIMIT_FSIZE, &before);
  const auto ignored = std::signal(SIGXFSZ, SIG_IGN);
  const rlimit none{0, before.rlim_max};
  setrlimit(RLIMIT_FSIZE, &none);
  {
    CandumpWriter writer(file.path());
    EXPECT_TRUE(std::filesystem::exists(file.path()));
    writer.write(Duration{0}, "can0", frame(1));
    EXPECT_THROW(writer.flush(), RuntimeFailure);
  }
  setrlimit(RLIMIT_FSIZE, &before);
  std::signal(SIGXFSZ, ignored);
  EXPECT_FALSE(std::filesystem::exists(file.path()));
  { CandumpWriter writer(file.path()); }
  EXPECT_FALSE(std::filesystem::exists(file.path())) << "nothing came";
}

}  // namespace
}  // namespace foresight::candump_log_test
