#include "scene/mesh_finder.hpp"

#include "scene/urdf_reader.hpp"
#include "test_run.hpp"
#include "tests/support/folders.hpp"

namespace foresight::mesh_finder_test {
namespace {

namespace fs = std::filesystem;

class MeshFinder : public testing::Test {
 protected:
  MeshFinder() {
    urdf_ = folder_.write("lab/arm_description/urdf/arm.urdf", "<robot name='arm'/>");
    mesh_ = folder_.write("lab/arm_description/meshes/link.stl", "");
  }
  std::string found(const std::string& name, const MeshSearch& search = {}) const {
    return fs::relative(find_mesh(name, urdf_, search, "here"), folder_.path()).string();
  }
  std::string error(const std::string& name, const MeshSearch& search = {}) const {
    return input_error([&] { find_mesh(name, urdf_, search, "here"); });
  }
  TempFolder folder_;
  fs::path urdf_, mesh_;
};

TEST_F(MeshFinder, LooksBesideAndAboveTheUrdf) {
  const std::string there = "lab/arm_description/meshes/link.stl";
  EXPECT_EQ(found("package://arm_description/meshes/link.stl"), there) << "in a folder of that name";
  EXPECT_EQ(found("model://arm_description/meshes/link.stl"), there);
  EXPECT_EQ(found("meshes/link.stl"), there) << "urdf/ beside meshes/";
  EXPECT_EQ(found("../meshes/link.stl"), there);
  EXPECT_EQ(found("file://" + mesh_.string()), there);
  EXPECT_EQ(found(mesh_.string()), there);
  EXPECT_EQ(found("package://renamed/meshes/link.stl"), there) << "a package whose folder was renamed";
  folder_.write("lab/other_package/link.stl", "");
  EXPECT_EQ(found("package://other_package/link.stl"), "lab/other_package/link.stl") << "another package beside it";
}

TEST_F(MeshFinder, KnowsAPackageByItsPackageXml) {
  folder_.write("lab/arm_description/urdf/deep/arm.urdf", "");
  folder_.write("lab/package.xml", "<package>\n  <name> lab_arms </name>\n</package>");
  folder_.write("lab/shared/hand.stl", "");
  EXPECT_EQ(found("package://lab_arms/shared/hand.stl"), "lab/shared/hand.stl");
  EXPECT_THAT(error("package://lab_legs/shared/hand.stl"), testing::HasSubstr("is missing"));
}

TEST_F(MeshFinder, TheRigsMeshRootGoesBeforeAllElse) {
  const MeshSearch search{{}, folder_ / "elsewhere"};
  folder_.write("elsewhere/meshes/link.stl", "");
  EXPECT_EQ(found("meshes/link.stl", search), "elsewhere/meshes/link.stl");
  EXPECT_EQ(found("package://arm_description/meshes/link.stl", search), "elsewhere/meshes/link.stl");
  folder_.write("elsewhere/arm_description/meshes/link.stl", "");
  EXPECT_EQ(found("package://arm_description/meshes/link.stl", search), "elsewhere/arm_description/meshes/link.stl");
  EXPECT_EQ(found("/home/somebody/ws/meshes/link.stl", search), "elsewhere/meshes/link.stl")
      << "an absolute path of another machine: its longest end that exists";
}

TEST_F(MeshFinder, AUrdfThatIsALinkIsLookedForWhereItTrulyLies) {
  fs::create_directories(folder_ / "mine");
  fs::create_symlink(urdf_, folder_ / "mine/arm.urdf");
  EXPECT_EQ(fs::relative(find_mesh("meshes/link.stl", folder_ / "mine/arm.urdf", {}, "here"), folder_.path()),
            "lab/arm_description/meshes/link.stl");
}

TEST_F(MeshFinder, SaysEverywhereItLooked) {
  const std::string message = error("package://arm/meshes/none.stl", {{}, folder_ / "elsewhere"});
  for (const char* place :
       {"elsewhere/arm/meshes/none.stl", "elsewhere/meshes/none.stl", "lab/arm_description/urdf/arm/meshes/none.stl",
        "lab/arm_description/arm/meshes/none.stl", "lab/arm/meshes/none.stl", "lab/arm_description/meshes/none.stl"})
    EXPECT_THAT(message, testing::HasSubstr((folder_ / place).string()));
  EXPECT_THAT(message, says("here", "is missing; looked for", "robot.mesh_root"));
  EXPECT_THAT(error("http://host/link.stl"), says("here", "named by 'http://'", "package://NAME/path"));
  EXPECT_THAT(error("package://arm"), says("here", "names no file of a package", "package://NAME/path"));
}

TEST_F(MeshFinder, AConfinedSearchStaysInside) {
  folder_.write("outside.stl", "");
  const MeshSearch search{fs::canonical(folder_ / "lab"), {}};
  EXPECT_EQ(found("meshes/link.stl", search), "lab/arm_description/meshes/link.stl");
  EXPECT_THAT(error("../../../outside.stl", search), says("here", "leaves", "copy"));
  EXPECT_THAT(error("outside.stl", search), testing::HasSubstr("is missing"));
  EXPECT_THAT(error(mesh_.string(), search), testing::HasSubstr("not named relative"));
}

// What others publish, with all links' shapes; the numbers are counted from the files.
TEST(RecordedRobots, TheirMeshesLoad) {
  const fs::path robots = data_folder() / "robots";
  if (!fs::exists(robots)) GTEST_SKIP() << "no recorded data at " << robots << "; set FORESIGHT_DATA";
  struct Known {
    const char* urdf;
    std::size_t with_shape;
  };
  for (const Known& known : {Known{"iiwa7/diff_robot_data/kuka_iiwa/urdf/iiwa7.urdf", 8},
                             Known{"panda/diff_robot_data/panda_description/urdf/panda.urdf", 11},
                             Known{"panda/diff_robot_data/panda_description/urdf/panda_no_gripper.urdf", 8}}) {
    const UrdfRobot robot = read_urdf(robots / known.urdf);
    std::size_t with_shape = 0;
    for (const Node& link : robot.links) with_shape += link.mesh.triangles.empty() ? 0 : 1;
    EXPECT_EQ(with_shape, known.with_shape) << known.urdf;
  }
  for (const char* xacro :
       {"schunk/schunk_description/urdf/lwa4d/lwa4d.urdf.xacro", "ptu_d46/flir_ptu_description/urdf/d46.urdf.xacro"})
    EXPECT_THAT(input_error([&] { read_urdf(robots / xacro); }), testing::HasSubstr("`xacro ")) << xacro;
}

}  // namespace
}  // namespace foresight::mesh_finder_test
