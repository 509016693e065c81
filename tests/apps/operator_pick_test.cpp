// A thing of the physical lab is picked up and set down again at the window, by keys as a person presses them.
//
// The arm is one like the lab's whose joints' zeros are where its tool stands above the thing: once it is homed, what
// is left to be done is going down, closing and lifting, and the way back. Each key is held until the robot itself
// tells that it has come far enough. Whether the thing really went along is seen in the images that its cameras take.
#include <fmt/core.h>

#include <cmath>

#include "common/read_file.hpp"
#include "display/view_target.hpp"
#include "input/hand_of_rig.hpp"
#include "link/dds/endpoints.hpp"
#include "link/dds/topics.hpp"
#include "prediction/inverse_kinematics.hpp"
#include "seat/tool_script.hpp"
#include "sim/arm.hpp"
#include "sim/lab_task.hpp"
#include "tests/apps/operator_window.hpp"

namespace foresight::operator_pick_test {
namespace {

constexpr const char* kThing = "brick_red";
constexpr double kGrasp = 0.037;    // m: finger tips above the thing's bottom
constexpr double kOpen = 0.036;     // m, of the jaws' joint
constexpr double kPressed = 0.017;  // m: by so much less than half the thing's width do the jaws press
constexpr double kAbove = 0.11;     // m, along the view's vertical
constexpr double kTilt = 0.5;       // rad, of the head that looks on

/// An arm of `urdf` whose joints are at zero where those of the old one are at `q`.
std::string with_zeros_at(std::string urdf, const ArmChain& arm, const JointVector& q) {
  for (std::size_t i = 0; i < arm.size(); ++i) {
    const std::size_t joint = urdf.find("<joint name=\"" + arm.joints()[i].name + "\"");
    const bool about_y = urdf.find("<axis xyz=\"0 1 0\"/>", joint) < urdf.find("</joint>", joint);
    const double angle = q[static_cast<Eigen::Index>(i)];
    urdf.insert(urdf.find("<origin", joint) + 7,
                fmt::format(" rpy=\"0 {:.9f} {:.9f}\"", about_y ? angle : 0, about_y ? 0 : angle));
  }
  return urdf;
}

class OperatorPicks : public OperatorWindow {
 protected:
  // Little to draw: keys count only where the window looks for them at least every quarter of a second.
  OperatorPicks() : OperatorWindow({"--physics"}, {"--rate-hz", "8", "--font-scale", "0.5"}) {}

  std::string make_rig() override {
    const std::string file = quiet_rig(folder_, domain_.number(), 2);
    const Rig lab = read_rig(file);
    scene_.emplace(live_scene_of(lab, true, std::nullopt, true));
    T_world_thing_ = place_at_rest(*scene_, kThing);
    const double yaw = std::atan2(T_world_thing_.linear()(1, 0), T_world_thing_.linear()(0, 0));
    Pose above = sim::pointing_down(T_world_thing_.translation() + Eigen::Vector3d(0, 0, kGrasp), yaw);
    grasp_height_ = above.translation().z();
    above.pretranslate(-kAbove * T_world_camera(kTilt).linear().col(1));  // where the key for "down" leads to the thing
    const InverseKinematics kinematics(*hand_options(lab).arm);
    const IkAnswer answer = kinematics.solve(lab.T_world_robot.inverse() * above);
    EXPECT_EQ(answer.status, IkStatus::solved);
    folder_.write("arm.urdf", with_zeros_at(read_file(folder_ / "arm.urdf"), kinematics.chain(), answer.q));
    return file;
  }
  Pose T_world_camera(double tilt) const {
    return scene_->T_world_left([=](std::string_view joint) { return joint == "tilt" ? tilt : 0; });
  }

  void SetUp() override {
    OperatorWindow::SetUp();
    if (IsSkipped()) return;
    LinkConfig config;
    config.domain = domain_.number();
    listener_.emplace(config, "test");
    motions_.emplace(*listener_, link::topics::gate_motion());
    rig_read_ = read_rig(rig_);
    hand_ = hand_options(rig_read_);
  }

  /// Where the robot's joints are, as it tells; empty or not a number before it does.
  const std::vector<double>& joints() {
    motions_->take<link::GateMotion>({.joints = rig_read_.joint_names()},
                                     [this](link::GateMotion&& motion, const auto&) {
                                       joints_.clear();
                                       for (const link::GateMotionJoint& joint : motion.joints)
                                         joints_.push_back(joint.known ? joint.position : NAN);
                                     });
    return joints_;
  }
  double joint(const std::string& name) {
    const std::vector<std::string> names = rig_read_.joint_names();
    return joints().at(static_cast<std::size_t>(std::ranges::find(names, name) - names.begin()));
  }
  double jaws() { return joint("finger"); }
  Pose T_world_tool() { return rig_read_.T_world_robot * hand_.arm->tip_pose(joints_of(joints(), hand_.arm_joints)); }
  /// Of the tool above where it grasps the thing, m.
  double height() { return T_world_tool().translation().z() - grasp_height_; }

