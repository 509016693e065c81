#include "drivers/canopen/sdo.hpp"

#include <gmock/gmock.h>

#include "drivers/canopen/wire.hpp"
#include "frames.hpp"

namespace foresight::canopen::sdo_test {
namespace {

using namespace std::chrono_literals;
using testing::ElementsAre;

struct Sdo : testing::Test {
  KeepingBus bus;
  SdoClient client{3, 50ms, 32};
  void answer(std::string_view text) { client.receive(frame(text), bus, RobotTime{1}); }
  std::string read() const { return {client.data().begin(), client.data().end()}; }
  const std::string& last() const { return bus.sent.back(); }
};

TEST_F(Sdo, ExpeditedUploadTakesOnlyTheValidBytes) {
  client.upload(0x6041, 0, bus, {});
  EXPECT_EQ(last(), "603#4041600000000000");
  answer("583#4B41600018028FAF");  // recorded from a drive: two valid bytes, then garbage
  EXPECT_EQ(client.status(), SdoStatus::done);
  EXPECT_THAT(client.data(), ElementsAre(0x18, 0x02));
  client.upload(0x6061, 0, bus, {});
  answer("583#4F61600001BC008F");
  EXPECT_THAT(client.data(), ElementsAre(1));
  client.upload(0x6064, 0, bus, {});
  answer("583#43646000FF110000");
  EXPECT_EQ(load(client.data(), 4), 4607u);
  client.upload(0x6064, 0, bus, {});
  answer("583#4264600001020304");  // size not stated
  EXPECT_EQ(client.data().size(), 4u);
}

TEST_F(Sdo, ExpeditedDownload) {
  const std::uint8_t data[] = {0xe8, 0x03};
  EXPECT_TRUE(client.download(0x1017, 0, data, bus, {}));
  EXPECT_EQ(last(), "603#2B171000E8030000");
  answer("583#6017100000000000");
  EXPECT_EQ(client.status(), SdoStatus::done);
}

TEST_F(Sdo, SegmentedUpload) {
  client.upload(0x1008, 0, bus, {});
  answer("583#410810000A000000");
  EXPECT_EQ(last(), "603#6000000000000000");
  answer("583#0041424344454647");
  EXPECT_EQ(last(), "603#7000000000000000");
  EXPECT_TRUE(client.busy());
  answer("583#19484950FFFFFFFF");  // toggle 1, 4 bytes unused, last
  EXPECT_EQ(client.status(), SdoStatus::done);
  EXPECT_EQ(read(), "ABCDEFGHIP");
}

TEST_F(Sdo, SegmentedDownload) {
  const std::uint8_t data[] = {1, 2, 3, 4, 5, 6, 7, 8, 9};
  client.download(0x2000, 1, data, bus, {});
  EXPECT_EQ(last(), "603#2100200109000000");
  answer("583#6000200100000000");
  EXPECT_EQ(last(), "603#0001020304050607");
  answer("583#2000000000000000");
  EXPECT_EQ(last(), "603#1B08090000000000");
  EXPECT_TRUE(client.busy());
  answer("583#3000000000000000");
  EXPECT_EQ(client.status(), SdoStatus::done);
}

TEST_F(Sdo, DownloadOfSevenBytesAndOfNoneIsOneSegment) {
  const std::uint8_t data[] = {1, 2, 3, 4, 5, 6, 7};
  client.download(0x2000, 1, data, bus, {});
  answer("583#6000200100000000");
  EXPECT_EQ(last(), "603#0101020304050607");
  answer("583#2000000000000000");
  EXPECT_EQ(client.status(), SdoStatus::done);
  client.download(0x2000, 1, {}, bus, {});
  answer("583#6000200100000000");
  EXPECT_EQ(last(), "603#0F00000000000000");
  EXPECT_TRUE(client.busy());
  answer("583#2000000000000000");
  EXPECT_EQ(client.status(), SdoStatus::done);
}

TEST_F(Sdo, WrongToggleAborts) {
  client.upload(0x1008, 0, bus, {});
  answer("583#410810000A000000");
  answer("583#1041424344454647");
  EXPECT_EQ(client.status(), SdoStatus::failed);
  EXPECT_EQ(client.abort_code(), kAbortToggle);
  EXPECT_EQ(last(), "603#8008100000000305");
  const std::uint8_t data[] = {1, 2, 3, 4, 5, 6, 7, 8, 9};
  client.download(0x2000, 1, data, bus, {});
  answer("583#6000200100000000");
  answer("583#3000000000000000");
  EXPECT_EQ(client.status(), SdoStatus::failed);
  EXPECT_EQ(client.abort_code(), kAbortToggle);
}

TEST_F(Sdo, AbortOfTheNodeIsNamed) {
  client.upload(0x1016, 0, bus, {});
  answer("583#8016100000000206");
  EXPECT_EQ(client.status(), SdoStatus::aborted);
  EXPECT_STREQ(abort_name(client.abort_code()), "the object does not exist");
  EXPECT_EQ(bus.sent.size(), 1u) << "an abort is not answered";
}

TEST_F(Sdo, TimesOutAndTellsTheNode) {
  client.upload(0x1000, 0, bus, {});
  client.check(bus, RobotTime{49'999'999});
  EXPECT_TRUE(client.busy());
  client.check(bus, RobotTime{50'000'000});
  EXPECT_EQ(client.status(), SdoStatus::timed_out);
  EXPECT_EQ(last(), "603#8000100000000405");
  answer("583#4300100092010200");
  EXPECT_EQ(client.status(), SdoStatus::timed_out) << "too late";
}

TEST_F(Sdo, IgnoresWhatIsNoAnswerToIt) {
  client.upload(0x1018, 1, bus, {});
  for (const char* foreign : {"584#431810019C020000", "583#4300100092010200", "583#43181002FFFFFFFF", "583#4318100100",
                              "603#431810019C020000", "583#8000100000000405"}) {
    answer(foreign);
    EXPECT_TRUE(client.busy()) << foreign;
  }
  CanFrame extended = frame("583#431810019C020000");
  extended.extended = true;
  client.receive(extended, bus, {});
  EXPECT_TRUE(client.busy());
  answer("583#431810019C020000");
  EXPECT_EQ(load(client.data(), 4), 0x29cu);
}

TEST_F(Sdo, RefusesWrongSpecifierSizeAndLength) {
  client.upload(0x1008, 0, bus, {});
  answer("583#6008100000000000");
  EXPECT_EQ(client.abort_code(), kAbortCommand);
  client.upload(0x1008, 0, bus, {});
  answer("583#4108100021000000");  // 33 bytes into a client of 32
  EXPECT_EQ(client.abort_code(), kAbortMemory);
  client.upload(0x1008, 0, bus, {});
  answer("583#4108100009000000");
  answer("583#0141424344454647");  // 7 bytes and last, 9 announced
  EXPECT_EQ(client.status(), SdoStatus::failed);
  EXPECT_EQ(client.abort_code(), kAbortLength);
  const std::vector<std::uint8_t> data(33);
  EXPECT_FALSE(client.download(0x2000, 0, data, bus, {}));
  EXPECT_EQ(client.status(), SdoStatus::failed);
}

TEST_F(Sdo, EndlessUploadEnds) {
  client.upload(0x1008, 0, bus, {});
  answer("583#4008100000000000");
  for (int i = 0; i < 5 && client.busy(); ++i) answer(i % 2 ? "583#1041424344454647" : "583#0041424344454647");
  EXPECT_EQ(client.status(), SdoStatus::failed);
  EXPECT_EQ(client.abort_code(), kAbortMemory);
}

}  // namespace
}  // namespace foresight::canopen::sdo_test
