#include "scene/text_table.hpp"

#include "test_run.hpp"

namespace foresight::text_table_test {
namespace {

std::vector<std::string> rows_of(const std::string& content) {
  TempFolder folder;
  std::vector<std::string> out;
  for_each_row(folder.write("t.txt", content), "a b", [&](const TextRow& row) {
    out.push_back(std::to_string(row.line) + ":" + std::string(row.fields[0]) + "," + std::string(row.fields[1]));
  });
  return out;
}

// Fields with '|' between, rows with '/'.
std::string fields_of(const std::string& content, const RowForm& form) {
  TempFolder folder;
  std::string out;
  for_each_row(folder.write("t.csv", content), form, [&](const TextRow& row) {
    if (!out.empty()) out += " / ";
    for (std::size_t i = 0; i < row.fields.size(); ++i) out += (i ? "|" : "") + std::string(row.fields[i]);
  });
  return out;
}

Pose pose_of(const std::string& line) {
  TempFolder folder;
  Pose pose;
  for_each_row(folder.write("t.txt", line), "tx ty tz qx qy qz qw",
               [&](const TextRow& row) { pose = pose_fields(row, 0); });
  return pose;
}

std::string pose_error(const std::string& line) {
  return input_error([&] { pose_of(line); });
}

TEST(TextTable, PassesOverCommentsBlanksAndLineEnds) {
  const std::vector<std::string> expected = {"2:1,x", "5:2,y"};
  EXPECT_EQ(rows_of("# a b\n1 x\n\n   \t\n 2\ty  \n"), expected);
  EXPECT_EQ(rows_of("\xEF\xBB\xBF# a b\r\n1 x\r\n\r\n#\r\n2 y"), expected);
}

TEST(TextTable, NamesTheLineOfAWrongRow) {
  EXPECT_THAT(input_error([] { rows_of("1 x\n2\n"); }),
              says("t.txt:2", "has 1 fields", "write 2, with blanks between: a b"));
  EXPECT_THAT(input_error([] { rows_of("1 x y\n"); }), says("t.txt:1", "has 3 fields", "write 2"));
  EXPECT_THAT(input_error([] { rows_of("# nothing\n"); }), says("t.txt", "holds no row", "at least one line: a b"));
  EXPECT_THAT(input_error([] { rows_of(""); }), says("t.txt", "holds no row", "at least one line"));
}

TEST(TextTable, ReadsManyLines) {
  std::string content;
  for (int i = 0; i < 200'000; ++i) content += "1 x\n";
  EXPECT_EQ(rows_of(content).size(), 200'000u);
}

TEST(TextRows, SplitAtCommasAsCsvDoes) {
  const RowForm csv{RowForm::Between::commas};
  EXPECT_EQ(fields_of("a, b ,c\r\n\n# no\n1,,3\n,\n", csv), "a|b|c / 1||3 / |");
  EXPECT_EQ(fields_of("\"x, y\", \"say \"\"ho\"\"\" ,z\n\"\",2\n", csv), "x, y|say \"ho\"|z / |2");
  EXPECT_EQ(fields_of("5\" disk,b\n", csv), "5\" disk|b") << "a quote inside of a field is one of its characters";
  EXPECT_THAT(input_error([&] { fields_of("a,b\n 1, \"b\n", csv); }),
              says("t.csv:2:5", "a quote is not closed", "double"));
  EXPECT_THAT(input_error([&] { fields_of("\"a\"b,c\n", csv); }),
              says("t.csv:1:4", "follows a closing quote", "double"));
}

TEST(TextRows, SplitAtWhatProgramsPutAroundNumbers) {
  EXPECT_EQ(fields_of("[[1, 0; 2]\n#x\n [3,4]]\n", {RowForm::Between::loose}), "1|0|2 / 3|4");
  EXPECT_EQ(fields_of("# a b\n1 2\n", {RowForm::Between::blanks, true}), "#|a|b / 1|2");
}

TEST(TextRows, NameTheColumnOfAWrongNumber) {
  const auto read = [](const std::string& content) {
    TempFolder folder;
    for_each_row(folder.write("t.csv", content), {RowForm::Between::commas},
                 [](const TextRow& row) { finite_field(row, row.fields.size() - 1, "v"); });
  };
  EXPECT_THAT(input_error([&] { read("1,2\n  3 , x\n"); }),
              says("t.csv:2:7: v is 'x', not a finite number", "", "line"));
  EXPECT_THAT(input_error([&] { read("\xEF\xBB\xBFinf\n"); }), says("t.csv:1:1: v is 'inf'", "", "correct"));
}

// A device or a pipe would be waited for, or never end.
TEST(TextRows, AreOfRegularFilesOfSensibleSize) {
  TempFolder folder;
  const auto refused = [](const std::filesystem::path& file) {
    return input_error([&] { for_each_row(file, RowForm{}, [](const TextRow&) {}); });
  };
  EXPECT_THAT(refused(folder.path()), says("", "is not a regular file", "name a file"));
  EXPECT_THAT(refused("/dev/zero"), says("/dev/zero", "is not a regular file", "name a file"));
  const auto large = folder.write("large.txt", "1\n");
  std::filesystem::resize_file(large, (std::uintmax_t{1} << 30) + 1);  // a hole
  EXPECT_THAT(refused(large), says("large.txt", "more than the 1073741824", "right one"));
}

TEST(PoseFields, NormalisesWhatIsRounded) {
  const Pose pose = pose_of("1 2 3 0 0 0.7071 0.7071");
  EXPECT_EQ(pose.translation(), Eigen::Vector3d(1, 2, 3));
  EXPECT_NEAR((pose.linear() * pose.linear().transpose() - Eigen::Matrix3d::Identity()).norm(), 0, 1e-14);
  EXPECT_TRUE((pose.linear() * Eigen::Vector3d::UnitX()).isApprox(Eigen::Vector3d::UnitY(), 1e-12));
  EXPECT_EQ(pose_error("0 0 0 0 0 0 1.0009"), "no error");
  EXPECT_EQ(pose_error("0 0 0 0 0 0 -1"), "no error");
}

TEST(PoseFields, RefusesWhatIsNoPose) {
  EXPECT_THAT(pose_error("0 0 0 0 0 0 1.0011"), says("t.txt:1", "the quaternion has length 1.0011", "qx qy qz qw"));
  EXPECT_THAT(pose_error("0 0 0 0 0 0 0"), says("t.txt:1", "the quaternion has length 0", "unit quaternion"));
  EXPECT_THAT(pose_error("0 nan 0 0 0 0 1"), says("t.txt:1:3", "ty is 'nan'", "correct or remove the line"));
  EXPECT_THAT(pose_error("0 0 0 0 inf 0 1"), says("t.txt:1", "qy is 'inf'", "correct"));
  EXPECT_THAT(pose_error("0 0 x 0 0 0 1"), says("t.txt:1", "tz is 'x', not a finite number", "correct"));
  EXPECT_THAT(pose_error("2e6 0 0 0 0 0 1"), says("t.txt:1", "more than 1e6 m", "in metres"));
}

}  // namespace
}  // namespace foresight::text_table_test
