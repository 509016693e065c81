// Cells and portals: read, written again, and refused with words where they cannot be right.
#include "scene/cells.hpp"

#include "scene/scene_reader.hpp"
#include "scene/scene_writer.hpp"
#include "test_run.hpp"

namespace foresight::cells_test {
namespace {

const std::string kNodes = R"(
nodes:
  - {name: table, mesh: table.ply}
  - {name: shelf, mesh: table.ply, pose: {xyz: [5, 0, 0]}}
  - {name: lamp, mesh: table.ply, pose: {xyz: [5, 1, 1]}}
)";
const std::string kCells = R"(cells:
  - {name: hall, box: [[-1, -2, -1], [4, 3, 3]], nodes: [table]}
  - {name: lab, box: [[4, -2, -1], [9, 3, 3]], nodes: [shelf]}
)";
const std::string kPortals = R"(portals:
  - {between: [hall, lab], corners: [[4, 0, 0], [4, 1, 0], [4, 1, 2], [4, 0, 2]]}
)";

class CellsTest : public testing::Test {
 protected:
  CellsTest() { folder_.write("table.ply", kTriangle); }
  SceneModel read(const std::string& yaml) { return read_scene(folder_.write("scene.yaml", yaml), folder_.path()); }
  std::string error(const std::string& yaml) {
    return input_error([&] { read(yaml); });
  }
  TempFolder folder_;
};

TEST_F(CellsTest, AreReadAndWrittenAgain) {
  const SceneModel model = read(kNodes + kCells + kPortals);
  ASSERT_TRUE(model.cells());
  const TempFolder out;
  write_model(out.path(), model);
  for (const SceneModel& one : {model, read_scene(out / "scene.yaml", out.path())}) {
    const CellGraph& graph = *one.cells();
    ASSERT_EQ(graph.cells().size(), 2u);
    EXPECT_EQ(graph.cells()[1].name, "lab");
    EXPECT_EQ(graph.cells()[1].nodes, std::vector<int>{1});
    EXPECT_EQ(graph.cells()[0].box.max(), Eigen::Vector3d(4, 3, 3));
    ASSERT_EQ(graph.portals().size(), 1u);
    EXPECT_EQ(graph.portals()[0].corners[2], Eigen::Vector3d(4, 1, 2));
    EXPECT_EQ(graph.portals_of(0), std::vector<int>{0});
    EXPECT_EQ(graph.cells_at({0, 0, 0}), std::vector<int>{0});
    EXPECT_EQ(graph.cells_at({4, 0, 0}).size(), 2u) << "at the border";
    EXPECT_TRUE(graph.cells_at({0, 0, 9}).empty());
  }
  EXPECT_FALSE(read(kNodes).cells()) << "nobody needs them";
}

TEST_F(CellsTest, WordsForWhatCannotBeRight) {
  const auto portal = [](const std::string& text) { return "portals:\n  - " + text + "\n"; };
  EXPECT_THAT(error(kNodes + kCells), testing::HasSubstr("cell 'hall' has no portal"));
  EXPECT_THAT(error(kNodes + kPortals), testing::HasSubstr("there is no 'hall'"));
  EXPECT_THAT(error(kNodes + kCells + portal("{between: [hall, lap], corners: [[4, 0, 0], [4, 1, 0], [4, 1, 2]]}")),
              testing::HasSubstr("did you mean 'lab'"));
  EXPECT_THAT(error(kNodes + kCells + portal("{between: [hall], corners: [[4, 0, 0], [4, 1, 0], [4, 1, 2]]}")),
              testing::HasSubstr("joins 1 cells"));
  EXPECT_THAT(error(kNodes + kCells + portal("{between: [hall, hall], corners: [[4, 0, 0], [4, 1, 0], [4, 1, 2]]}")),
              testing::HasSubstr("joins a cell with itself"));
  EXPECT_THAT(error(kNodes + kCells + portal("{between: [hall, lab], corners: [[4, 0, 0], [4, 1, 0]]}")),
              testing::HasSubstr("no flat convex polygon"));
  EXPECT_THAT(error(kNodes + kCells +
                    portal("{between: [hall, lab], corners: [[4, 0, 0], [4, 1, 0], [4, .2, .4], [4, 0, 2]]}")),
              testing::HasSubstr("no flat convex polygon"));
  EXPECT_THAT(error(kNodes + kCells + portal("{between: [hall, lab], corners: [[4, 0, 0], [4, 1]]}")),
              testing::HasSubstr("corners"));
  EXPECT_THAT(error(kNodes + kCells + portal("{between: [hall, lab], corners: [[7, 0, 0], [7, 1, 0], [7, 1, 2]]}")),
              testing::HasSubstr("lies away from cell 'hall'"));
  const auto with = [&](const std::string& from, const std::string& to) {
    std::string cells = kCells;
    return kNodes + cells.replace(cells.find(from), from.size(), to) + kPortals;
  };
  EXPECT_THAT(error(with("[shelf]", "[lamp, shelf, table]")), testing::HasSubstr("another cell"));
  EXPECT_THAT(error(with("nodes: [shelf]", "nodes: [chair]")), testing::HasSubstr("there is no 'chair'"));
  EXPECT_THAT(error(kNodes + kCells + "  - {name: hall, box: [[9, 0, 0], [10, 1, 1]], nodes: []}\n" + kPortals),
              testing::HasSubstr("two cells are named 'hall'"));
  EXPECT_THAT(error(with("[4, 3, 3]], nodes: [table]", "[4, 3, 3]], nodes: [lamp]")),
              testing::HasSubstr("node 'lamp' sticks out of its cell 'hall'"));
  EXPECT_THAT(error(with("[9, 3, 3]", "[4, 3, 3]")), testing::HasSubstr("has no volume"));
  EXPECT_THAT(error(with("[9, 3, 3]", "[9, 3]")), testing::HasSubstr("box"));
}

}  // namespace
}  // namespace foresight::cells_test
