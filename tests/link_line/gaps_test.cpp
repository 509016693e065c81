// Gaps of a line: by its trace, by its outages, and by both.
#include "link/line/gaps.hpp"

#include <gmock/gmock.h>

#include "tests/scene/test_run.hpp"
#include "tests/support/folders.hpp"

namespace foresight::gaps_test {
namespace {

using std::chrono::milliseconds;

class Gaps : public testing::Test {
 protected:
  std::shared_ptr<const Trace> trace(const std::string& text) {
    return read_line_traces(folder_.write("trace", text)).up;
  }
  /// Of at least a second, begin and end in ms.
  static std::vector<std::pair<long long, long long>> of(const DirectionSpec& spec, Duration length) {
    std::vector<std::pair<long long, long long>> out;
    for (const Gap& gap : gaps_of(spec, milliseconds(1000), length))
      out.emplace_back(gap.begin / milliseconds(1), gap.end / milliseconds(1));
    return out;
  }
  static Outage outage(double at_s, double for_s, double every_s = 0, bool loses = false) {
    return {.at = seconds(at_s), .lasts = seconds(for_s), .every = seconds(every_s), .loses = loses};
  }
  using Found = std::vector<std::pair<long long, long long>>;
  TempFolder folder_;
};

TEST_F(Gaps, AreThoseBetweenChances) {
  DirectionSpec spec;
  spec.trace = trace("1500\n1600\n4000\n");
  EXPECT_EQ(of(spec, milliseconds(6000)), (Found{{0, 1500}, {1600, 4000}, {4000, 5500}}));
  spec.outages = {outage(1.4, 0.5)};
  EXPECT_EQ(of(spec, milliseconds(6000)), (Found{{0, 4000}, {4000, 5500}})) << "two chances are taken";
}

TEST_F(Gaps, AreThoseWithoutARate) {
  DirectionSpec spec;
  spec.trace = trace("time_s,up_kbps,down_kbps\n0,800,1\n2,0,1\n3.5,800,1\n4,0,1\n4.5,0,1\n");
  EXPECT_EQ(of(spec, milliseconds(8000)), (Found{{2000, 3500}, {4000, 5000}, {7000, 8000}}));
  spec.outages = {outage(3.4, 0.7)};
  EXPECT_EQ(of(spec, milliseconds(6000)), (Found{{2000, 5000}})) << "what follows each other is one";
}

TEST_F(Gaps, AreOutagesThatSomebodyWroteDown) {
  DirectionSpec spec;
  spec.outages = {outage(2, 1.5, 10), outage(5, 0.5), outage(8, 1, 0, true)};
  EXPECT_EQ(of(spec, milliseconds(20'000)), (Found{{2000, 3500}, {8000, 9000}, {12'000, 13'500}}));
  spec.bytes_per_s = 1000;
  spec.outages.push_back(outage(3, 1));
  EXPECT_EQ(of(spec, milliseconds(5000)), (Found{{2000, 4000}}));
}

TEST(RecordedLines, HaveTheGapsThatWereCounted) {
  const std::filesystem::path file = data_folder() / "line_traces" / "ATT-LTE-driving.up";
  if (!std::filesystem::exists(file)) GTEST_SKIP() << "no recorded line at " << file;
  DirectionSpec att;
  att.trace = read_line_traces(file).up;
  EXPECT_EQ(gaps_of(att, milliseconds(1000), period_of(*att.trace)).size(), 18U);
}

}  // namespace
}  // namespace foresight::gaps_test
