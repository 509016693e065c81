// Prints in the mock lab: a corner lies where the true lens puts it.
#include <gmock/gmock.h>

#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "calibration/tags/tag_detector.hpp"
#include "calibration/target/board_drawing.hpp"
#include "calibration/target/find_corners.hpp"
#include "drivers/camera/frame.hpp"
#include "sim/live_lab.hpp"
#include "sim/live_view/live_view.hpp"
#include "sim/synth_run.hpp"
#include "sim/tag_room.hpp"
#include "tests/scene/test_run.hpp"
#include "tests/support/headless_test.hpp"

namespace foresight::sim::print_test {
namespace {

using testing::HasSubstr;

constexpr PanTilt kHead{0.15, -0.2};
constexpr int kShown = 6;

/// One lit lab for all tests: prints do not change its light.
struct Lit {
  LiveLab live{{0.02, 1, {}}};
  LightMap light{live.lab(), 16};
  LabState state = live.true_state(shafts_at_rest, 0);
  LightMap::Irradiance irradiance = light.lit(state);
};
const Lit& lit() {
  static const Lit built;
  return built;
}

Lens usual_lens() {
  SynthOptions size;
  size.width = 640;
  size.height = 480;
  return synth_lens(size, false);
}

struct Error {
  int points = 0;
  Eigen::Vector2d sum{0, 0};
  double squares = 0;
  void add(const Eigen::Vector2d& e) {
    ++points;
    sum += e;
    squares += e.squaredNorm();
  }
  double bias() const { return (sum / points).norm(); }
  double rms() const { return std::sqrt(squares / points); }
};

class PrintTest : public HeadlessTest {
 protected:
  void hang(std::vector<Print> prints, double noise = 1.5) {
    view_.emplace(std::make_shared<const LabBuffers>(lit().live.lab(), lit().light, lit().irradiance, prints),
                  usual_lens(), Sensor{.noise = noise});
  }

  /// As a program gets it from the mock camera.
  cv::Mat grey(std::span<const Pose> T_world_print, std::uint64_t number) {
    const Lens& lens = view_->lens();
    EXPECT_TRUE(view_->draw(T_world_head_left(kHead), lit().state, 1, number, T_world_print));
    CameraFrame frame;
    frame.pixels.create(lens.height(), lens.width(), CV_8UC2);
    frame.format = PixelFormat::yuyv;
    frame.width = lens.width();
    frame.height = lens.height();
    frame.stride = std::size_t{2} * lens.width();
    frame.bytes = {frame.pixels.data, frame.pixels.total() * 2};
    EXPECT_TRUE(view_->take({frame.pixels.data, frame.bytes.size()}, true));
    cv::Mat bgr, out;
    EXPECT_EQ(to_bgr(frame, bgr), Conversion::ok);
    cv::cvtColor(bgr, out, cv::COLOR_BGR2GRAY);
    if (const char* folder = std::getenv("FORESIGHT_KEEP_IMAGES"))
      cv::imwrite(std::string(folder) + "/print_" + std::to_string(number) + ".png", out);
    return out;
  }

  void TearDown() override {
    view_.reset();
    HeadlessTest::TearDown();
  }

