#include "link/robot_side/rig_identity.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/read_file.hpp"
#include "tests/scene/test_run.hpp"
#include "tests/support/folders.hpp"

namespace foresight::link::rig_identity_test {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;

class RigIdentity : public testing::Test {
 protected:
  RigIdentity() { folder_.write("arm.urdf", read_file(source_folder() / "configs" / "arm.urdf")); }
  /// Of a rig file with this text.
  Identity of(const std::string& text) {
    folder_.write("rig.yaml", text);
    const std::filesystem::path file = folder_ / "rig.yaml";
    return rig_identity(read_rig(file), file, "1.0");
  }
  std::string text_ = read_file(source_folder() / "configs" / "minerva.yaml");
  TempFolder folder_;
};

// As docs/line.md says it: each host names its own interface and the other's address.
TEST_F(RigIdentity, EachHostHasALinkSectionOfItsOwn) {
  const Identity robot = of(text_ + "link:\n  interface: eth0\n  peers: [10.0.0.2]\n");
  const Identity other = of("# the operator's copy\n" + text_ + "link:\n  interface: wg0\n  peers: [10.0.0.1]\n");
  EXPECT_THAT(differences(robot, other), IsEmpty());
}

TEST_F(RigIdentity, AnotherLimitIsAnotherRig) {
  const std::string key = "velocity: ";
  const std::size_t at = text_.find(key);
  ASSERT_NE(at, std::string::npos);
  const Identity robot = of(text_);
  const Identity other = of(text_.substr(0, at + key.size()) + "0.01" + text_.substr(text_.find_first_of(",}\n", at)));
  EXPECT_THAT(refusal_text(differences(robot, other)), HasSubstr("rig"));
}

// As the two programs were started: with the same things at the same places, or not.
TEST_F(RigIdentity, AnotherSceneIsTold) {
  const Rig rig = read_rig(source_folder() / "configs" / "minerva.yaml");
  const auto identity = [&](bool physics, unsigned layout) {
    Identity out = of(text_);
    out.scene = scene_digest(live_scene_of(rig, true, std::nullopt, physics, layout));
    return out;
  };
  const Identity robot = identity(true, 3);
  EXPECT_THAT(differences(robot, identity(true, 3)), IsEmpty());
  for (const Identity& other : {identity(false, 0), identity(true, 0)}) {
    const auto found = differences(robot, other);
    ASSERT_EQ(found.size(), 1u);
    EXPECT_THAT(found[0].words, HasSubstr("another scene"));
    EXPECT_THAT(found[0].cure, testing::AllOf(HasSubstr("--physics"), HasSubstr("--layout")));
    EXPECT_FALSE(found[0].refuses);
  }
  EXPECT_THAT(differences(robot, of(text_)), IsEmpty()) << "one that looks at no scene";
}

}  // namespace
}  // namespace foresight::link::rig_identity_test
