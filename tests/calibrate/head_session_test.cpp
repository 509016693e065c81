// From the pictures of a swept head to registered poses that nobody has seen, with the commands' own code.
#include <gmock/gmock.h>

#include "calibration/registration/registration.hpp"
#include "calibration/result/result_file.hpp"
#include "calibration/robot/robot_results.hpp"
#include "tests/calibrate/mock_head.hpp"

namespace foresight::head_session_test {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

/// One session for all tests: the pictures take most of the time.
class HeadSession : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    mock_ = new MockHead;
    folder_ = new TempFolder;
    mock_->record(*folder_ / "sweep", 1, 32, 0.71);
    solved_ = run_calibrate({"pan-tilt", "--run", *folder_ / "sweep", "--json", *folder_ / "head.json", "--out",
                             *folder_ / "head.yaml", "--report", *folder_ / "head.html"});
  }
  static void TearDownTestSuite() {
    delete folder_;
    delete mock_;
  }

  static MockHead* mock_;
  static TempFolder* folder_;
  static std::string solved_;
};
MockHead* HeadSession::mock_ = nullptr;
TempFolder* HeadSession::folder_ = nullptr;
std::string HeadSession::solved_;

TEST_F(HeadSession, ARealResultReachesBothBarsAtUnseenPoses) {
  ASSERT_EQ(solved_, "0");
  const auto numbers = json_of(*folder_, "head.json");
  EXPECT_NEAR(numbers["offset_s"], MockHead::kClockOffset, 0.001);
  EXPECT_LT(numbers["loo_px"], 1.0);
  const HeadModel head = read_head_model(*folder_ / "head.yaml", {});
  EXPECT_NEAR(head.offset_s, MockHead::kClockOffset, 0.001);

  const StereoLenses lenses = lab_lenses();
  const TagMap map = read_tag_map(*folder_ / "sweep/tags.txt");
  constexpr int kUnseen = 8;
  constexpr double kEvery = 0.9;  // beyond the window of the correction: each pose stands on its own tags
  MockHead::Encoders encoders = mock_->move(7, kUnseen * kEvery);
  Registration blind(head, lenses, {}, {}), seeing(head, lenses, map, options_for(head));
  std::size_t fed = 0;
  double by_encoders = 0, with_tags = 0, drawn = 0, predicted = 0;
  for (int i = 0; i < kUnseen; ++i) {
    const RobotTime time = MockHead::at(i * kEvery);
    for (; fed < encoders.rows.size() && encoders.rows[fed].first < time + seconds(0.05); ++fed) {
      blind.add_encoders(encoders.rows[fed].first, encoders.rows[fed].second);
      seeing.add_encoders(encoders.rows[fed].first, encoders.rows[fed].second);
    }
    const Pose truth = T_world_camera(mock_->truth, encoders.shafts.at(time).shafts);
    const auto without = blind.register_pair(time, {}, {});
    const auto with = seeing.register_pair(time, mock_->picture(truth, false, 9000 + 2 * static_cast<unsigned>(i)),
                                           mock_->picture(truth, true, 9001 + 2 * static_cast<unsigned>(i)));
    ASSERT_EQ(without.quality, RegistrationQuality::encoders);
    ASSERT_EQ(with.quality, RegistrationQuality::tags);
    by_encoders += std::pow(error_px(truth, without.T_world_left), 2) / kUnseen;
    with_tags += std::pow(error_px(truth, with.T_world_left), 2) / kUnseen;
    drawn += std::pow(error_px(truth, T_world_camera(lab_head(), MockHead::motors(7, i * kEvery))), 2) / kUnseen;
    predicted += std::pow(without.predicted_px, 2) / kUnseen;
  }
  RecordProperty("encoders_px", std::to_string(std::sqrt(by_encoders)));
  RecordProperty("tags_px", std::to_string(std::sqrt(with_tags)));
  std::printf("unseen: drawing %.2f px, encoders %.3f px (predicted %.3f), with tags %.3f px; loo %.3f px\n",
              std::sqrt(drawn), std::sqrt(by_encoders), std::sqrt(predicted), std::sqrt(with_tags),
              numbers["loo_px"].get<double>());
  EXPECT_LE(std::sqrt(by_encoders), 1.0);
  EXPECT_LE(std::sqrt(with_tags), 0.3);
  EXPECT_GT(std::sqrt(drawn), 5) << "or nothing was hidden";
  EXPECT_GT(std::sqrt(predicted), 0.3 * std::sqrt(by_encoders));
  EXPECT_LT(std::sqrt(predicted), 3 * std::sqrt(by_encoders));
}

