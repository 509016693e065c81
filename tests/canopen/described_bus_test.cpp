#include "drivers/canopen/described_bus.hpp"

#include <gmock/gmock.h>

#include <fstream>

#include "common/error.hpp"
#include "frames.hpp"
#include "recorded.hpp"

namespace foresight::canopen::described_bus_test {
namespace {

using testing::HasSubstr;

const char* const kSheet =
    "[OptionalObjects]\nSupportedObjects=4\n1=0x1800\n2=0x1A00\n3=0x2000\n4=0x2001\n"
    "[1800]\nObjectType=9\nSubNumber=1\n[1800sub1]\nDataType=7\nAccessType=rw\nDefaultValue=$NODEID+0x180\n"
    "[1A00]\nObjectType=9\nSubNumber=3\n[1A00sub0]\nDataType=5\nAccessType=rw\nDefaultValue=1\n"
    "[1A00sub1]\nDataType=7\nAccessType=rw\nDefaultValue=0x20000010\n"
    "[1A00sub2]\nDataType=7\nAccessType=rw\nDefaultValue=0\n"
    "[2000]\nParameterName=Force\nDataType=3\nAccessType=ro\nPDOMapping=1\n"
    "[2001]\nParameterName=Warmth\nDataType=5\nAccessType=ro\nPDOMapping=1\n";

class DescribedBusTest : public testing::Test {
 protected:
  DescribedBusTest() { std::ofstream(file_) << kSheet; }
  ~DescribedBusTest() override { std::filesystem::remove(file_); }
  std::filesystem::path file_ =
      std::filesystem::temp_directory_path() / ("foresight-sheet-" + std::to_string(getpid()) + ".eds");
};

TEST_F(DescribedBusTest, UnpacksThePdosOfTheSheet) {
  DescribedBus bus({file_, {}});
  EXPECT_EQ(bus.describe(frame("182#FEFF")), "TPDO1 of node 2: 2000:00 Force = 0xFFFE");
  EXPECT_EQ(bus.describe(frame("189#0100")), "TPDO1 of node 9: 2000:00 Force = 0x0001");
  EXPECT_EQ(bus.describe(frame("080#")), "SYNC");
  EXPECT_EQ(bus.describe(frame("282#01")), "TPDO2 of node 2: 01") << "the sheet has none";
}

TEST_F(DescribedBusTest, FollowsWhatTheMasterMaps) {
  DescribedBus bus({std::nullopt, {{2, file_}}});
  EXPECT_EQ(bus.describe(frame("189#0100")), "TPDO1 of node 9: 01 00") << "no sheet of node 9";
  bus.describe(frame("602#2300180182010080"));  // TPDO1 off, mapped anew, on at another place
  EXPECT_EQ(bus.describe(frame("182#0100")), "TPDO1 of node 2: 01 00");
  bus.describe(frame("602#23001A0108000120"));
  bus.describe(frame("602#23001A0210000020"));
  bus.describe(frame("602#2F001A0002000000"));
  bus.describe(frame("602#2300180182010040"));
  EXPECT_EQ(bus.describe(frame("182#07FFFF")), "TPDO1 of node 2: 2001:00 Warmth = 0x07; 2000:00 Force = 0xFFFF");
}

TEST_F(DescribedBusTest, RefusesWhatIsNoSheet) {
  const auto error = [](DataSheets sheets) -> std::string {
    try {
      DescribedBus bus(std::move(sheets));
    } catch (const InputError& e) {
      return e.what();
    }
    return "no error";
  };
  EXPECT_THAT(error({"/dev/zero", {}}), HasSubstr("/dev/zero: is not a regular file"));
  EXPECT_THAT(error({std::nullopt, {{0, file_}}}), HasSubstr("node id 0"));
}

TEST(DescribedBus, SchunkArm) {
  const auto file = recorded("can/schunk_canopen/schunk_lwa4d/Schunk_0_63.dcf");
  if (!std::filesystem::exists(file)) GTEST_SKIP() << "no data sheet at " << file << "; set FORESIGHT_DATA";
  DescribedBus bus({file, {}});
  EXPECT_THAT(bus.describe(frame("183#3704")), HasSubstr("TPDO1 of node 3: "));
  EXPECT_THAT(bus.describe(frame("603#4018100100000000")), HasSubstr("upload 1018:01 "));
}

}  // namespace
}  // namespace foresight::canopen::described_bus_test