 private:
  std::optional<LiveView> view_;
};

// Pose of the board's middle: away, tilted, beside the middle of the image.
Pose shown(int k) {
  const double tilts[] = {0, 20, 35, 45, 45, 30}, turns[] = {0, 40, 130, 200, 290, 350};
  const double x[] = {0, -0.08, 0.07, 0.10, -0.09, 0.0}, y[] = {0, -0.06, 0.06, -0.05, 0.05, 0.07};
  const double z[] = {0.35, 0.45, 0.4, 0.5, 0.45, 0.8};
  const auto i = static_cast<std::size_t>(k);
  const double turn = turns[i] * M_PI / 180;
  Pose T = Pose::Identity();
  T.translate(Eigen::Vector3d(x[i], y[i], z[i]));
  T.rotate(Eigen::AngleAxisd(tilts[i] * M_PI / 180, Eigen::Vector3d(std::cos(turn), std::sin(turn), 0)));
  T.rotate(Eigen::AngleAxisd(0.1 * k, Eigen::Vector3d::UnitZ()));
  return T;
}

// Centres of what is printed symmetrically lie where they should. A tag's corners do not: sRGB moves the border
// between black and white into the black, as in a real camera.
TEST_F(PrintTest, BoardsLieWhereTheLensPutsThem) {
  for (const char* text : {"chessboard:9x6:0.025", "charuco:8x6:0.03:0.022:DICT_5X5_100", "circles:9x7:0.025",
                           "apriltag:5x4:0.04:0.012:tag36h11"}) {
    SCOPED_TRACE(text);
    const Board board = parse_board(text);
    const BoardPicture picture = board_picture(board);
    hang({{text, picture.picture, picture.width_m, picture.height_m}});
    BoardFinder finder(board);
    const auto p_board = board_points(board);
    const Eigen::Vector3d p_print_board(picture.origin_m.x() - picture.width_m / 2,
                                        picture.origin_m.y() - picture.height_m / 2, 0);
    Error error, middles;
    int seen = 0;
    for (int k = 0; k < kShown; ++k) {
      const Pose T_world_print = T_world_head_left(kHead) * shown(k);
      const auto found = finder.find(grey({&T_world_print, 1}, static_cast<std::uint64_t>(10 * (text[1] - 'a') + k)));
      if (!found) continue;
      ++seen;
      Eigen::Vector2d shift(0, 0);
      for (const foresight::Corner& c : found->corners) {
        const Eigen::Vector3d p = shown(k) * (p_print_board + p_board[static_cast<std::size_t>(c.index)]);
        const Eigen::Vector2d e = c.pixel - usual_lens().project(p).value();
        error.add(e);
        shift += e / 4;
        if (c.index % 4 == 3) middles.add(std::exchange(shift, {0, 0}));
      }
    }
    const bool tags = board.kind == BoardKind::apriltag;
    std::printf("%s: %d points, bias %.4f, rms %.4f px", text, error.points, error.bias(), error.rms());
    if (tags) std::printf("; middles of tags: rms %.4f px", middles.rms());
    std::printf("\n");
    EXPECT_GE(seen, 4);
    EXPECT_LT(error.bias(), 0.03);
    EXPECT_LT((tags ? middles : error).rms(), 0.1);
    EXPECT_LT(error.rms(), 0.4);
  }
}

TEST_F(PrintTest, TagsOnTheWallAreReadWhereTheMapHasThem) {
  const auto on_wall = [](double y, double z) {
    constexpr double s = 0.06, x = 0.62;  // the wall itself
    return std::array<Eigen::Vector3d, 4>{Eigen::Vector3d(x, y + s, z - s), Eigen::Vector3d(x, y - s, z - s),
                                          Eigen::Vector3d(x, y - s, z + s), Eigen::Vector3d(x, y + s, z + s)};
  };
  const TagCorners map{{3, on_wall(0.5, 1.1)}, {7, on_wall(0.1, 0.9)}, {501, on_wall(-0.1, 1.2)}};
  const std::vector<Print> prints = tag_prints(map);
  hang(prints);
  std::vector<Pose> poses;
  for (const Print& print : prints) poses.push_back(print.T_world_print);
  const auto tags = TagDetector({}).detect(grey(poses, 200));
  ASSERT_EQ(tags.size(), map.size());
  const Pose T_camera_world = T_world_head_left(kHead).inverse();
  for (const DetectedTag& tag : tags) {
    Eigen::Vector2d middle(0, 0);
    for (std::size_t k = 0; k < 4; ++k) {
      const Eigen::Vector2d e = tag.corners[k] - usual_lens().project(T_camera_world * map.at(tag.id)[k]).value();
      EXPECT_LT(e.norm(), 1) << tag.id << " corner " << k;
      middle += e / 4;
    }
    EXPECT_LT(middle.norm(), 0.1) << tag.id;
  }
}

TEST_F(PrintTest, WhatStandsBeforeAPrintHidesIt) {
  const BoardPicture picture = board_picture(parse_board("chessboard:9x6:0.025"));
  hang({{"board", picture.picture, picture.width_m, picture.height_m}}, 0);
  Pose T_world_print = T_world_head_left(kHead) * shown(0);
  const cv::Mat before = grey({&T_world_print, 1}, 300);
  T_world_print.pretranslate(Eigen::Vector3d(3, 0, 0));  // behind the wall
  const cv::Mat behind = grey({&T_world_print, 1}, 301);
  T_world_print = T_world_head_left(kHead) * shown(0);
  T_world_print.rotate(Eigen::AngleAxisd(M_PI, Eigen::Vector3d::UnitX()));
  const cv::Mat back = grey({&T_world_print, 1}, 302);
  EXPECT_GT(cv::norm(before, behind, cv::NORM_INF), 100);
  EXPECT_LE(cv::norm(back, behind, cv::NORM_INF), 0);
}

TEST(Print, WrongOnesAreNamed) {
  TagCorners map;
  map[587].fill(Eigen::Vector3d::Zero());
  EXPECT_THAT(input_error([&] { tag_prints(map); }), HasSubstr("tag 587"));
  Print print{"poster", cv::Mat(4, 4, CV_8UC3), 0.1, 0.1};
  EXPECT_THAT(input_error([&] { check(print); }), HasSubstr("print 'poster': has no grey picture"));
  print.picture = cv::Mat(4, 4, CV_8UC1);
  print.width_m = 0;
  EXPECT_THAT(input_error([&] { check(print); }), HasSubstr("no size"));
  TagCorners turned = TagRoom({{5, Pose::Identity(), 0.1}}).corners();
  std::swap(turned[5][0], turned[5][1]);
  EXPECT_THAT(input_error([&] { tag_prints(turned); }), HasSubstr("tag 5"));
}

}  // namespace
}  // namespace foresight::sim::print_test