  enum class Pace { full, slow };
  /// Holds `key` beside the switch until that is so. All are pressed anew where the switch no longer counts, as after a
  /// picture that took long.
  testing::AssertionResult holds(const std::string& key, Pace pace, const std::function<bool()>& until) {
    constexpr int kTries = 12;
    constexpr unsigned kLooks = 1000;
    for (int tries = 0; tries < kTries; ++tries) {
      if (until()) return testing::AssertionSuccess();
      if (const auto driving = drives(); !driving) return driving;
      if (pace == Pace::slow) hold("ctrl", true);
      hold(key, true);
      comes_true([&] { return until() || last("next").find("driving") == std::string::npos; }, kLooks);
      hold(key, false);
      hold("ctrl", false);
    }
    return testing::AssertionFailure() << "holding " << key << " did not do it; the tool is " << height()
                                       << " m above where it grasps, the jaws are at " << jaws() << " m:\n"
                                       << seat_->said() << "\nrobot:\n"
                                       << robot_->said();
  }
  /// Lets go of the switch, and waits until the robot stands.
  testing::AssertionResult rests() {
    constexpr int kAlike = 20;  // looks
    hold("shift", false);
    double before = NAN;
    int alike = 0;
    const bool stands = comes_true([&] {
      const double now = height();
      alike = std::abs(now - before) < 1e-4 ? alike + 1 : 0;
      before = now;
      return alike >= kAlike && last("next").find("driving") == std::string::npos;
    });
    if (stands) return testing::AssertionSuccess();
    return testing::AssertionFailure() << "drives on:\n" << seat_->said();
  }
  /// The tool down to that height, at rest. Not so far that the gate, for the table, would let the jaws move no more:
  /// keys are heard of late, so a person goes up a little again, too.
  testing::AssertionResult goes_down(double to) {
    constexpr double kNear = 0.04, kTooFar = 0.003;  // m
    constexpr int kTries = 10;
    if (const auto near = holds("f", Pace::full, [&] { return height() < kNear; }); !near) return near;
    for (int tries = 0; tries < kTries; ++tries) {
      if (const auto there = holds("f", Pace::slow, [&] { return height() < to; }); !there) return there;
      if (const auto at_rest = rests(); !at_rest) return at_rest;
      if (height() > kTooFar) return testing::AssertionSuccess();
      if (const auto back = holds("r", Pace::slow, [&] { return height() > kTooFar; }); !back) return back;
      if (const auto at_rest = rests(); !at_rest) return at_rest;
    }
    return testing::AssertionFailure() << "it never stood near enough to the thing and clear of the table:\n"
                                       << seat_->said();
  }
  testing::AssertionResult goes_up() {
    if (const auto up = holds("r", Pace::full, [&] { return height() > 0.8 * kAbove; }); !up) return up;
    return rests();
  }

