#include "link/line/line_spec.hpp"

#include <fstream>

#include "common/error.hpp"

namespace foresight::line_spec_test {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::ThrowsMessage;

class LineSpecFile : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = std::filesystem::path(testing::TempDir()) /
              ("line_spec_" + std::string(testing::UnitTest::GetInstance()->current_test_info()->name()));
    std::filesystem::create_directories(folder_);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }
  std::filesystem::path write(const std::string& name, const std::string& text) {
    std::ofstream(folder_ / name, std::ios::binary) << text;
    return folder_ / name;
  }
  void expect_refused(const std::string& text, const std::string& what) {
    const auto file = write("line.yaml", text);
    EXPECT_THAT([&] { read_line_spec(file); },
                ThrowsMessage<InputError>(AllOf(HasSubstr(file.string() + ":"), HasSubstr(what))))
        << text;
  }
  std::filesystem::path folder_;
};

TEST_F(LineSpecFile, ReadsAllItsFields) {
  write("drive.up", "2\n5\n");
  const LineSpec line = read_line_spec(write("line.yaml", R"(seed: 7
up:
  trace: drive.up
  delay_ms: 20
  jitter_ms: 2.5
  reorder: true
  loss: 0.02
  burst: 4
  duplicates: 0.001
  queue_kb: 64
  outages:
    - {at_s: 3, for_s: 1, every_s: 20, loses: true}
down: {rate_kbps: 800}
)"));
  EXPECT_EQ(line.seed, 7U);
  EXPECT_TRUE(std::holds_alternative<DeliveryTrace>(*line.up.trace));
  EXPECT_EQ(line.up.delay, seconds(0.02));
  EXPECT_EQ(line.up.jitter, seconds(0.0025));
  EXPECT_TRUE(line.up.reorder);
  EXPECT_DOUBLE_EQ(line.up.loss, 0.02);
  EXPECT_DOUBLE_EQ(line.up.burst, 4);
  EXPECT_DOUBLE_EQ(line.up.duplicates, 0.001);
  EXPECT_EQ(line.up.queue_bytes, 64'000U);
  ASSERT_EQ(line.up.outages.size(), 1U);
  EXPECT_EQ(line.up.outages[0].every, seconds(20));
  EXPECT_TRUE(line.up.outages[0].loses);
  EXPECT_DOUBLE_EQ(line.down.bytes_per_s, 100'000);
}

TEST_F(LineSpecFile, TakesABareTrace) {
  EXPECT_TRUE(read_line_spec(write("a.up", "2\n5\n")).up.trace);
  const LineSpec both = read_line_spec(write("b.csv", "time_s,up_kbps,down_kbps\n0,1,2\n1,1,2\n"));
  EXPECT_DOUBLE_EQ(std::get<RateTrace>(*both.down.trace).bytes_per_s[0], 250);
}

TEST_F(LineSpecFile, RefusesNamingLineAndField) {
  expect_refused("up: {los: 0.1}\n", "loss");
  expect_refused("up: {loss: 2}\n", "up.loss");
  expect_refused("up: {delay_ms: -1}\n", "up.delay_ms");
  expect_refused("up: {delay_ms: nan}\n", "up.delay_ms");
  expect_refused("up: {delay_ms: 1e300}\n", "up.delay_ms: it is 1e+300; give a number from 0 to 3600000");
  expect_refused("up: {delay_ms: 3600001}\n", "it is 3600001;");
  expect_refused("up: {burst: 1e-9}\n", "it is 1e-09; give a number from 1 to 10000");
  expect_refused("up: {burst: 0}\n", "up.burst");
  expect_refused("up: {rate_kbps: 0}\n", "up.rate_kbps");
  expect_refused("up: {rate_kbps: 1e-300}\n", "up.rate_kbps: the rate is 1e-300 kbps; give 0.001 to 1e9 kbps");
  expect_refused("up: {rate_kbps: 1e10}\n", "up.rate_kbps");
  expect_refused("up: {outages: [{at_s: 1, for_s: 1e-9}]}\n", "for_s");
  expect_refused("up: {outages: [{at_s: 1, for_s: 1, every_s: 1.0001}]}\n", "less than 1 ms");
  expect_refused("up: {reorder: 3}\n", "up.reorder");
  expect_refused("up: {outages: [{at_s: 1, for_s: 2, every_s: 1}]}\n", "never end");
  expect_refused("sideways: {}\n", "sideways");
  write("t.up", "2\n");
  expect_refused("up: {trace: t.up, rate_kbps: 5}\n", "rate");
  EXPECT_THAT([&] { read_line_spec(write("c.yaml", "up: {trace: absent.up}\n")); },
              ThrowsMessage<InputError>(HasSubstr("absent.up")));
}

}  // namespace
}  // namespace foresight::line_spec_test
