#include "rig_view/rig_body.hpp"

#include <gmock/gmock.h>

#include "rig_view/rig_drawing.hpp"
#include "sim/live_lab.hpp"
#include "tests/scene/test_run.hpp"

namespace foresight::rig_body_test {
namespace {

using testing::AllOf;
using testing::HasSubstr;

class RigBodyTest : public testing::Test {
 protected:
  std::vector<double> bent() {
    std::vector<double> out = body_.rest();
    set_positions(rig_, "elbow=0.9,shoulder_yaw=-0.4,finger=0.02,pan=0.3", "--joints", out);
    return out;
  }
  const Rig rig_ = read_rig(source_folder() / "configs/minerva.yaml");
  RigBody body_{rig_, {}};
};

TEST_F(RigBodyTest, GuardsStandAroundTheirLinks) {
  const PlacedRig placed = body_.at(bent());
  ASSERT_EQ(placed.guards.size(), rig_.robot->links.size());
  for (const GuardedLink& guard : placed.guards) {
    const auto node = std::ranges::find(body_.nodes().nodes(), guard.name, &Node::name);
    ASSERT_NE(node, body_.nodes().nodes().end());
    const Pose& T = placed.T_world_node[static_cast<std::size_t>(node - body_.nodes().nodes().begin())];
    for (const auto& v : node->mesh.vertices) {
      const Eigen::Vector3d p = T * v.cast<double>();
      EXPECT_LT(distance(guard.body, Capsule{p, p, 0}), 1e-6) << guard.name;
    }
  }
  EXPECT_TRUE(std::ranges::is_sorted(placed.couples, {}, &NearCouple::margin_m));
}

TEST_F(RigBodyTest, JointMarksTurnWithTheirJoints) {
  const std::vector<double> positions = bent();
  const PlacedRig placed = body_.at(positions);
  ASSERT_EQ(placed.joints.size(), 8u) << "seven of the arm and the finger; the head is not in the URDF";
  for (const PlacedJoint& joint : placed.joints) {
    EXPECT_NEAR(joint.axis.norm(), 1, 1e-9);
    EXPECT_NEAR(joint.axis.dot(joint.zero), 0, 1e-9);
    const std::string& name = rig_.joints[joint.joint].drive.name;
    EXPECT_EQ(joint.slides, name == "finger") << name;
    if (joint.slides) continue;
    // The same mark at another position of its own joint: only what it carries has moved.
    std::vector<double> other = positions;
    other[joint.joint] += 0.1;
    const PlacedRig moved = body_.at(other);
    const auto same = std::ranges::find(moved.joints, joint.joint, &PlacedJoint::joint);
    EXPECT_TRUE(same->place.isApprox(joint.place, 1e-12)) << name;
    EXPECT_TRUE(same->zero.isApprox(joint.zero, 1e-12)) << name;
  }
}

TEST_F(RigBodyTest, MockCamerasStandOnTheLabsHead) {
  const PlacedRig placed = body_.at(bent());
  ASSERT_EQ(placed.cameras.size(), 2u);
  const Pose expected = sim::LiveLab::T_world_left_modelled(
      [](std::string_view joint) { return joint == "pan" ? std::optional(0.3) : sim::shafts_at_rest(joint); });
  EXPECT_TRUE(placed.cameras[0].T_world_camera.isApprox(expected, 1e-9));
  EXPECT_TRUE(placed.cameras[1].T_world_camera.isApprox(expected * sim::T_head_left_right(), 1e-9));
}

TEST_F(RigBodyTest, APoseThatTheGateWouldStopForIsRed) {
  std::vector<double> positions = body_.rest();
  set_positions(rig_, "shoulder_pitch=1.9,elbow=0.9", "--joints", positions);
  const PlacedRig placed = body_.at(positions);
  ASSERT_LT(placed.couples.front().margin_m, 0);
  EXPECT_THAT(placed.couples.front().text, HasSubstr("link"));
  const Drawing drawing = draw_rig(body_, placed, positions, kAllLayers, -1);
  const auto red = [](const Drawing::Corner& c) { return c.colour.head<3>() == kBadColour.head<3>(); };
  EXPECT_TRUE(std::ranges::any_of(drawing.glass, red));
  const Drawing fine = draw_rig(body_, body_.at(body_.rest()), body_.rest(), kAllLayers, -1);
  EXPECT_FALSE(std::ranges::any_of(fine.glass, red));
}

TEST_F(RigBodyTest, NamesWhatThereIs) {
  const std::vector<double> rest = body_.rest();
  std::vector<std::string> words;
  for (const Drawing::Word& word : draw_rig(body_, body_.at(rest), rest, kAllLayers, 0).words)
    words.push_back(word.text);
  for (const char* name : {"world", "stand", "arm_5", "finger_left", "table", "workspace", "camera left"})
    EXPECT_THAT(words, testing::Contains(name));
  Layers none{};
  const Drawing bare = draw_rig(body_, body_.at(rest), rest, none, 0);
  EXPECT_TRUE(bare.words.empty());
  EXPECT_TRUE(bare.glass.empty());
}

TEST_F(RigBodyTest, WrongPositionsAreNamed) {
  std::vector<double> positions = body_.rest();
  const auto said = [&](const std::string& text) {
    return input_error([&] { set_positions(rig_, text, "--joints", positions); });
  };
  EXPECT_THAT(said("elbw=0.1"), says("--joints", "elbw", "elbow"));
  EXPECT_THAT(said("elbow"), says("--joints", "no position", "elbow=NUMBER, in rad"));
  EXPECT_THAT(said("elbow=fast"), AllOf(HasSubstr("elbow=fast")));
  EXPECT_THAT(said("elbow=90"), says("--joints", "beyond its limits", "-2.35 to 2.35"));
  EXPECT_THAT(said("elbow=nan"), HasSubstr("beyond"));
  EXPECT_EQ(said("finger=0.01,elbow=-1"), "no error");
}

}  // namespace
}  // namespace foresight::rig_body_test