  /// How much of a picture is of the thing's red where it would be seen if it stood there.
  double red_at(const cv::Mat& picture, const Pose& T_world_thing, int border) {
    const Lens& lens = scene_->lenses()->left;
    const ViewTarget whole{0, border, border, picture.cols - 2 * border, picture.rows - 2 * border};
    const ViewTarget place = fitted(whole, lens.width(), lens.height());
    const Pose T_camera_thing = T_world_camera(joint("tilt")).inverse() * T_world_thing;
    std::vector<cv::Point2f> corners;
    constexpr double kInside = 0.35;  // of the sides: off the outlines, which coding and few pixels blur
    for (int corner = 0; corner < 8; ++corner) {
      const double x = (corner & 1 ? kInside : -kInside) * sim::kBrickSide,
                   y = (corner & 2 ? kInside : -kInside) * sim::kBrickSide,
                   z = (0.5 + (corner & 4 ? kInside : -kInside)) * sim::kBrickHeight;
      const auto pixel = lens.project(T_camera_thing * Eigen::Vector3d(x, y, z));
      if (!pixel) return 0;
      const double scale = static_cast<double>(place.width) / lens.width();
      corners.emplace_back(static_cast<float>(place.x + (pixel->x() + 0.5) * scale),
                           static_cast<float>(place.y + (pixel->y() + 0.5) * scale));
    }
    std::vector<cv::Point2f> outline;
    cv::convexHull(corners, outline);
    const std::vector<cv::Point> polygon(outline.begin(), outline.end());
    cv::Mat inside(picture.size(), CV_8UC1, cv::Scalar(0)), hsv, red;
    cv::fillConvexPoly(inside, polygon, cv::Scalar(255));
    cv::cvtColor(picture, hsv, cv::COLOR_BGR2HSV);
    cv::inRange(hsv, cv::Scalar(0, 110, 60), cv::Scalar(10, 255, 255), red);  // hue in units of two degrees
    return cv::countNonZero(red & inside) / std::max(1.0, static_cast<double>(cv::countNonZero(inside)));
  }
  /// The window shows the thing there and not where it is not, as it will be and in the newest image.
  testing::AssertionResult shows_thing(const std::string& what, const Pose& there, const Pose& not_there) {
    constexpr unsigned kLooks = 60;
    constexpr double kMuch = 0.5, kLittle = 0.1;
    double here = 0, elsewhere = 1;
    const auto so = [&](const std::string& name, int border) {
      const cv::Mat picture = look();
      if (const char* const folder = std::getenv("FORESIGHT_KEEP_PICTURES"))
        cv::imwrite(std::string(folder) + "/" + what + "_" + name + ".png", picture);
      here = red_at(picture, there, border);
      elsewhere = red_at(picture, not_there, border);
      return here > kMuch && elsewhere < kLittle;
    };
    if (!comes_true([&] { return so("predicted", 0); }, kLooks))
      return testing::AssertionFailure() << what << ", as it will be: " << here << " of it are red, and " << elsewhere
                                         << " of where it is not:\n"
                                         << seat_->said();
    press("Tab");
    if (const auto newest = shows("the newest image", false); !newest) return newest;
    const bool true_too = comes_true([&] { return so("newest", 4); }, kLooks);
    for (int i = 0; i < 3; ++i) press("Tab");  // both, split, and as it will be again
    if (!true_too)
      return testing::AssertionFailure() << what << ", in the newest image: " << here << " of it are red, and "
                                         << elsewhere << " of where it is not:\n"
                                         << seat_->said();
    return shows("as it will be", false);
  }

  std::optional<LiveScene> scene_;
  Pose T_world_thing_ = Pose::Identity();
  double grasp_height_ = 0;
  Rig rig_read_;
  HandOptions hand_;
  std::optional<link::Participant> listener_;
  std::optional<link::Reader> motions_;
  std::vector<double> joints_;
};

TEST_F(OperatorPicks, AThingUpAndSetsItDown) {
  ASSERT_TRUE(says("in command:   you"));
  ASSERT_TRUE(screen_->input("search --sync --name Foresight windowfocus"));
  ASSERT_TRUE(screen_->input("search --name Foresight windowsize 640 400"));
  ASSERT_TRUE(gets_ready());
  ASSERT_TRUE(comes_true([&] { return !joints().empty() && !std::isnan(jaws()) && !std::isnan(joint("tilt")); }));

  ASSERT_TRUE(holds("Down", Pace::slow, [&] { return joint("tilt") > kTilt; }));
  ASSERT_TRUE(holds("v", Pace::full, [&] { return jaws() > kOpen; }));
  ASSERT_TRUE(goes_down(0.016));
  const double grasped_at = height();
  EXPECT_EQ(last("carries"), "");
  const Pose T_tool_thing = T_world_tool().inverse() * T_world_thing_;

  ASSERT_TRUE(holds("c", Pace::full, [&] { return jaws() < kPressed; }));
  EXPECT_TRUE(comes_true([&] { return last("carries") == std::string("operator: carries:   ") + kThing; }))
      << seat_->said();
  ASSERT_TRUE(goes_up());
  EXPECT_LT(jaws(), kPressed) << "the switch is open, and the jaws press on";
  EXPECT_TRUE(shows_thing("lifted", T_world_tool() * T_tool_thing, T_world_thing_));

  constexpr double kAtMat = 0.005;  // m: nearer, the arm that is shown leans on the mat
  ASSERT_TRUE(goes_down(grasped_at + kAtMat));
  EXPECT_LT(jaws(), kPressed);
  const Pose set_down = T_world_tool() * T_tool_thing;
  ASSERT_TRUE(holds("v", Pace::full, [&] { return jaws() > kOpen; }));
  EXPECT_TRUE(comes_true([&] { return last("carries") == std::string("operator: carries: no longer: ") + kThing; }))
      << seat_->said();
  ASSERT_TRUE(goes_up());
  EXPECT_TRUE(shows_thing("set_down", set_down, T_world_tool() * T_tool_thing));

  ASSERT_TRUE(comes_true([&] { return !press("q") || !seat_->running(); }));
  const Outcome end = seat_->wait();
  EXPECT_EQ(end.exit_code, 0) << end.err;
}

}  // namespace
}  // namespace foresight::operator_pick_test
