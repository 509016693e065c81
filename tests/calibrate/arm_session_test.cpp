// A hand-eye from nothing but a rig: the mock robot shows a board to the mock cameras, and the truth is known.
#include <fmt/core.h>
#include <gmock/gmock.h>

#include <opencv2/imgcodecs.hpp>

#include "apps/calibrate/arm_stations.hpp"
#include "calibration/formats/urdf_offsets.hpp"
#include "calibration/result/result_file.hpp"
#include "calibration/robot/robot_poses.hpp"
#include "calibration/robot/robot_results.hpp"
#include "common/text.hpp"
#include "rig/open_stereo.hpp"
#include "scene/run_writer.hpp"
#include "tests/calibrate/run_calibrate.hpp"
#include "tests/support/folders.hpp"
#include "tests/support/headless_test.hpp"
#include "tests/support/html_check.hpp"

namespace foresight::arm_session_test {
namespace {

using testing::HasSubstr;

const std::string kBoard = "chessboard:6x5:0.02";
const std::vector<std::string> kStart{"-0.22", "0.93", "0.42", "1.06", "1.35", "1.33", "1.19"};

std::string text_of(const std::filesystem::path& file) {
  std::ifstream in(file);
  return {std::istreambuf_iterator<char>(in), {}};
}

/// The example rig with cameras that see enough.
std::string rig_in(const TempFolder& folder) {
  std::string rig = text_of(source_folder() / "configs/minerva.yaml");
  for (auto at = rig.find("[320, 240]"); at != std::string::npos; at = rig.find("[320, 240]"))
    rig.replace(at, 10, "[640, 480]");
  folder.write("arm.urdf", text_of(source_folder() / "configs/arm.urdf"));
  return folder.write("rig.yaml", rig);
}

/// The views of a session as a recording has them: the arm holds still for half a second at each place, where two
/// pictures are taken; a third one is taken on the way to the next place, which it does not show.
constexpr double kBegin = 10;  // s
void record_views(const std::filesystem::path& views, const std::filesystem::path& run, const Lens& lens) {
  std::filesystem::create_directories(run);
  RunWriter writer(run, lens, "left");
  std::vector<std::vector<double>> places;
  std::ofstream joints(run.string() + "-joints.csv");
  for (const FieldRow& row : read_field_rows(views / "joints.csv")) {
    if (row.fields[0] == "image") {
      joints << "time_s";
      for (std::size_t j = 1; j < row.fields.size(); ++j) joints << "," << row.fields[j];
      joints << "\n";
      continue;
    }
    std::vector<double> place;
    for (std::size_t j = 1; j < row.fields.size(); ++j) place.push_back(*parse_number(row.fields[j]));
    const auto number = places.size();
    const cv::Mat picture = cv::imread((views / (row.fields[0] + ".png")).string());
    std::uint64_t image = 3 * number;
    for (const double after : {0.1, 0.4, 0.75}) {
      const std::string name = RunWriter::image_name(false, image++);
      std::filesystem::create_directories((run / name).parent_path());
      writer.write_image(name, picture);
      writer.add_image(false, RobotTime{} + seconds(kBegin + static_cast<double>(number) + after), name);
    }
    places.push_back(place);
  }
  for (int i = -20; i < 100 * static_cast<int>(places.size()); ++i) {
    const auto from = static_cast<std::size_t>(std::max(0, i / 100)), to = std::min(from + 1, places.size() - 1);
    const double share = std::clamp((i / 100.0 - static_cast<double>(from) - 0.5) / 0.5, 0.0, 1.0);
    joints << fmt::format("{:.3f}", i / 100.0 + kBegin);
    for (std::size_t j = 0; j < places[from].size(); ++j)
      joints << fmt::format(",{:.7f}", places[from][j] + share * (places[to][j] - places[from][j]));
    joints << "\n";
  }
  writer.flush();
}

class ArmSession : public HeadlessTest {
 protected:
  void SetUp() override {
    HeadlessTest::SetUp();
    if (!IsSkipped()) context_.reset();
  }
};

TEST_F(ArmSession, GoesLooksSolvesAndVerifies) {
  const TempFolder folder;
  const std::string rig = rig_in(folder);
  std::vector<std::string> words{"arm",           "--guided",
                                 "--rig",         rig,
                                 "--stepped",     "--home",
                                 "--board",       kBoard,
                                 "--stations",    "12",
                                 "--board-sigma", "0",
                                 "--out",         folder / "arm.yaml",
                                 "--json",        folder / "arm.json",
                                 "--report",      folder / "arm.html",
                                 "--start"};
  words.insert(words.end(), kStart.begin(), kStart.end());
  folder.write("arm-views-unseen.png", "of a session before");
  ASSERT_EQ(run_calibrate(words), "0");
  EXPECT_FALSE(std::filesystem::exists(folder / "arm-views-unseen.png"));
  const auto numbers = json_of(folder, "arm.json");
  EXPECT_EQ(numbers["camera_mount"], "fixed");
  EXPECT_EQ(numbers["views"], 10);
  EXPECT_EQ(numbers["kept_back"]["views"], 2);
  EXPECT_LT(numbers["loo_px"], 1.0);
  EXPECT_LT(numbers["kept_back"]["px"], 1.5);
  EXPECT_LT(numbers["kept_back"]["mm"], 3.0);

  const Rig read = read_rig(rig);
  const Pose T_world_left = sim::T_world_head_left({0, 0});
  const Pose truth = read.T_world_robot.inverse() * T_world_left;
  const Pose found = read_hand_eye(read_result(folder / "arm.yaml", "arm").result).X;
  EXPECT_LT((truth.translation() - found.translation()).norm(), 5e-3);
  EXPECT_LT(rotation_vector(truth.linear().transpose() * found.linear()).norm(), 8e-3);

  const std::string page = folder.read("arm.html");
  EXPECT_EQ(malformed(page), "");
  for (const char* text : {"<b>Usable</b>", "Where everything stands", "stand", "data:image/jpeg;base64,"})
    EXPECT_THAT(page, HasSubstr(text));

  // A recording that holds the same pictures, and others taken in motion; its lens is known.
  record_views(folder / "arm-views", folder / "run", mock_options(as_mock(*read.cameras)).lenses.left);
  const std::vector<std::string> run{"--run", folder / "run", "--rig", rig, "--board", kBoard};
  std::vector<std::string> from_run{"arm",    "--board-sigma",  "0", "--out", folder / "run.yaml",
                                    "--json", folder / "r.json"};
  from_run.insert(from_run.end(), run.begin(), run.end());
  ASSERT_EQ(run_calibrate(from_run), "0");
  const auto of_run = json_of(folder, "r.json");
  EXPECT_EQ(of_run["views"], 12) << "each place once, and none of those in motion";
  EXPECT_THAT(of_run["notes"].dump(), HasSubstr("held still at 12 places, in 36 pictures"));
  EXPECT_EQ(of_run["camera_given"], true);
  EXPECT_LT(of_run["loo_px"], 0.5);
  EXPECT_LT(of_run["robot_noise_mm"], 0.1) << "the mock robot stands where it says";
  EXPECT_LT(of_run["robot_noise_mrad"], 0.3);
  const Pose by_run = read_hand_eye(read_result(folder / "run.yaml", "arm").result).X;
  EXPECT_LT((truth.translation() - by_run.translation()).norm(), 3e-3);
  EXPECT_LT(rotation_vector(truth.linear().transpose() * by_run.linear()).norm(), 5e-3);
  std::vector<std::string> verify_run{"verify", "--result", folder / "run.yaml", "--json", folder / "v.json"};
  verify_run.insert(verify_run.end(), run.begin(), run.end());
  EXPECT_EQ(run_calibrate(verify_run), "1") << "they are the views that it was solved from";
  EXPECT_EQ(json_of(folder, "v.json")["views_of_the_calibration"], 12);

  // The views are a set like any other, and the ones that were kept back are still new to the result.
  const auto with_views = [&](std::vector<std::string> more) {
    more.insert(more.end(), {"--images", folder / "arm-views", "--joints", folder / "arm-views/joints.csv", "--rig",
                             rig, "--board", kBoard, "--json", folder / "v.json"});
    return run_calibrate(more);
  };
  // With offsets of the joints, of which views of one small board in one place tell little.
  EXPECT_EQ(with_views({"arm", "--board-sigma", "0"}), "0");
  const auto with_offsets = json_of(folder, "v.json");
  EXPECT_LT(with_offsets["robot_noise_mm"], 0.1);
  EXPECT_LT(with_offsets["robot_noise_mrad"], 0.3);
  for (const auto& [joint, offset] : with_offsets["joint_offsets"].items()) {
    if (offset == 0) continue;
    EXPECT_LT(std::abs(offset.get<double>()), 4 * with_offsets["sigmas"][joint + "_offset"].get<double>()) << joint;
  }

  EXPECT_EQ(with_views({"verify", "--result", folder / "arm.yaml", "--robot-px", "1.5"}), "0");
  EXPECT_EQ(json_of(folder, "v.json")["views"], 2);
  EXPECT_EQ(json_of(folder, "v.json")["views_of_the_calibration"], 10);
  words[12] = "--out", words[13] = folder / "other.yaml";
  words.insert(words.end(), {"--views", folder / "arm-views"});
  EXPECT_THAT(run_calibrate(words), HasSubstr("is there already"));

  ASSERT_EQ(run_calibrate({"export", folder / "arm.yaml", "--to", "urdf", "--urdf", folder / "arm.urdf", "--out",
                           folder / "with_camera.urdf"}),
            "0");
  EXPECT_EQ(read_mount(folder.read("with_camera.urdf"), "camera", "u").parent, "stand");
}

TEST_F(ArmSession, RefusesWhatCannotWork) {
  const TempFolder folder;
  const std::string rig = rig_in(folder);
  const auto refusal = [&](std::vector<std::string> more) {
    more.insert(more.begin(), {"arm", "--guided", "--rig", rig, "--stepped", "--out", folder / "a.yaml"});
    return run_calibrate(more);
  };
  EXPECT_THAT(refusal({}), HasSubstr("--board"));
  EXPECT_THAT(refusal({"--board", kBoard, "--images", folder.path().string()}), HasSubstr("takes its own views"));
  EXPECT_THAT(run_calibrate({"arm", "--guided", "--rig", rig, "--board", kBoard}), HasSubstr("--views"));
  EXPECT_THAT(refusal({"--board", kBoard}), HasSubstr("give --home"));
}

TEST_F(ArmSession, WhereTheBoardIsNotSeenAPictureShowsWhatIs) {
  const TempFolder folder;
  EXPECT_THAT(run_calibrate({"arm", "--guided", "--rig", rig_in(folder), "--stepped", "--home", "--board", kBoard,
                             "--out", folder / "a.yaml"}),
              testing::AllOf(HasSubstr("25 stations in a row"), HasSubstr("a-views-unseen.png is the last picture")));
  EXPECT_FALSE(std::filesystem::exists(folder / "a-views"));
  EXPECT_FALSE(cv::imread(folder / "a-views-unseen.png").empty());
}

// No picture is drawn: whatever is proposed stays within the limits and clear of everything, with turns that differ.
TEST(ArmStations, ProposesClearStationsThatTurnTheFlange) {
  const Rig rig = read_rig(source_folder() / "configs/minerva.yaml");
  JointChain chain = joint_chain_of(*rig.robot, "", "", "minerva.yaml");
  JointValues start{};
  for (std::size_t i = 0; i < kStart.size(); ++i) start[i] = std::stod(kStart[i]);
  ArmStations stations(rig, chain, {}, 1);
  ASSERT_EQ(stations.joints().size(), kStart.size());
  stations.start_at(start);
  const auto shape = rig.shape();
  shape->surround(rig.surroundings);
  std::vector<double> margins(shape->couples());
  const auto limits = rig.gate_options().joints;
  std::vector<Pose> flanges;
  for (int i = 0; i < 15; ++i) {
    const auto station = stations.next();
    ASSERT_TRUE(station);
    if (i == 0) {
      EXPECT_EQ(*station, start);
    }
    shape->margins(std::span(*station).first(rig.joints.size()), margins);
    EXPECT_GT(*std::min_element(margins.begin(), margins.end()), 0) << i;
    for (std::size_t j = 0; j < limits.size(); ++j) {
      EXPECT_GE((*station)[j], limits[j].limits.min_position);
      EXPECT_LE((*station)[j], limits[j].limits.max_position);
    }
    flanges.push_back(flange_pose(chain, stations.of_chain(*station), "test"));
    stations.judge(true, i % 3 != 2);
  }
  double nearest = 9;
  for (std::size_t a = 0; a < flanges.size(); ++a)
    for (std::size_t b = a + 1; b < flanges.size(); ++b)
      nearest = std::min(nearest, rotation_vector(flanges[a].linear().transpose() * flanges[b].linear()).norm());
  EXPECT_GT(nearest, 0.1);
}

}  // namespace
}  // namespace foresight::arm_session_test
