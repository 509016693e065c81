#include "calibration/result/result_file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/error.hpp"
#include "tests/scene/test_run.hpp"

namespace foresight::result_file_test {
namespace {

using testing::HasSubstr;

ResultHeader header(double score) {
  return {"stereo", "2026-03-01T14:05:09Z", {{"left", "40123"}, {"right", "40127"}}, "loo_joint_px",
          score,    {{"fx_left_px", 0.4}}};
}

YAML::Node payload(double value) {
  YAML::Node node;
  node["value"] = value;
  return node;
}

double value_in(const std::filesystem::path& file) {
  return read_result(file, "stereo").result.number("value");
}

TEST(ResultFile, NoScoreOutranksAVerdict) {
  const TempFolder folder;
  const std::filesystem::path file = folder / "a.yaml";
  ResultHeader judged = header(0.5);
  judged.judged = true;
  write_result(file, header(1e-6), payload(1), false);  // nobody judged what it is worth
  write_result(file, judged, payload(2), false);
  EXPECT_TRUE(read_result(file, "stereo").header.judged);
  EXPECT_THAT(input_error([&] { write_result(file, header(1e-6), payload(3), false); }),
              HasSubstr("nobody judged the new one"));
  judged.score = 0.6;
  EXPECT_THAT(input_error([&] { write_result(file, judged, payload(4), false); }), HasSubstr("is better than the new"));
  EXPECT_EQ(value_in(file), 2);
  folder.write("b.yaml", "kind: stereo\ndate: x\nscore: {name: a, value: 1}\nverdict: good\nresult: {}\n");
  EXPECT_THAT(input_error([&] { read_result(folder / "b.yaml", "stereo"); }), HasSubstr("verdict"));
}

TEST(ResultFile, KnowsItsViewsAgain) {
  const TempFolder folder;
  const std::vector<Eigen::Vector2d> pixels{{10.25, 20}, {110, 25.5}, {60, 90}};
  std::vector<Eigen::Vector2d> moved = pixels, stored = pixels;
  for (Eigen::Vector2d& pixel : moved) pixel.x() += 0.5;
  for (Eigen::Vector2d& pixel : stored) pixel.y() += 0.001;
  ResultHeader with = header(0.2);
  with.views = {ViewPrint(pixels)};
  write_result(folder / "a.yaml", with, payload(1), false);
  const ViewPrints known = read_result(folder / "a.yaml", "stereo").header.views;
  EXPECT_TRUE(knows(known, ViewPrint(stored)));
  EXPECT_FALSE(knows(known, ViewPrint(moved)));
  EXPECT_FALSE(knows(known, ViewPrint(std::span(pixels).first(2))));
  EXPECT_FALSE(knows({ViewPrint()}, ViewPrint()));
}

TEST(ResultFile, ReadsBackWhatWasWritten) {
  const TempFolder folder;
  const double exact = 0.1 + 1e-16;
  write_result(folder / "stereo.yaml", header(0.205), payload(exact), false);
  const ResultFile file = read_result(folder / "stereo.yaml", "stereo");
  EXPECT_EQ(file.header.kind, "stereo");
  EXPECT_EQ(file.header.date, "2026-03-01T14:05:09Z");
  EXPECT_EQ(file.header.devices, header(0).devices);
  EXPECT_EQ(file.header.score_name, "loo_joint_px");
  EXPECT_EQ(file.header.score, 0.205);
  EXPECT_EQ(file.header.sigma, header(0).sigma);
  EXPECT_EQ(file.result.number("value"), exact);
}

TEST(ResultFile, KeepsTheBetterResult) {
  const TempFolder folder;
  const auto file = folder / "stereo.yaml";
  write_result(file, header(0.2), payload(1), false);
  EXPECT_THAT(input_error([&] { write_result(file, header(0.3), payload(2), false); }),
              testing::AllOf(HasSubstr("stereo.yaml"), HasSubstr("0.2"), HasSubstr("0.3"), HasSubstr("--force")));
  EXPECT_EQ(value_in(file), 1);
  write_result(file, header(0.2030), payload(3), false);
  EXPECT_EQ(value_in(file), 3) << "the difference is within what another choice of views makes";
  write_result(file, header(0.1), payload(4), false);
  EXPECT_EQ(value_in(file), 4);
  write_result(file, header(0.9), payload(5), true);
  EXPECT_EQ(value_in(file), 5);
}

TEST(ResultFile, ComparesOnlyTheSameScore) {
  const TempFolder folder;
  const auto file = folder / "stereo.yaml";
  write_result(file, header(0.2), payload(1), false);
  ResultHeader other = header(7);
  other.score_name = "loo_joint_mm";
  write_result(file, other, payload(2), false);
  EXPECT_EQ(value_in(file), 2);
}

TEST(ResultFile, KeepsTheResultOfOtherDevices) {
  const TempFolder folder;
  const auto file = folder / "stereo.yaml";
  write_result(file, header(0.2), payload(1), false);
  ResultHeader other = header(0.1);
  other.devices["right"] = "40999";
  EXPECT_THAT(input_error([&] { write_result(file, other, payload(2), false); }),
              testing::AllOf(HasSubstr("right"), HasSubstr("40127"), HasSubstr("40999")));
  EXPECT_EQ(value_in(file), 1);
}

TEST(ResultFile, KeepsOtherKindsAndOtherFiles) {
  const TempFolder folder;
  ResultHeader intrinsics = header(0.1);
  intrinsics.kind = "intrinsics";
  write_result(folder / "a.yaml", intrinsics, payload(1), false);
  EXPECT_THAT(input_error([&] { write_result(folder / "a.yaml", header(0.1), payload(2), false); }),
              HasSubstr("intrinsics"));
  for (const char* text : {"robots: []\n", "not yaml: [", "", "just words"}) {
    const auto file = folder.write("b.yaml", text);
    EXPECT_THAT(input_error([&] { write_result(file, header(0.1), payload(2), false); }),
                HasSubstr("no calibration result"))
        << text;
    EXPECT_EQ(folder.read("b.yaml"), text);
  }
  write_result(folder / "b.yaml", header(0.1), payload(2), true);
  EXPECT_EQ(value_in(folder / "b.yaml"), 2);
}

TEST(ResultFile, SaysWhatIsWrongWithADamagedFile) {
  const TempFolder folder;
  write_result(folder / "good.yaml", header(0.2), payload(1), false);
  const std::string good = folder.read("good.yaml");
  const auto message = [&](const std::string& from, const std::string& to) {
    std::string text = good;
    text.replace(text.find(from), from.size(), to);
    return input_error([&] { read_result(folder.write("bad.yaml", text), "stereo"); });
  };
  EXPECT_THAT(message("loo_joint_px\n  value", "loo_joint_px\n  valve"), HasSubstr("value"));
  EXPECT_THAT(message("value: 0.2", "value: much"), HasSubstr("much"));
  EXPECT_THAT(message("result:", "results:"), HasSubstr("did you mean 'result'"));
  EXPECT_THAT(message("kind: stereo", "kind: arm"), HasSubstr("calibrate stereo"));
  EXPECT_THAT(message("kind: stereo\n", ""), HasSubstr("kind"));
  EXPECT_THAT(input_error([&] { read_result(folder / "absent.yaml", "stereo"); }), HasSubstr("absent.yaml"));
}

TEST(ResultFile, LeavesNothingBehindWhereItCannotWrite) {
  const TempFolder folder;
  EXPECT_THROW(write_result(folder / "no" / "such" / "folder.yaml", header(1), payload(1), false), RuntimeFailure);
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

TEST(ResultFile, DatesAreIso) {
  EXPECT_THAT(utc_now(), testing::MatchesRegex("20[0-9]+-[0-9]+-[0-9]+T[0-9]+:[0-9]+:[0-9]+Z"));
}

}  // namespace
}  // namespace foresight::result_file_test
