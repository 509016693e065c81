#include "link/line/trace.hpp"

#include <fstream>

#include "common/error.hpp"
#include "tests/support/folders.hpp"

namespace foresight::trace_test {
namespace {

using std::chrono::milliseconds;
using testing::AllOf;
using testing::HasSubstr;
using testing::ThrowsMessage;

struct TraceFile {
  explicit TraceFile(const std::string& text)
      : path(std::filesystem::path(testing::TempDir()) /
             ("trace_" + std::string(testing::UnitTest::GetInstance()->current_test_info()->name()) + ".txt")) {
    std::ofstream(path, std::ios::binary) << text;
  }
  ~TraceFile() { std::filesystem::remove(path); }
  std::filesystem::path path;
};

void expect_refused(const std::string& text, const std::string& where, const std::string& what) {
  const TraceFile file(text);
  EXPECT_THAT([&] { read_line_traces(file.path); },
              ThrowsMessage<InputError>(AllOf(HasSubstr(file.path.string() + where), HasSubstr(what))))
      << text;
}

TEST(Trace, ReadsEachForm) {
  const TraceFile chances("3\n3\n7\n");
  const LineTraces one_way = read_line_traces(chances.path);
  EXPECT_EQ(std::get<DeliveryTrace>(*one_way.up).at_ms, (std::vector<std::uint32_t>{3, 3, 7}));
  EXPECT_EQ(one_way.down, nullptr);
  EXPECT_EQ(period_of(*one_way.up), milliseconds(7));

  const TraceFile packets("time_s,up_delay_ms,up_loss,down_delay_ms,down_loss\n5.00,32.5,0,36,1\n5.01,30,1,36.25,0\n");
  const LineTraces both = read_line_traces(packets.path);
  EXPECT_EQ(std::get<PacketTrace>(*both.up).delay[0], std::chrono::microseconds(32'500));
  EXPECT_TRUE(std::get<PacketTrace>(*both.up).lost[1]);
  EXPECT_TRUE(std::get<PacketTrace>(*both.down).lost[0]);
  EXPECT_EQ(std::get<PacketTrace>(*both.up).at[1], milliseconds(10));
  EXPECT_EQ(period_of(*both.down), milliseconds(20));

  const TraceFile rates("# a comment\ntime_s,up_kbps,down_kbps\n0,800,0\n2,0,1600\n");
  const LineTraces rated = read_line_traces(rates.path);
  EXPECT_DOUBLE_EQ(std::get<RateTrace>(*rated.up).bytes_per_s[0], 100'000);
  EXPECT_DOUBLE_EQ(std::get<RateTrace>(*rated.down).bytes_per_s[1], 200'000);
  EXPECT_EQ(period_of(*rated.up), milliseconds(4000));
}

TEST(Trace, RefusesWhatIsNoTraceNamingTheLine) {
  expect_refused("", ": ", "empty");
  expect_refused("# nothing\n\n", ": ", "empty");
  expect_refused("1\n3\n2\n", ":3", "not sorted");
  expect_refused("1\n2 3\n", ":2", "no time in ms");
  expect_refused("1\n-2\n", ":2", "no time in ms");
  expect_refused("1\n1.5\n", ":2", "no time in ms");
  expect_refused("0\n0\n", ": ", "0 ms");
  expect_refused("99999999999\n", ":1", "no time in ms");
  expect_refused("time_s,up_kbps\n0,1\n", ":1", "columns");
  expect_refused("time_s,up_kbps,down_kbps,more\n0,1\n", ":1", "columns");
  expect_refused("time_s,up_kbps,down_kbps\n0,1,1\n1,1\n", ":3", "2 fields");
  expect_refused("time_s,up_kbps,down_kbps\n1,1,1\n0,1,1\n", ":3", "increase");
  expect_refused("time_s,up_kbps,down_kbps\n0,1,1\n", ": ", "fewer than two rows");
  expect_refused("time_s,up_kbps,down_kbps\n0,1,0\n1,1,0\n", ": ", "never carries");
  expect_refused("time_s,up_kbps,down_kbps\n0,1,1\n1,nan,1\n", ":3", "up_kbps");
  expect_refused("time_s,up_kbps,down_kbps\n0,1,1\n1,-1,1\n", ":3", "up_kbps");
  expect_refused("time_s,up_kbps,down_kbps\n0,1,1\n1,1e-300,1\n", ":3", "0.001 to 1e9 kbps");
  expect_refused("time_s,up_kbps,down_kbps\n0,1,1\n0.0000001,1,1\n", ": ", "less than 1 ms");
  expect_refused("time_s,up_delay_ms,up_loss,down_delay_ms,down_loss\n0,1,0,1,2\n", ":2", "0 or 1");
  expect_refused("time_s,up_delay_ms,up_loss,down_delay_ms,down_loss\n0,1,1,1,0\n1,1,1,1,0\n", ": ", "lost");
}

TEST(Trace, ReadsTheRecordedOnes) {
  const std::filesystem::path folder = data_folder() / "line_traces";
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << "no recorded lines at " << folder;
  EXPECT_TRUE(read_line_traces(folder / "ATT-LTE-driving.up").up);
  EXPECT_EQ(std::get<PacketTrace>(*read_line_traces(folder / "starlink.csv").down).at.size(), 10'000U);
}

}  // namespace
}  // namespace foresight::trace_test
