// `foresight calibrate scene --tags --seen`: tags in a model, seen by a camera whose poses are known.
#include <gmock/gmock.h>

#include "calibration/result/result_file.hpp"
#include "calibration/robot/rigid_math.hpp"
#include "scene/camera_info.hpp"
#include "tests/calibrate/run_calibrate.hpp"
#include "tests/robot_calibration/synthetic_rig.hpp"

namespace foresight::scene_tag_views_test {
namespace {

using testing::AllOf;
using testing::HasSubstr;

constexpr double kNoise = 0.3;  // px
const std::string kCamera640 = R"(image_width: 640
image_height: 480
camera_name: test
camera_matrix: {rows: 3, cols: 3, data: [530, 0, 320, 0, 531, 241, 0, 0, 1]}
distortion_model: plumb_bob
distortion_coefficients: {rows: 1, cols: 5, data: [-0.2, 0.05, 0, 0, 0]}
)";

std::string numbers(const std::vector<double>& values) {
  std::string text;
  for (const double value : values) text += " " + std::to_string(value);
  return text + "\n";
}

struct SeenTags {
  const TempFolder folder;
  Pose T_world_model = Pose::Identity();
  std::filesystem::path camera = folder.write("camera.yaml", kCamera640), tags;
  std::string seen, poses;

  explicit SeenTags(unsigned seed) {
    Random random(seed);
    T_world_model = random_pose(random, 0.6, 0.05);
    T_world_model.translation().z() += 1.6;
    std::string rows;
    std::map<std::string, Eigen::Vector3d> corners;
    for (int tag = 0; tag < 3; ++tag)
      for (int corner = 0; corner < 4; ++corner) {
        const Eigen::Vector3d p(0.25 * tag - 0.3 + 0.1 * (corner == 1 || corner == 2), 0.1 * (corner < 2) - 0.15 * tag,
                                0.2 * (tag == 1));
        corners[std::to_string(tag) + " " + std::to_string(corner)] = p;
        rows += std::to_string(tag) + " " + std::to_string(corner) + numbers({p.x(), p.y(), p.z()});
      }
    tags = folder.write("tags.txt", rows);
    const Lens lens = read_camera_info(camera).lens;
    for (int i = 0; i < 5; ++i) {
      Pose T = random_pose(random, 0.1, 0.03);
      T.translation().x() += 0.25 * (i - 2);
      const Eigen::Quaterniond q(T.linear());
      const Eigen::Vector3d t = T.translation();
      const std::string name = "frame_" + std::to_string(i) + ".png";
      poses += name + numbers({t.x(), t.y(), t.z(), q.x(), q.y(), q.z(), q.w()});
      for (const auto& [corner, p] : corners) {
        const auto pixel = lens.project(T.inverse() * (T_world_model * p));
        if (!pixel || pixel->minCoeff() < 0 || pixel->x() > 639 || pixel->y() > 479) continue;
        const double u = pixel->x() + normal(random, kNoise), v = pixel->y() + normal(random, kNoise);
        seen += name + " " + corner + numbers({u, v});
      }
    }
  }

  std::string place(const std::string& seen_rows, const std::string& pose_rows) const {
    return run_calibrate({"scene", "--tags", tags, "--seen", folder.write("seen.txt", seen_rows), "--camera", camera,
                          "--camera-poses", folder.write("poses.txt", pose_rows), "--sigma-px", std::to_string(kNoise),
                          "--out", folder / "s.yaml", "--json", folder / "s.json", "--force"});
  }
};

TEST(SceneFromTagViews, ThePoseComesBackWithinItsSigma) {
  double worst_position = 0, worst_rotation = 0, squares = 0;
  constexpr int kRuns = 12;
  for (unsigned seed = 1; seed <= kRuns; ++seed) {
    const SeenTags lab(seed);
    ASSERT_EQ(lab.place(lab.seen, lab.poses), "0") << seed;
    const auto found = json_of(lab.folder, "s.json");
    EXPECT_EQ(found["points"], 12);
    const Pose T = read_result(lab.folder / "s.yaml", "scene").result.pose("T_world_model");
    const Eigen::Vector3d middle(0, -0.1, 0.07);
    const double position = 1e3 * (T * middle - lab.T_world_model * middle).norm() / double(found["sigma_position_mm"]);
    const double rotation = 57.29577951 * rotation_vector(T.linear() * lab.T_world_model.linear().transpose()).norm() /
                            double(found["sigma_rotation_deg"]);
    worst_position = std::max(worst_position, position), worst_rotation = std::max(worst_rotation, rotation);
    squares += (position * position + rotation * rotation) / (2 * kRuns);
  }
  EXPECT_LT(worst_position, 3);
  EXPECT_LT(worst_rotation, 3);
  EXPECT_GT(squares, 0.3) << "the stated sigmas are far too large";
  EXPECT_LT(squares, 2) << "the stated sigmas are too small";
  RecordProperty("mean_square_in_sigmas", std::to_string(squares));
}

TEST(SceneFromTagViews, NamesWhatIsWrong) {
  const SeenTags lab(3);
  const std::string frame_3_missing =
      lab.poses.substr(0, lab.poses.find("frame_3")) + lab.poses.substr(lab.poses.find("frame_4"));
  EXPECT_THAT(
      lab.place(lab.seen, frame_3_missing),
      AllOf(HasSubstr("--camera-poses"), HasSubstr("no row for the image 'frame_3.png'"), HasSubstr("'frame_")));
  EXPECT_THAT(lab.place("frame_1.pgn 0 0 300 200\n", lab.poses), HasSubstr("did you mean 'frame_1.png'"));
  EXPECT_THAT(lab.place("frame_1.png 0 0 300 200\n", lab.poses), HasSubstr("seen from two places"));
  EXPECT_THAT(lab.place("frame_1.png 0 0 300\n", lab.poses), HasSubstr("seen.txt"));
  EXPECT_THAT(lab.place(lab.seen, "frame_1.png 0 0 0 0 0 0 0\n"), HasSubstr("poses.txt"));
  EXPECT_THAT(run_calibrate({"scene", "--tags", lab.tags, "--seen", lab.folder / "seen.txt", "--camera", lab.camera}),
              HasSubstr("--camera-poses"));
}

}  // namespace
}  // namespace foresight::scene_tag_views_test
