#include "scene/urdf_reader.hpp"

#include "scene/primitives.hpp"
#include "test_run.hpp"

namespace foresight::urdf_reader_test {
namespace {

std::string joint(const std::string& name, const std::string& type, const std::string& parent, const std::string& child,
                  const std::string& more = "") {
  return "<joint name='" + name + "' type='" + type + "'><parent link='" + parent + "'/><child link='" + child + "'/>" +
         more +
         (type == "revolute" || type == "prismatic" ? "<limit lower='-2' upper='2' effort='1' velocity='1'/>" : "") +
         "</joint>";
}

std::string link(const std::string& name, const std::string& geometry = "") {
  return "<link name='" + name + "'>" +
         (geometry.empty() ? "" : "<visual><geometry>" + geometry + "</geometry></visual>") + "</link>";
}

class Urdf : public testing::Test {
 protected:
  UrdfRobot read(const std::string& body) {
    return read_urdf(folder_.write("robot/urdf/r.urdf", "<robot name='r'>" + body + "</robot>"), folder_.path());
  }
  std::string error(const std::string& body) {
    return input_error([&] { read(body); });
  }
  // World pose of the named link.
  static Pose pose(const UrdfRobot& robot, const std::string& name) {
    std::vector<Pose> T;
    for (const Node& node : robot.links) {
      T.push_back(node.parent < 0 ? node.T_parent_node : T[static_cast<std::size_t>(node.parent)] * node.T_parent_node);
      if (node.name == name) return T.back();
    }
    ADD_FAILURE() << name;
    return Pose::Identity();
  }
  TempFolder folder_;
};

double signed_volume(const Mesh& mesh) {
  double sum = 0;
  for (const auto& t : mesh.triangles) {
    const auto v = [&](int i) { return mesh.vertices[t[static_cast<std::size_t>(i)]].cast<double>().eval(); };
    sum += v(0).dot(v(1).cross(v(2))) / 6;
  }
  return sum;
}

// Each edge of a closed, evenly turned surface is used once in each direction.
bool is_closed(const Mesh& mesh) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> edges;
  for (const auto& t : mesh.triangles)
    for (std::size_t i = 0; i < 3; ++i) ++edges[{t[i], t[(i + 1) % 3]}];
  return std::all_of(edges.begin(), edges.end(), [&](const auto& e) {
    return e.second == 1 && edges.contains({e.first.second, e.first.first});
  });
}

TEST(Primitives, AreClosedAndTurnedOutwards) {
  const Mesh box = make_box({1, 2, 3}), cylinder = make_cylinder(2, 3), sphere = make_sphere(2);
  for (const Mesh* mesh : {&box, &cylinder, &sphere}) EXPECT_TRUE(is_closed(*mesh));
  EXPECT_NEAR(signed_volume(box), 6, 1e-5);
  // A 32-gon has 0.9936 of its circle's area; the sphere loses to both subdivisions.
  EXPECT_NEAR(signed_volume(cylinder) / (M_PI * 4 * 3), 0.9936, 1e-4);
  EXPECT_NEAR(signed_volume(sphere) / (4. / 3 * M_PI * 8), 0.98, 0.01);
  EXPECT_EQ(box.vertices.size(), 8u);
  EXPECT_EQ(box.dropped_degenerate + cylinder.dropped_degenerate + sphere.dropped_degenerate, 0u);
}

TEST_F(Urdf, ForwardKinematics) {
  UrdfRobot robot =
      read(link("base") + link("a") + link("b") + link("c") +
           joint("j1", "revolute", "base", "a", "<origin xyz='0 0 1'/><axis xyz='0 0 2'/>") +
           joint("j2", "prismatic", "a", "b", "<origin xyz='1 0 0' rpy='0 0 1.5707963267948966'/><axis xyz='1 0 0'/>") +
           joint("j3", "fixed", "b", "c", "<origin xyz='0 0 0.5'/>"));
  EXPECT_TRUE(pose(robot, "c").translation().isApprox(Eigen::Vector3d(1, 0, 1.5)));
  pose_links(robot, {{"j1", M_PI / 2}, {"j2", 0.25}}, "here");
  // j1 turns x to y; b's own x axis then points along the world's -x.
  EXPECT_TRUE(pose(robot, "c").translation().isApprox(Eigen::Vector3d(-0.25, 1, 1.5)))
      << pose(robot, "c").translation();
  pose_links(robot, {}, "here");
  EXPECT_TRUE(pose(robot, "c").translation().isApprox(Eigen::Vector3d(1, 0, 1.5)));
  ASSERT_EQ(robot.joints.size(), 3u);
  for (std::size_t i = 0; i < 3; ++i) EXPECT_EQ(robot.joints[i].child, static_cast<int>(i) + 1);
}

TEST_F(Urdf, MimicJointsFollow) {
  const std::string sliding = "<axis xyz='1 0 0'/>";
  UrdfRobot robot =
      read(link("base") + link("a") + link("b") + link("c") + joint("lead", "prismatic", "base", "a", sliding) +
           joint("second", "prismatic", "base", "b", sliding + "<mimic joint='lead' multiplier='-2' offset='0.1'/>") +
           joint("third", "prismatic", "base", "c", sliding + "<mimic joint='second' multiplier='3' offset='1'/>"));
  pose_links(robot, {{"lead", 0.5}}, "here");
  EXPECT_NEAR(pose(robot, "b").translation().x(), -0.9, 1e-12);
  EXPECT_NEAR(pose(robot, "c").translation().x(), -1.7, 1e-12);
  EXPECT_THAT(input_error([&] {
                pose_links(robot, {{"second", 0}}, "here");
              }),
              says("here", "'second' follows another", "set 'lead' instead"));
}

TEST_F(Urdf, UnnamedJointsStandAtZeroOrTheNearestLimit) {
  UrdfRobot robot = read(link("base") + link("a") +
                         "<joint name='j' type='prismatic'><parent link='base'/><child link='a'/><axis xyz='1 0 0'/>"
                         "<limit lower='0.3' upper='2' effort='1' velocity='1'/></joint>");
  pose_links(robot, {}, "here");
  EXPECT_NEAR(pose(robot, "a").translation().x(), 0.3, 1e-12);
}

TEST_F(Urdf, RefusesJointPositions) {
  UrdfRobot robot = read(link("base") + link("a") + link("b") + joint("turn", "continuous", "base", "a") +
                         joint("glue", "fixed", "a", "b"));
  const auto refusal = [&](const char* name, double q) {
    return input_error([&] { pose_links(robot, {{name, q}}, "here"); });
  };
  EXPECT_EQ(refusal("turn", 100), "no error");
  EXPECT_THAT(refusal("turm", 0), says("here", "no joint 'turm'", "did you mean 'turn'?"));
  EXPECT_THAT(refusal("glue", 0), says("here", "'glue' is fixed", "remove it"));
  EXPECT_THAT(refusal("turn", std::numeric_limits<double>::infinity()), says("here", "beyond its limits", "choose"));
  EXPECT_THAT(refusal("turn", std::numeric_limits<double>::quiet_NaN()), says("here", "beyond its limits", "choose"));
}

TEST_F(Urdf, ReadsVisualGeometry) {
  folder_.write("robot/meshes/m.ply", kTriangle);
  const std::string visuals =
      "<link name='base'>"
      "<visual><origin xyz='5 0 0'/><geometry><mesh filename='package://robot/meshes/m.ply' scale='2 3 "
      "-1'/></geometry></visual>"
      "<visual><geometry><sphere radius='0.5'/></geometry></visual>"
      "<collision><geometry><box size='9 9 9'/></geometry></collision></link>";
  const UrdfRobot robot = read(visuals);
  Eigen::AlignedBox3f box;
  for (const auto& v : robot.links[0].mesh.vertices) box.extend(v);
  EXPECT_TRUE(box.max().isApprox(Eigen::Vector3f(7, 3, 0.5)));       // the mesh from x = 5 to 7, y = 0 to 3
  EXPECT_TRUE(box.min().isApprox(Eigen::Vector3f(-0.5, -0.5, -1)));  // the sphere; the mesh at z = -1
  EXPECT_EQ(robot.links[0].mesh.triangles.size(), make_sphere(0.5).triangles.size() + 1);
}

// Each of these once made a robot without that link's shape, and without a word: its gate would not have seen it.
TEST_F(Urdf, NoShapeIsLostWithoutAWord) {
  struct Row {
    const char* geometry;
    std::vector<const char*> words;
  };
  const Row rows[] = {
      {"<cylinder radius='0,09' length='1'/>", {"<cylinder>", "radius=\"0,09\" is no number", "a point", "metres"}},
      {"<cylinder radius='nan' length='1'/>", {"<cylinder>", "radius=\"nan\" is not finite"}},
      {"<cylinder radius='1e999' length='1'/>", {"radius=\"1e999\" is no number"}},
      {"<cylinder radius='0.1'/>", {"<cylinder>", "has no length"}},
      {"<cylinder radius='0.1' lenght='1'/>", {"<cylinder>", "'lenght'", "write length"}},
      {"<cylinder radius='0.1' length='-1'/>", {"length=\"-1\" is not positive"}},
      {"<sphere radius=''/>", {"<sphere>", "radius=\"\" has 0 numbers"}},
      {"<sphere radius='0'/>", {"radius=\"0\" is not positive"}},
      {"<sphere radius='0.1m'/>", {"radius=\"0.1m\" is no number"}},
      {"<sphere radius='0.1 0.2'/>", {"radius=\"0.1 0.2\" has 2 numbers"}},
      {"<box size='1 1'/>", {"<box>", "size=\"1 1\" has 2 numbers", "x y z"}},
      {"<box size='1 1 inf'/>", {"size=\"1 1 inf\"", "'inf'", "not finite"}},
      {"<box/>", {"<box>", "has no size"}},
      {"<capsule radius='1' length='1'/>", {"<capsule> is unknown", "box, cylinder, sphere or mesh"}},
      {"<Box size='1 1 1'/>", {"<Box> is unknown"}},
      {"<box size='1 1 1'/><sphere radius='1'/>", {"has 2 shapes"}},
      {"<mesh/>", {"<mesh>", "has no filename"}},
      {"<mesh filename='none.stl'/>", {"'none.stl'"}},
      {"<mesh filename='m.ply' scale='0 1 1'/>", {"scale=\"0 1 1\"", "'0'", "is zero"}},
      {"<mesh filename='m.ply' scale='0.001'/>", {"scale=\"0.001\" has 1 number", "three factors"}},
      {"<mesh filename='broken.ply'/>", {"broken.ply"}},
      {"<mesh filename='empty.ply'/>", {"empty.ply"}}};
  folder_.write("robot/urdf/m.ply", kTriangle);
  folder_.write("robot/urdf/broken.ply", "ply\nformat ascii 1.0\nelement vertex 3\n");
  folder_.write("robot/urdf/empty.ply", "ply\nformat ascii 1.0\nelement vertex 0\nend_header\n");
  for (const char* element : {"visual", "collision"})
    for (const Row& row : rows) {
      const std::string tag = std::string("<") + element + ">";
      const std::string refusal = input_error([&] {
        const auto file =
            folder_.write("robot/urdf/r.urdf", "<robot name='r'>\n<link name='base'>\n" + tag + "<geometry>" +
                                                   row.geometry + "</geometry></" + tag.substr(1) + "</link></robot>");
        read_urdf(file, folder_.path(), UrdfShapes::all);
      });
      for (const char* word : row.words) EXPECT_THAT(refusal, testing::HasSubstr(word)) << tag << row.geometry;
      if (std::string(row.geometry).find("ply") == std::string::npos) {
        EXPECT_THAT(refusal, says("link 'base'", tag, "")) << row.geometry;
      }
    }
}

TEST_F(Urdf, WhatIsAroundAShapeIsRead) {
  const std::string box = "<geometry><box size='1 1 1'/></geometry>";
  const auto base = [&](const std::string& inside) { return error("<link name='base'>" + inside + "</link>"); };
  EXPECT_THAT(base("<visual/>"), says("r.urdf:1", "link 'base' <visual>", "has no <geometry>"));
  EXPECT_THAT(base("<collision><geometry/></collision>"), says("<collision>", "empty <geometry>", "give it one of"));
  EXPECT_THAT(base("<visual>" + box + box + "</visual>"), says("<visual>", "has 2 <geometry>", "one visual for each"));
  EXPECT_THAT(base("<colision>" + box + "</colision>"), says("link 'base'", "<colision>", "write <collision>"));
  EXPECT_THAT(base("<Visual>" + box + "</Visual>"), says("link 'base'", "<Visual>", "write <visual>"));
  EXPECT_THAT(base("<visual><origin xyz='0 0'/>" + box + "</visual>"), says("<origin>", "xyz=\"0 0\" has 2", "metres"));
  EXPECT_THAT(base("<visual><origin rpy='0 0 ,5'/>" + box + "</visual>"), says("<origin>", "',5'", "radians"));
  EXPECT_EQ(base("<visual>" + box + "</visual><contact/>"), "no error");
  // The parser gives a link up at the first thing that it does not understand, with all of its shapes.
  EXPECT_THAT(base("<visual>" + box + "</visual><inertial/>"),
              says("link 'base'", "only 0 of its 1 <visual> can be read (", "specification"));
  const auto moved = [&](const std::string& inside) {
    return error(link("base") + link("a") + joint("j", "revolute", "base", "a", inside));
  };
  EXPECT_THAT(moved("<origin xyz='0 nan 0'/>"), says("joint 'j' <origin>", "'nan'", "metres"));
  EXPECT_THAT(moved("<axis xyz='0 0 1,0'/>"), says("joint 'j' <axis>", "'1,0'", "unit vector"));
  EXPECT_THAT(error(link("base") + link("a") +
                    "<joint name='j' type='revolute'><parent link='base'/><child link='a'/>"
                    "<limit lower='-1' upper='1' effort='1' velocity='-1'/></joint>"),
              says("joint 'j' <limit>", "velocity=\"-1\" is negative", "per second"));
  EXPECT_THAT(error(link("base") + link("a") +
                    "<joint name='j' type='revolute'><parent link='base'/><child link='a'/>"
                    "<limit lower='-1' upper='1' effort='1'/></joint>"),
              says("joint 'j' <limit>", "has no velocity", "per second"));
}

TEST_F(Urdf, TheBodyIsTheCollisionShapeWhereThereIsOne) {
  const std::string two =
      "<link name='base'><visual><geometry><sphere radius='0.5'/></geometry></visual>"
      "<collision><origin xyz='1 0 0'/><geometry><box size='1 1 1'/></geometry></collision>"
      "<collision><origin xyz='3 0 0'/><geometry><box size='1 1 1'/></geometry></collision></link>" +
      link("a", "<box size='2 2 2'/>") + link("frame") + joint("j", "fixed", "base", "a") +
      joint("k", "fixed", "a", "frame");
  const auto file = folder_.write("r.urdf", "<robot name='r'>" + two + "</robot>");
  const UrdfRobot seen = read_urdf(file, folder_.path()), all = read_urdf(file, folder_.path(), UrdfShapes::all);
  EXPECT_TRUE(seen.collision.empty());
  Eigen::AlignedBox3f box;
  for (const auto& v : all.body(0).vertices) box.extend(v);
  EXPECT_NEAR(box.min().x(), 0.5, 1e-6);
  EXPECT_NEAR(box.max().x(), 3.5, 1e-6) << "all of them";
  EXPECT_EQ(&all.body(1), &all.links[1].mesh);
  EXPECT_TRUE(all.body(2).vertices.empty());
}

TEST_F(Urdf, ABodyInAnotherUnitIsRefused) {
  const auto refusal = [&](const std::string& geometry) {
    const auto file = folder_.write("r.urdf", "<robot name='r'>" + link("base", geometry) + "</robot>");
    return input_error([&] { read_urdf(file, folder_.path(), UrdfShapes::all); });
  };
  EXPECT_THAT(refusal("<cylinder radius='65' length='140'/>"), says("link 'base'", "m large", "millimetres"));
  EXPECT_THAT(refusal("<sphere radius='0.0001'/>"), says("link 'base'", "0.0002 m large", "in metres"));
  EXPECT_EQ(refusal("<sphere radius='0.01'/>"), "no error");
}

TEST_F(Urdf, FindsMeshesAboveTheUrdf) {
  folder_.write("robot/meshes/m.ply", kTriangle);
  for (const char* name : {"package://robot/meshes/m.ply", "meshes/m.ply", "../meshes/m.ply", "robot/meshes/m.ply"})
    EXPECT_EQ(error(link("base", std::string("<mesh filename='") + name + "'/>")), "no error") << name;
  // The root folder is the package itself.
  const auto urdf =
      folder_.write("robot/urdf/p.urdf",
                    "<robot name='r'>" + link("base", "<mesh filename='package://robot/meshes/m.ply'/>") + "</robot>");
  EXPECT_EQ(input_error([&] { read_urdf(urdf, folder_ / "robot"); }), "no error");
}

TEST_F(Urdf, RefusesMeshesFromOutside) {
  TempFolder outside;
  outside.write("m.ply", kTriangle);
  const auto mesh = [&](const std::string& name) { return error(link("base", "<mesh filename='" + name + "'/>")); };
  EXPECT_THAT(mesh((outside / "m.ply").string()), says("link 'base'", "not named relative", "package://"));
  EXPECT_THAT(mesh("file://" + (outside / "m.ply").string()), says("link 'base'", "not named relative", "package://"));
  EXPECT_THAT(mesh("../../../" + outside.path().filename().string() + "/m.ply"), says("link 'base'", "leaves", "copy"));
  EXPECT_THAT(mesh("package://robot/none.ply"),
              says("link 'base'", "'package://robot/none.ply' is missing", "one of these places"));
}

TEST_F(Urdf, NamesWhatIsWrong) {
  EXPECT_THAT(error("<link"), says("r.urdf:1", "is no whole XML", "correct it"));
  EXPECT_THAT(error(""), says("r.urdf", "not a valid URDF", "check_urdf"));
  EXPECT_THAT(error(link("a") + link("b")), says("r.urdf", "not a valid URDF (", "check_urdf"));
  EXPECT_THAT(error(link("base") + link("a") + joint("j", "fixed", "base", "b")),
              says("r.urdf", "not a valid URDF (", "check_urdf"));
  EXPECT_THAT(error(link("base", "<box size='1 -1 1'/>")),
              says("size=\"1 -1 1\"", "'-1', which is not positive", "metres"));
  EXPECT_THAT(error(link("base") + link("a") + joint("j", "revolute", "base", "a", "<axis xyz='0 0 0'/>")),
              says("joint 'j'", "axis has no direction", "unit vector"));
  EXPECT_THAT(error(link("base") + link("a") + link("b") + joint("j", "fixed", "base", "a") +
                    joint("k", "fixed", "base", "b") + joint("l", "fixed", "a", "b")),
              says("link 'b'", "has two parent joints", "remove one"));
  EXPECT_THAT(
      error(link("base") + link("a") + link("b") + joint("j", "fixed", "a", "b") + joint("k", "fixed", "b", "a")),
      says("r.urdf", "hang in a circle", "connect every link to base"));
  EXPECT_THAT(error(link("base") + link("a") + joint("j", "revolute", "base", "a", "<mimic joint='none'/>")),
              says("joint 'j'", "follows 'none', which is no joint", "moving joint"));
  EXPECT_THAT(error(link("base") + link("a") + joint("j", "revolute", "base", "a", "<mimic joint='j'/>")),
              says("joint 'j'", "in a circle", "remove one"));
  const std::string deep = [] {
    std::string s;
    for (int i = 0; i < 200'000; ++i) s += "<a>";
    return s;
  }();
  EXPECT_THAT(error(deep), says("r.urdf", "nest too deep", "plain URDF"));
  const auto xacro = folder_.write(
      "x.urdf", "<robot name='r' xmlns:xacro='http://ros.org/wiki/xacro'><xacro:include filename='y'/></robot>");
  EXPECT_THAT(input_error([&] { read_urdf(xacro, folder_.path()); }),
              says("x.urdf", "is a xacro file", "`xacro x.urdf"));
  folder_.write("x.urdf",
                "<robot name='r' xmlns:xacro='http://ros.org/wiki/xacro'><!-- of <xacro:arm side='${side}'/> -->"
                "<link name='base'/></robot>");
  EXPECT_EQ(input_error([&] { read_urdf(xacro, folder_.path()); }), "no error") << "a comment is no macro";
}

}  // namespace
}  // namespace foresight::urdf_reader_test