TEST_F(HeadSession, VerifyPassesItAndFailsAnotherHead) {
  ASSERT_EQ(solved_, "0");
  mock_->record(*folder_ / "second", 4, 6, 0.9);
  const std::string head = *folder_ / "head.yaml", run = *folder_ / "second";
  EXPECT_EQ(run_calibrate({"verify", "--result", head, "--run", run, "--json", *folder_ / "v.json"}), "0");
  const auto numbers = json_of(*folder_, "v.json");
  EXPECT_LE(numbers["encoders_px"], 1.0) << numbers;
  EXPECT_LE(numbers["tags_px"], 0.3) << numbers;
  EXPECT_EQ(numbers["views"], 6);

  const ResultFile result = read_result(head, "pan-tilt");
  PanTiltModel bumped = read_pan_tilt(result.result);  // by a fifth of a degree
  bumped.T_world_pan.rotate(Eigen::AngleAxisd(0.0035, Eigen::Vector3d::UnitX()));
  write_result(*folder_ / "bumped.yaml", result.header, to_yaml(bumped), true);
  EXPECT_EQ(run_calibrate({"verify", "--result", *folder_ / "bumped.yaml", "--run", run}), "1");
}

TEST_F(HeadSession, VerifyNamesATagThatWasMoved) {
  ASSERT_EQ(solved_, "0");
  mock_->record(*folder_ / "third", 5, 6, 0.9);
  TagMap tags = read_tag_map(*folder_ / "third/tags.txt");
  ASSERT_TRUE(tags.contains(4));
  for (Eigen::Vector3d& corner : tags[4]) corner.x() += 0.02;
  MockHead::write_tags(*folder_ / "moved.txt", tags);
  EXPECT_EQ(run_calibrate({"verify", "--result", *folder_ / "head.yaml", "--run", *folder_ / "third", "--tags",
                           *folder_ / "moved.txt", "--json", *folder_ / "moved.json"}),
            "1");
  EXPECT_THAT(json_of(*folder_, "moved.json")["failed_because"].dump(),
              AllOf(HasSubstr("but not without tag 4"), HasSubstr("correct --tags"), Not(HasSubstr("pan-tilt"))));
}

TEST_F(HeadSession, WrongInputIsNamed) {
  const std::string run = *folder_ / "sweep", tags = *folder_ / "sweep/tags.txt";
  const auto refusal = [](std::vector<std::string> more) {
    more.insert(more.begin(), {"pan-tilt", "--most-views", "8"});
    return run_calibrate(more);
  };
  EXPECT_THAT(refusal({"--run", run, "--family", "tag25h9"}),
              AllOf(HasSubstr("0 tags of tag25h9"), HasSubstr("tag36h11 fits")));
  EXPECT_THAT(refusal({"--run", run, "--joint-names", "pan", "tillt"}),
              AllOf(HasSubstr("no joint 'tillt'"), HasSubstr("'tilt'")));
  EXPECT_THAT(refusal({"--run", *folder_ / "nowhere"}), HasSubstr("nowhere/rgb.txt"));
  const std::string other = folder_->write("other.txt", "90 0 0 0 0\n90 1 1 0 0\n90 2 1 1 0\n90 3 0 1 0\n");
  EXPECT_THAT(refusal({"--run", run, "--tags", other}), AllOf(HasSubstr("none of them in"), HasSubstr("tags 0, ")));
  const std::string crossed = folder_->write("crossed.txt", "90 0 0 0 0\n90 2 1 0 0\n90 1 1 1 0\n90 3 0 1 0\n");
  EXPECT_THAT(refusal({"--run", run, "--tags", crossed}), HasSubstr("tag 90 do not go round it"));
  const std::string part = folder_->write("part.txt", "90 0 0 0 0\n90 2 1 0 0\n");
  EXPECT_THAT(refusal({"--run", run, "--tags", part}), HasSubstr("tag 90 has 2 corners"));
  EXPECT_THAT(refusal({"--images", *folder_ / "sweep/rgb", "--tags", tags}), HasSubstr("--camera"));
}

}  // namespace
}  // namespace foresight::head_session_test
