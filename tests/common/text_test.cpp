#include "common/text.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace foresight::text_test {
namespace {

TEST(ParseSeconds, IsExactForUnixTimes) {
  // A double has steps of 238 ns here.
  EXPECT_EQ(parse_seconds("1700000000.123456789"), Duration{1'700'000'000'123'456'789});
  EXPECT_EQ(parse_seconds("1700000000.000000001"), Duration{1'700'000'000'000'000'001});
  EXPECT_EQ(parse_seconds("1305031102.175304"), Duration{1'305'031'102'175'304'000});
  EXPECT_EQ(parse_seconds("1.305031102175304000e+09"), Duration{1'305'031'102'175'304'000});
}

TEST(ParseSeconds, TakesAllDecimalForms) {
  EXPECT_EQ(parse_seconds("0"), Duration{0});
  EXPECT_EQ(parse_seconds("0.0"), Duration{0});
  EXPECT_EQ(parse_seconds("5"), Duration{5'000'000'000});
  EXPECT_EQ(parse_seconds("5."), Duration{5'000'000'000});
  EXPECT_EQ(parse_seconds(".5"), Duration{500'000'000});
  EXPECT_EQ(parse_seconds("+0.5"), Duration{500'000'000});
  EXPECT_EQ(parse_seconds("-0.5"), Duration{-500'000'000});
  EXPECT_EQ(parse_seconds("0012.5"), Duration{12'500'000'000});
  EXPECT_EQ(parse_seconds("0.0012e3"), Duration{1'200'000'000});
  EXPECT_EQ(parse_seconds("12E-3"), Duration{12'000'000});
  EXPECT_EQ(parse_seconds("1e-12"), Duration{0});
}

TEST(ParseSeconds, RoundsAtTheTenthDecimal) {
  EXPECT_EQ(parse_seconds("0.0000000004999"), Duration{0});
  EXPECT_EQ(parse_seconds("0.0000000005"), Duration{1});
  EXPECT_EQ(parse_seconds("-0.0000000005"), Duration{-1});
  EXPECT_EQ(parse_seconds("0.9999999999"), Duration{1'000'000'000});
}

TEST(ParseSeconds, RefusesWhatIsNoTime) {
  for (const char* text : {"", ".", "-", "+", "1.2.3", "1,5", "nan", "inf", "0x10", "1e", "1e5.0", "12s", " 1", "1 ",
                           "4000000001", "1700000000123", "1e300", "1e999999999999", "99999999999999999999999999"})
    EXPECT_FALSE(parse_seconds(text)) << text;
  EXPECT_EQ(parse_seconds("4000000000"), Duration{4'000'000'000'000'000'000});
}

TEST(ParseNumber, TakesTheWholeTextOnly) {
  EXPECT_EQ(parse_number("-1.5e2"), -150.0);
  EXPECT_EQ(parse_number("+3"), 3.0);
  EXPECT_TRUE(std::isnan(*parse_number("nan")));
  for (const char* text : {"", "+", "+-1", "1x", "1 ", " 1", "1,5", "1e999"}) EXPECT_FALSE(parse_number(text)) << text;
  EXPECT_EQ(parse_integer("-42"), -42);
  for (const char* text : {"", "1.0", "1e3", "99999999999999999999"}) EXPECT_FALSE(parse_integer(text)) << text;
}

TEST(NearestWord, FindsTheSmallestEdit) {
  const std::vector<std::string> words = {"image_width", "image_height", "roi"};
  EXPECT_EQ(nearest_word("image_widht", words), "image_width");
  EXPECT_EQ(nearest_word("height", words), "image_height");
  EXPECT_EQ(nearest_word("ROI", words), "roi");
  EXPECT_EQ(nearest_word("", words), "roi");
  EXPECT_EQ(nearest_word("x", {}), "");
}

TEST(DidYouMean, NamesTheNearestOrSaysWhatElseToDo) {
  const std::vector<std::string> known{"elbow", "wrist"};
  EXPECT_EQ(did_you_mean("elbov", known), "did you mean 'elbow'?");
  EXPECT_EQ(did_you_mean("xzy", std::vector<std::string>{"xyz", "quaternion"}), "did you mean 'xyz'?");
  EXPECT_EQ(did_you_mean("ELBOW", known), "did you mean 'elbow'?");
  EXPECT_EQ(did_you_mean("elbov", {}, "leave it out"), "leave it out");
  EXPECT_EQ(did_you_mean("gripper", known), "known are elbow, wrist");
  EXPECT_EQ(did_you_mean("gripper", std::vector<std::string>(14, "x")),
            "known are x, x, x, x, x, x, x, x, x, x, x, x and 2 more");
}

TEST(Words, AreJoinedLoweredAndTrimmed) {
  EXPECT_EQ(joined(std::vector<std::string>{"left", "right"}), "left, right");
  EXPECT_EQ(joined({}), "");
  EXPECT_EQ(lower("DataType_Ä1"), "datatype_Ä1") << "ASCII alone";
  EXPECT_EQ(trimmed(" \ta b\r"), "a b");
  EXPECT_EQ(trimmed(" \t "), "");
  EXPECT_EQ(trimmed(" -a-", "-"), " -a");
}

TEST(Readable, LosesNoNumber) {
  EXPECT_EQ(readable(18.44, 1, " dB"), "18.4 dB");
  EXPECT_EQ(readable(1e300, 6), "1e+300");
  EXPECT_EQ(readable(-1e300, 6, " ms"), "-1e+300 ms");
  EXPECT_EQ(readable(std::nullopt, 1), "-");
}

TEST(InQuotes, ShortensAndCleans) {
  EXPECT_EQ(in_quotes("a b"), "'a b'");
  EXPECT_EQ(in_quotes("a\n\x1b[31m"), "'a??[31m'");
  EXPECT_EQ(in_quotes(std::string(61, 'x')), "'" + std::string(60, 'x') + "...'");
}

}  // namespace
}  // namespace foresight::text_test
