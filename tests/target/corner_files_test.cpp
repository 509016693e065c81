#include "calibration/target/corner_files.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/error.hpp"
#include "tests/scene/test_run.hpp"

namespace foresight::corner_files_test {
namespace {

using testing::HasSubstr;

class CornerFiles : public testing::Test {
 protected:
  const std::filesystem::path& folder() { return files_.path(); }
  std::filesystem::path write(const std::string& name, const std::string& text) {
    std::filesystem::create_directories((folder() / name).parent_path());
    files_.write(name, text);
    return folder() / name;
  }

  TempFolder files_;
  const Board board_ = parse_board("chessboard:3x2:0.1");
};

std::string rows(const std::string& name, double x0 = 10) {
  std::string text;
  for (int i = 0; i < 6; ++i)
    text += name + " " + std::to_string(x0 + 20 * (i % 3)) + " " + std::to_string(30 + 20 * (i / 3)) + " 1\n";
  return text;
}

TEST_F(CornerFiles, VnlKeepsOrderAndNoise) {
  const auto file = write("a.vnl", "## made by hand\n# filename x y level\n" + rows("one.png") +
                                       "two.png 1 1 0\ntwo.png 50 2 0\ntwo.png - - -\ntwo.png 1 40 2\ntwo.png 52 41 "
                                       "0\ntwo.png 99 43 0\nthree.png - - -\n");
  const CornerSet set = read_corners(file, board_);
  ASSERT_EQ(set.views.size(), 2u);
  EXPECT_EQ(set.p_board.size(), 6u);
  EXPECT_EQ(set.width, 0);
  EXPECT_EQ(set.views[0].name, "one");
  EXPECT_EQ(set.views[0].corners[4].pixel, Eigen::Vector2d(30, 50));
  EXPECT_EQ(set.views[0].corners[4].sigma_px, 2);
  ASSERT_EQ(set.views[1].corners.size(), 5u);
  EXPECT_EQ(set.views[1].corners[2].index, 3);
  EXPECT_EQ(set.views[1].corners[2].sigma_px, 4);
}

TEST_F(CornerFiles, VnlErrorsNameTheRow) {
  const auto refused = [&](const std::string& text) {
    const auto file = write("a.vnl", text);
    return input_error([&] { read_corners(file, board_); });
  };
  EXPECT_THAT(refused("one.png 1 nan\n"), AllOf(HasSubstr("a.vnl:1"), HasSubstr("y of corner 0 of one.png")));
  EXPECT_THAT(refused(rows("one.png") + "two.png 1 2\n"), AllOf(HasSubstr("a.vnl:7"), HasSubstr("1 rows")));
  EXPECT_THAT(refused(rows("one.png") + "one.png 1 2\n"), AllOf(HasSubstr("a.vnl:7"), HasSubstr("7 or more")));
  EXPECT_THAT(refused(rows("one.png") + rows("two.png") + "one.png 1 2\n"), HasSubstr("a.vnl:13"));
  EXPECT_THAT(refused("# filename u v\n"), HasSubstr("a.vnl:1"));
  EXPECT_THAT(refused("one.png 1\n"), HasSubstr("has 2 fields"));
  EXPECT_THAT(refused("# filename x y\n"), HasSubstr("no row"));
  EXPECT_THAT(refused("one.png - - -\n"), HasSubstr("in no image"));
  EXPECT_THAT(refused(rows("left1.png") + rows("right1.png")), HasSubstr("two cameras"));
  EXPECT_THAT(input_error([&] { read_corners(write("b.vnl", rows("one.png")), std::nullopt); }), HasSubstr("--board"));
  EXPECT_THAT(input_error([&] { read_corners(folder() / "none.vnl", board_); }), HasSubstr("no such file"));
}

TEST_F(CornerFiles, VnlPairsByName) {
  const auto file = write("a.vnl", rows("left1.png") + rows("left2.png") + rows("right2.png", 5) + rows("right3.png"));
  const StereoCorners pair = read_stereo_corners(file, board_);
  ASSERT_EQ(pair.left.views.size(), 2u);
  ASSERT_EQ(pair.right.views.size(), 2u);
  EXPECT_EQ(pair.left.views[1].name, "2");
  EXPECT_EQ(pair.right.views[0].name, "2");
  EXPECT_EQ(pair.right.views[0].corners[0].pixel.x(), 5);
}

TEST_F(CornerFiles, VnlPairErrors) {
  const auto refused = [&](const std::string& text) {
    const auto file = write("a.vnl", text);
    return input_error([&] { read_stereo_corners(file, board_); });
  };
  EXPECT_THAT(refused(rows("left1.png") + rows("x.png")), AllOf(HasSubstr("a.vnl:7"), HasSubstr("neither camera")));
  EXPECT_THAT(refused(rows("left1.png")), HasSubstr("in no right image"));
  EXPECT_THAT(refused(rows("left1.png") + rows("right2.png")), HasSubstr("no view of both"));
  EXPECT_THAT(refused(rows("left1.png") + rows("left_1.png")), HasSubstr("same view of the same camera"));
}

const char* const kHeader = "ts,tag_rows,tag_cols,tag_size,tag_spacing,kp_x,kp_y,p_x,p_y,p_z,tag_id,corner_idx\n";

std::string tag_row(int tag, int corner, double x, double y, double dx = 0) {
  const double p_x = 0.1 * tag + (corner == 1 || corner == 2 ? 0.08 : 0) + dx, p_y = corner >= 2 ? 0.08 : 0;
  std::ostringstream text;
  text << "17,6,6,0.08,0.3," << x << ',' << y << ',' << p_x << ',' << p_y << ",0," << tag << ',' << corner << '\n';
  return text.str();
}

std::string tag(int id, double x) {
  return tag_row(id, 0, x, 100) + tag_row(id, 1, x + 30, 100) + tag_row(id, 2, x + 30, 70) + tag_row(id, 3, x, 70);
}

TEST_F(CornerFiles, FoldersShareThePointsOfBothCameras) {
  write("cam0/17.csv", kHeader + tag(3, 10));
  write("cam0/18.csv", tag(3, 10) + tag(1, 50));
  write("cam1/18.csv", tag(5, 20) + tag(1, 60));
  const StereoCorners pair = read_stereo_corners(folder(), std::nullopt);
  ASSERT_EQ(pair.left.p_board.size(), 12u);
  EXPECT_EQ(pair.right.p_board, pair.left.p_board);
  ASSERT_EQ(pair.left.views.size(), 2u);
  EXPECT_EQ(pair.left.views[0].corners[0].index, 4);
  EXPECT_EQ(pair.left.views[1].corners.size(), 8u);
  EXPECT_EQ(pair.left.views[1].corners[0].pixel, Eigen::Vector2d(50, 100));
  ASSERT_EQ(pair.right.views.size(), 1u);
  EXPECT_EQ(pair.right.views[0].name, "18");
  EXPECT_EQ(pair.right.views[0].corners[4].index, 8);
  EXPECT_EQ(pair.right.p_board[8], Eigen::Vector3d(0.5, 0, 0));
  EXPECT_EQ(read_corners(folder() / "cam1", std::nullopt).p_board.size(), 8u);
}

TEST_F(CornerFiles, FolderErrors) {
  EXPECT_THAT(input_error([&] { read_stereo_corners(folder(), std::nullopt); }), HasSubstr("no folder cam0"));
  write("cam0/17.csv", kHeader + tag(3, 10));
  EXPECT_THAT(input_error([&] { read_stereo_corners(folder(), std::nullopt); }), HasSubstr("no folder cam1"));
  write("cam1/20.csv", kHeader + tag(3, 10));
  EXPECT_THAT(input_error([&] { read_stereo_corners(folder(), std::nullopt); }),
              AllOf(HasSubstr("no view of both"), HasSubstr("differ by 3 ns")));
  EXPECT_THAT(input_error([&] { read_corners(folder(), std::nullopt); }), HasSubstr("two cameras"));

  const auto refused = [&](const std::string& text) {
    write("cam1/20.csv", text);
    return input_error([&] { read_corners(folder() / "cam1", std::nullopt); });
  };
  EXPECT_THAT(refused(kHeader + tag(3, 10) + tag_row(3, 1, 5, 5)),
              AllOf(HasSubstr("20.csv:6"), HasSubstr("repeats corner 1 of tag 3")));
  EXPECT_THAT(refused(tag(3, 10) + "17,6,6,1,1,nan,3,0,0,0,7,2\n"),
              AllOf(HasSubstr("20.csv:5"), HasSubstr("kp_x of corner 2 of tag 7")));
  EXPECT_THAT(refused("ts,tag_row\n"), AllOf(HasSubstr("20.csv:1"), HasSubstr("tag_rows")));
  EXPECT_THAT(refused("ts,tag_rows\n"), HasSubstr("tag_cols"));
  EXPECT_THAT(refused("1,2,3\n"), HasSubstr("has 3 fields"));
  EXPECT_THAT(refused(kHeader), HasSubstr("in no image"));
  write("cam1/21.csv", tag(3, 10) + tag_row(4, 0, 1, 1));
  EXPECT_THAT(refused(tag(3, 10) + tag_row(4, 0, 1, 1, 0.01)), HasSubstr("elsewhere on the board"));
}

TEST(CornerFilesData, OpenCvStereoSet) {
  FORESIGHT_NEED_DATA("opencv_stereo_corners");
  const Board board = parse_board("chessboard:9x6:1");
  for (const char* name : {"corners_pc25.vnl", "corners_11.vnl"}) {
    const StereoCorners pair = read_stereo_corners(data_folder() / "opencv_stereo_corners" / name, board);
    ASSERT_EQ(pair.left.views.size(), 13u);
    ASSERT_EQ(pair.right.views.size(), 13u);
    for (std::size_t i = 0; i < 13; ++i) {
      EXPECT_EQ(pair.left.views[i].name, pair.right.views[i].name);
      EXPECT_EQ(pair.right.views[i].corners.size(), 54u);
    }
    EXPECT_EQ(pair.left.views[0].name, "01");
    EXPECT_NEAR(pair.left.views[0].corners[9].pixel.x(), 244.89, 0.01);
  }
}

}  // namespace
}  // namespace foresight::corner_files_test
