#include "sim/drives/dcf_reader.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>
#include <random>
#include <sstream>

#include "common/error.hpp"
#include "sim/drives/generic_402.hpp"
#include "tests/support/folders.hpp"

namespace foresight::sim::dcf_reader_test {
namespace {

using testing::HasSubstr;

const std::string kGood =
    "[DeviceInfo]\r\nVendorName=Example\n; a comment\n"
    "[1000]\nParameterName=Device type\nObjectType=0x7\nDataType=0x0007\nAccessType=ro\nDefaultValue=0x20192\n"
    "[1017]\nDataType=6\nAccessType=rw\nDefaultValue=010\nLowLimit=0\nHighLimit=32767\n"
    "[1400]\nObjectType=9\nSubNumber=2\n[1400sub0]\nDataType=5\nAccessType=ro\nDefaultValue=1\n"
    "[1400Sub1]\nDataType=7\nAccessType=rw\nDefaultValue=$NODEID+0x200\nParameterValue=0x80000000 + $NodeID\n"
    "[6060]\nDataType=2\nAccessType=rww\nDefaultValue=-3\nPDOMapping=1\n"
    "[2000]\nObjectType=8\nCompactSubObj=3\nDataType=4\nAccessType=rw\nDefaultValue=7\n"
    "[2001]\nDataType=9\nAccessType=const\nDefaultValue=hello\n[2002]\nDataType=8\nAccessType=rw\nDefaultValue=1.5\n";

std::string error_of(const std::string& text) {
  try {
    parse_dcf(text, 3, "test.dcf");
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(DcfReader, ReadsTypesValuesAndLimits) {
  const ObjectDictionary objects = parse_dcf(kGood, 3, "test.dcf");
  EXPECT_EQ(objects.integer(object_key(0x1000)), 0x20192);
  EXPECT_EQ(objects.integer(object_key(0x1017)), 8) << "a leading zero is octal";
  EXPECT_EQ(objects.find(object_key(0x1017))->high, 32767);
  EXPECT_EQ(objects.integer(object_key(0x1400, 1)), 0x80000003) << "ParameterValue counts, with the node in it";
  EXPECT_EQ(objects.integer(object_key(0x6060)), -3);
  EXPECT_TRUE(objects.find(object_key(0x6060))->mappable);
  EXPECT_EQ(objects.integer(object_key(0x2000)), 3);
  EXPECT_EQ(objects.integer(object_key(0x2000, 3)), 7);
  EXPECT_EQ(objects.find(object_key(0x2001))->value.size(), 5u);
  EXPECT_EQ(objects.integer(object_key(0x2002)), 0x3fc00000);
  EXPECT_EQ(objects.find(object_key(0x1400)), objects.find(object_key(0x1400, 0)));
}

TEST(DcfReader, NamesFileAndLineOfWhatIsWrong) {
  EXPECT_THAT(error_of("[1000]\nDataType=0x0007\nDefaultValue=12x\n"), HasSubstr("test.dcf:3"));
  EXPECT_THAT(error_of("[1000]\nDataType=99\n"), HasSubstr("data type 99"));
  EXPECT_THAT(error_of("[1000]\nAccessType=ro\n"), HasSubstr("no DataType"));
  EXPECT_THAT(error_of("[1000]\nDataType=5\nDefaultValue=256\n"), HasSubstr("does not fit"));
  EXPECT_THAT(error_of("[1000]\nDataType=5\nAccessType=maybe\n"), HasSubstr("'maybe'"));
  EXPECT_THAT(error_of("[1000]\nDataType=5\n[1000]\nDataType=5\n"), HasSubstr("given twice"));
  EXPECT_THAT(error_of("DataType=5\n"), HasSubstr("test.dcf:1"));
  EXPECT_THAT(error_of("[1000\n"), HasSubstr("close it"));
  EXPECT_THAT(error_of("[FileInfo]\nA=1\n"), HasSubstr("no objects"));
  EXPECT_THROW(read_dcf("/nonexistent.dcf", 1), InputError);
}

// Whatever is in the file: a dictionary or an InputError.
TEST(DcfReader, SurvivesAnything) {
  std::mt19937 random(1);
  int read = 0;
  for (int round = 0; round < 20'000; ++round) {
    std::string text = kGood;
    for (unsigned i = 0, n = 1 + random() % 8; i < n; ++i) {
      const std::size_t at = random() % text.size();
      switch (random() % 4) {
        case 0: text[at] = static_cast<char>(random()); break;
        case 1: text.erase(at, random() % 20); break;
        case 2: text.insert(at, text.substr(random() % text.size(), random() % 40)); break;
        default: text[at] = "0x[]=+-$\n9F"[random() % 11]; break;
      }
      if (text.empty()) text = "[";
    }
    try {
      const ObjectDictionary objects = parse_dcf(text, static_cast<int>(random() % 127) + 1, "fuzz");
      for (const auto& [key, entry] : objects.entries())
        ASSERT_TRUE(size_of(entry.type) == 0 || entry.value.size() == size_of(entry.type));
      ++read;
    } catch (const InputError&) {
    }
  }
  EXPECT_GT(read, 1000);
  EXPECT_LT(read, 19'000);
}

TEST(DcfReader, ReadsTheMakersFiles) {
  const std::filesystem::path root = data_folder() / "can/schunk_canopen";
  if (!std::filesystem::exists(root)) GTEST_SKIP() << "no recorded data at " << root << "; set FORESIGHT_DATA";
  for (const char* file :
       {"schunk_lwa4d/Schunk_0_63.dcf", "schunk_lwa4p/Schunk_0_63.dcf", "schunk_pg70/Schunk_0_63.dcf"}) {
    const ObjectDictionary objects = read_dcf(root / file, 5);
    EXPECT_GT(objects.entries().size(), 150u) << file;
    EXPECT_EQ(objects.integer(object_key(0x1400, 1)), 0x205) << file;
    EXPECT_EQ(objects.find(object_key(0x6098))->access, Access::constant) << file;
    EXPECT_EQ(objects.integer(object_key(0x60C2, 2)), -3) << file;
  }
}

TEST(Generic402, HoldsWhatTheProfileAsksFor) {
  const ObjectDictionary objects = generic_402(7);
  EXPECT_EQ(objects.integer(object_key(0x1800, 1)), 0x187);
  for (unsigned index : {0x1000u, 0x1001u, 0x1018u, 0x6040u, 0x6041u, 0x6060u, 0x6061u, 0x6064u, 0x607Au, 0x6502u})
    EXPECT_TRUE(objects.has_index(index)) << std::hex << index;
  EXPECT_TRUE(objects.find(object_key(0x607A))->mappable);
  EXPECT_FALSE(writable(objects.find(object_key(0x6041))->access));
}

}  // namespace
}  // namespace foresight::sim::dcf_reader_test
