#include "drivers/canopen/eds_reader.hpp"

#include <gmock/gmock.h>

#include <fstream>
#include <iterator>
#include <random>

#include "common/error.hpp"
#include "recorded.hpp"

namespace foresight::canopen::eds_reader_test {
namespace {

using testing::HasSubstr;

const char* const kGood =
    "; a comment\r\n[FileInfo]\r\nFileName=a.eds\r\n"
    "[MandatoryObjects]\nSupportedObjects=2\n1=0x1000\n2=0x1018\n"
    "[OptionalObjects]\nSupportedObjects=3\n1=0x1400\n2=0x6060\n3=0x2100\n"
    "[1000]\nParameterName=Device type\nObjectType=0x7\nDataType=0x0007\nAccessType=ro\nDefaultValue=0x00020192\n"
    "[1018]\nParameterName=Identity\nObjectType=9\nSubNumber=2\n"
    "[1018sub0]\nDataType=5\nAccessType=const\nDefaultValue=1\n"
    "[1018sub1]\nParameterName=Vendor\nDataType=7\nAccessType=ro\n"
    "[1400]\nObjectType=9\nSubNumber=1\n"
    "[1400sub1]\nDataType=7\nAccessType=rw\nDefaultValue=$NODEID + 0x200\nParameterValue=0x40000000+$NodeID\n"
    "[6060]\nDataType=2\nAccessType=rww\nPDOMapping=1\nLowLimit=-128\nHighLimit=0x0A\nDefaultValue=0xFF\n"
    "[2100]\nParameterName=Row\nObjectType=8\nDataType=6\nAccessType=rw\nDefaultValue=010\nCompactSubObj=3\n"
    "[2100Name]\nNrOfEntries=1\n2=Second\n[2100Value]\nNrOfEntries=1\n3=77\n";

std::string with(const std::string& from, const std::string& to) {
  std::string text = kGood;
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return text.replace(at, from.size(), to);
}

std::string error_of(const std::string& text) {
  try {
    parse_eds(text, "a.eds", 3);
  } catch (const InputError& error) {
    return error.what();
  }
  return "no error";
}

TEST(Eds, ReadsObjects) {
  const ObjectDictionary d = parse_eds(kGood, "a.eds", 3);
  EXPECT_EQ(d.size(), 9u);
  EXPECT_TRUE(d.has(0x1018));
  EXPECT_FALSE(d.has(0x1017));
  EXPECT_EQ(d.find(0x1000, 0)->default_value->number, 0x20192);
  EXPECT_EQ(d.find(0x1018, 0)->access, Access::constant);
  EXPECT_FALSE(d.find(0x1018, 1)->default_value);
  const ObjectEntry& id = *d.find(0x1400, 1);
  EXPECT_EQ(id.default_value->number, 0x203);
  EXPECT_TRUE(id.default_value->node_relative);
  EXPECT_EQ(id.configured_value->number, 0x40000003);
  const ObjectEntry& mode = *d.find(0x6060, 0);
  EXPECT_EQ(mode.type, DataType::integer8);
  EXPECT_EQ(mode.access, Access::read_write);
  EXPECT_TRUE(mode.mappable);
  EXPECT_EQ(mode.default_value->number, -1) << "the bit pattern of a signed type";
  EXPECT_EQ(mode.low, -128);
  EXPECT_EQ(mode.high, 10);
}

TEST(Eds, ExpandsCompactSubObjects) {
  const ObjectDictionary d = parse_eds(kGood, "a.eds", 3);
  EXPECT_EQ(d.find(0x2100, 0)->default_value->number, 3);
  EXPECT_EQ(d.find(0x2100, 1)->default_value->number, 8) << "a leading 0 makes it octal";
  EXPECT_EQ(d.find(0x2100, 2)->name, "Second");
  EXPECT_EQ(d.find(0x2100, 3)->configured_value->number, 77);
  EXPECT_EQ(d.find(0x2100, 4), nullptr);
}

TEST(Eds, ErrorsSayWhereWhatAndWhatIsExpected) {
  const struct {
    std::string text, where, what, expected;
  } kCases[] = {
      {with("DefaultValue=0x00020192", "DefaultValue=0xZZ"), "a.eds:18:", "DefaultValue is '0xZZ'",
       "expected an integer"},
      {with("DefaultValue=0x00020192", "DefaultValue=0x100000000"), "a.eds:18:", "does not fit", "32 bits"},
      {with("AccessType=ro", "AccessType=maybe"), "a.eds:17:", "AccessType is 'maybe'", "expected ro, wo, rw"},
      {with("AccessType=ro\n", ""), "a.eds:13:", "[1000] has no AccessType", "expected AccessType"},
      {with("DataType=0x0007\n", ""), "a.eds:13:", "has no DataType", "expected DataType"},
      {with("SupportedObjects=2", "SupportedObjects=3"), "a.eds:5:", "no entry 3", "expected 3=0x<index>"},
      {with("SupportedObjects=2", "Supported=2"), "a.eds:4:", "no SupportedObjects", "expected SupportedObjects="},
      {with("2=0x1018", "2=0x1019"), "a.eds:7:", "object 1019 has no section", "expected a section [1019]"},
      {with("2=0x1018", "2=0x1000"), "a.eds:7:", "listed again", "once"},
      {with("2=0x1018", "2=0x11018"), "a.eds:7:", "the index is '0x11018'", "expected an integer from 1 to 65535"},
      {with("SubNumber=2", "SubNumber=3"), "a.eds:19:", "promises 3 sub-indexes but has 2", "[1018sub0]"},
      {with("[1018sub1]", "[1018subXY]"), "a.eds:27:", "'1018subXY' names no sub-index", "expected [1018sub0]"},
      {with("[6060]", "[1000]"), "a.eds:39:", "section [1000] occurs again", "the first is in line 13"},
      {with("[6060]", "[6060"), "a.eds:39:", "is not closed", "expected [name]"},
      {with("PDOMapping=1", "PDOMapping"), "a.eds:42:", "neither a section nor a field", "expected Name=value"},
      {with("PDOMapping=1", "DataType=1"), "a.eds:42:", "'DataType' occurs again", "line 40"},
      {with("LowLimit=-128", "LowLimit=11"), "a.eds:39:", "LowLimit 11 above HighLimit 10", "LowLimit <= HighLimit"},
      {with("$NODEID + 0x200", "$NODEID - 1"), "a.eds:37:", "'$NODEID - 1'", "$NODEID+<integer>"},
      {"x=1\n" + std::string(kGood), "a.eds:1:", "before the first section", "expected a section"},
      {"[FileInfo]\n", "a.eds:", "no object is listed", "[MandatoryObjects]"},
  };
  for (const auto& c : kCases) {
    const std::string error = error_of(c.text);
    EXPECT_THAT(error, HasSubstr(c.where));
    EXPECT_THAT(error, HasSubstr(c.what));
    EXPECT_THAT(error, HasSubstr(c.expected));
  }
  EXPECT_THROW(parse_eds(kGood, "a.eds", 0), InputError);
  EXPECT_THROW(parse_eds(kGood, "a.eds", 128), InputError);
  EXPECT_THROW(read_eds("no/such.eds", 1), InputError);
}

TEST(Eds, ReadsAMakersFiles) {
  const auto folder = recorded("can/schunk_canopen");
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << "no DCF files at " << folder << "; set FORESIGHT_DATA";
  int files = 0;
  for (const auto& item : std::filesystem::recursive_directory_iterator(folder)) {
    if (item.path().extension() != ".dcf") continue;
    ++files;
    const ObjectDictionary d = read_eds(item.path(), 3);
    EXPECT_EQ(d.size(), 206u) << item.path() << " (207 DataType fields, one of them of a record as a whole)";
    EXPECT_EQ(d.find(0x1400, 1)->configured_value->number, 0x203);
    EXPECT_EQ(d.find(0x6041, 0)->type, DataType::unsigned16);
    EXPECT_FALSE(d.has(0x6007));
    if (item.path().parent_path().filename() == "schunk_pg70") {
      EXPECT_EQ(d.find(0x1016, 1)->configured_value->number, 0x7f0064);
    }
  }
  EXPECT_EQ(files, 3);
}

TEST(Eds, MutatedFilesAreReadOrRefused) {
  std::string text = kGood;
  std::mt19937 random(11);
  const char* const kTokens[] = {"0x",  "-1",  "$NODEID", "[", "]", "=", "\n", "99999999999999999999",
                                 "sub", "\0x", "254"};
  int refused = 0;
  for (int i = 0; i < 5000; ++i) {
    std::string mutated = text;
    for (unsigned n = 1 + random() % 4; n > 0; --n) {
      const std::size_t at = random() % mutated.size();
      if (random() % 3 == 0)
        mutated.erase(at, random() % 20);
      else if (random() % 2)
        mutated.insert(at, kTokens[random() % std::size(kTokens)]);
      else
        mutated[at] = static_cast<char>(random());
      if (mutated.empty()) mutated = "[";
    }
    try {
      parse_eds(mutated, "a.eds", 1 + static_cast<int>(random() % 127));
    } catch (const InputError&) {
      ++refused;
    }
  }
  EXPECT_GT(refused, 500);
  EXPECT_LT(refused, 4900);
}

}  // namespace
}  // namespace foresight::canopen::eds_reader_test
