#include "scene/mesh_reader.hpp"

#include <Eigen/Geometry>
#include <bit>
#include <cstring>
#include <limits>

#include "scene/mesh_builder.hpp"
#include "test_run.hpp"

namespace foresight::mesh_reader_test {
namespace {

Mesh read(const std::string& name, const std::string& content) {
  TempFolder folder;
  return read_mesh(folder.write(name, content));
}

std::string error(const std::string& name, const std::string& content) {
  return input_error([&] { read(name, content); });
}

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const auto at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return text.replace(at, from.size(), to);
}

double area(const Mesh& mesh) {
  double sum = 0;
  for (const auto& t : mesh.triangles) {
    const auto v = [&](int i) { return mesh.vertices[t[static_cast<std::size_t>(i)]].cast<double>().eval(); };
    sum += (v(1) - v(0)).cross(v(2) - v(0)).norm() / 2;
  }
  return sum;
}

template <typename T>
std::string bytes(T value, bool big) {
  std::string out(sizeof(T), 0);
  std::memcpy(out.data(), &value, sizeof(T));
  if (big != (std::endian::native == std::endian::big)) std::reverse(out.begin(), out.end());
  return out;
}

// Two triangles over a unit square, with normals, colours and confidence, as scanners write them.
std::string binary_square(bool big, bool doubles) {
  const std::string type = doubles ? "double" : "float";
  std::string out = std::string("ply\r\nformat binary_") + (big ? "big" : "little") +
                    "_endian 1.0\r\ncomment by a scanner\r\nobj_info x\r\nelement vertex 4\r\n";
  for (const char* name : {"nx", "x", "y", "z"}) out += "property " + type + " " + name + "\r\n";
  out +=
      "property uchar red\r\nproperty float32 confidence\r\nproperty list uint8 int16 seen\r\n"
      "element face 2\r\nproperty uchar flags\r\nproperty list uint8 uint32 vertex_index\r\nend_header\r\n";
  const double xyz[4][3] = {{0, 0, 5}, {1, 0, 5}, {1, 1, 5}, {0, 1, 5}};
  for (const auto& v : xyz) {
    for (double value : {9.0, v[0], v[1], v[2]})
      out += doubles ? bytes(value, big) : bytes(static_cast<float>(value), big);
    out += bytes<std::uint8_t>(200, big) + bytes(0.5f, big);
    out += bytes<std::uint8_t>(2, big) + bytes<std::int16_t>(-1, big) + bytes<std::int16_t>(7, big);
  }
  for (const auto& f : {std::array{0u, 1u, 2u}, std::array{0u, 2u, 3u}}) {
    out += bytes<std::uint8_t>(1, big) + bytes<std::uint8_t>(3, big);
    for (std::uint32_t i : f) out += bytes(i, big);
  }
  return out;
}

TEST(Ply, ReadsAscii) {
  const Mesh mesh = read("m.ply", kTriangle);
  ASSERT_EQ(mesh.vertices.size(), 3u);
  EXPECT_EQ(mesh.vertices[1], Eigen::Vector3f(1, 0, 1));
  ASSERT_EQ(mesh.triangles.size(), 1u);
  EXPECT_EQ(mesh.triangles[0], (std::array<std::uint32_t, 3>{0, 1, 2}));
}

TEST(Ply, ReadsBothByteOrdersWithExtraProperties) {
  for (bool big : {false, true}) {
    for (bool doubles : {false, true}) {
      const Mesh mesh = read("m.ply", binary_square(big, doubles));
      EXPECT_EQ(mesh.vertices.size(), 4u);
      EXPECT_EQ(mesh.triangles.size(), 2u);
      EXPECT_DOUBLE_EQ(area(mesh), 1) << big << doubles;
      EXPECT_EQ(mesh.vertices[2], Eigen::Vector3f(1, 1, 5));
    }
  }
}

TEST(Ply, WeldsVerticesAtOnePlace) {
  // Every triangle has its own three vertices; -0 is 0.
  const Mesh mesh = read("m.ply",
                         "ply\nformat ascii 1.0\nelement vertex 6\nproperty double x\nproperty double y\n"
                         "property double z\nelement face 2\nproperty list uchar int vertex_indices\nend_header\n"
                         "0 0 0\n1 0 0\n1 1 0\n-0 0 -0.0\n1 1 0\n0 1 0\n3 0 1 2\n3 3 4 5\n");
  EXPECT_EQ(mesh.vertices.size(), 4u);
  ASSERT_EQ(mesh.triangles.size(), 2u);
  EXPECT_EQ(mesh.triangles[1][0], mesh.triangles[0][0]);
  EXPECT_EQ(mesh.triangles[1][1], mesh.triangles[0][2]);
}

TEST(Ply, DropsAndCountsWhatHasNoArea) {
  std::string text = replaced(kTriangle, "vertex 3", "vertex 5");
  text = replaced(text, "face 1", "face 5");
  text = replaced(text, "0 1 1\n3 0 1 2\n", "0 1 1\n2 0 1\n1 0 1\n3 0 1 2\n3 0 1 1\n3 0 1 3\n3 4 2 1\n2 0 1\n");
  const Mesh mesh = read("m.ply", text);
  EXPECT_EQ(mesh.triangles.size(), 1u);
  EXPECT_EQ(mesh.dropped_degenerate, 4u);
  EXPECT_EQ(mesh.vertices.size(), 3u);  // only what the rest uses
}

TEST(Ply, TriangulatesConcavePolygons) {
  // An arrowhead, started at a corner from which a fan would leave it: area 1, not 2.
  //   (0,2)
  //     |`.
  //     |   `(0.5,0.5)... (2,0)   reflex corner at (0.5, 0.5)
  const std::string text =
      "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
      "element face 1\nproperty list uchar int vertex_indices\nend_header\n"
      "2 0 0\n0.5 0.5 0\n0 2 0\n0 0 0\n4 0 1 2 3\n";
  const Mesh mesh = read("m.ply", text);
  EXPECT_EQ(mesh.triangles.size(), 2u);
  EXPECT_NEAR(area(mesh), 1, 1e-6);
}

TEST(MeshBuilder, TriangulatesAComb) {
  // Many reflex corners; the area must come out right and no triangle may lie outside.
  std::vector<Eigen::Vector3f> comb = {{0, 0, 0}, {10, 0, 0}};
  for (int i = 10; i > 0; --i) {
    comb.push_back({static_cast<float>(i), 2, 0});
    comb.push_back({static_cast<float>(i) - 0.5f, 1, 0});
  }
  comb.push_back({0, 2, 0});
  MeshBuilder builder;
  builder.add(comb);
  const Mesh mesh = std::move(builder).take();
  EXPECT_EQ(mesh.triangles.size() + mesh.dropped_degenerate, comb.size() - 2);
  double shoelace = 0;
  for (std::size_t i = 0; i < comb.size(); ++i) {
    const auto &a = comb[i], &b = comb[(i + 1) % comb.size()];
    shoelace += (a.x() * b.y() - b.x() * a.y()) / 2;
  }
  EXPECT_NEAR(area(mesh), shoelace, 1e-5);
}

TEST(Ply, NamesWhatIsWrongWithTheData) {
  EXPECT_THAT(error("m.ply", replaced(kTriangle, "0 1 1\n3", "0 nan 1\n3")),
              says("m.ply:12: vertex 2", "not finite", "repair"));
  EXPECT_THAT(error("m.ply", replaced(kTriangle, "0 1 1\n3", "0 1e39 1\n3")),
              says("m.ply:12: vertex 2", "not finite", "repair"));
  EXPECT_THAT(error("m.ply", replaced(kTriangle, "0 1 1\n3", "0 x 1\n3")),
              says("m.ply:12: vertex 2", "'x' is not a number", "correct"));
  EXPECT_THAT(error("m.ply", replaced(kTriangle, "3 0 1 2", "3 0 1 3")),
              says("m.ply: face 0", "vertex index 3 is out of range, there are 3", "export"));
  EXPECT_THAT(error("m.ply", replaced(kTriangle, "3 0 1 2", "3 0 1 -1")),
              says("m.ply: face 0", "index -1 is out of range", "export"));
  EXPECT_THAT(error("m.ply", replaced(kTriangle, "3 0 1 2", "3 0 1 1.5")),
              says("m.ply:13: face 0", "'1.5' is not an integer", "correct"));
  EXPECT_THAT(error("m.ply", replaced(kTriangle, "3 0 1 2", "3 0 1")),
              says("m.ply", "ends before the data", "truncated"));
  EXPECT_THAT(error("m.ply", replaced(kTriangle, "3 0 1 2", "3 0 1 1")),
              says("m.ply", "none of its faces has an area", "export"));
  EXPECT_THAT(error("m.ply", replaced(kTriangle, "face 1", "face 0")), says("m.ply", "has no faces", "point cloud"));
}

TEST(Ply, NamesWhatIsWrongWithTheHeader) {
  EXPECT_THAT(error("m.ply", replaced(kTriangle, "ply\n", "pyl\n")),
              says("m.ply:1", "not a PLY file", "name a PLY mesh"));
  EXPECT_THAT(error("m.ply", ""), says("m.ply:1", "without end_header", "damaged"));
  EXPECT_THAT(error("m.ply", replaced(kTriangle, "ascii", "text")),
              says("m.ply:2", "unknown format", "binary_little_endian"));
  EXPECT_THAT(error("m.ply", replaced(kTriangle, "float y", "real y")),
              says("m.ply:5", "unknown type 'real'", "export"));
  EXPECT_THAT(error("m.ply", replaced(kTriangle, "float y", "float w")),
              says("m.ply", "has no property y", "x, y and z"));
  EXPECT_THAT(error("m.ply", replaced(kTriangle, "vertex_indices", "corners")),
              says("m.ply", "vertex_indices", "export"));
  EXPECT_THAT(error("m.ply", replaced(kTriangle, "end_header\n", "")),
              says("m.ply:9", "unknown header word '0'", "export"));
}

TEST(Ply, AbsurdCountsFailBeforeAnythingIsAllocated) {
  for (const char* count : {"4000000000", "9000000000000000000"}) {
    EXPECT_THAT(error("m.ply", replaced(kTriangle, "vertex 3", std::string("vertex ") + count)),
                says("m.ply", "ends before the data", "truncated"));
    EXPECT_THAT(error("m.ply", replaced(binary_square(false, false), "face 2", std::string("face ") + count)),
                says("m.ply", "ends before the data", "truncated"));
  }
  EXPECT_THAT(error("m.ply", replaced(kTriangle, "3 0 1 2", "4294967295 0 1 2")),
              says("m.ply", "ends before the data", "truncated"));
}

TEST(Ply, EveryTruncationOfABinaryFileIsAnError) {
  const std::string whole = binary_square(true, true);
  for (std::size_t n = 0; n < whole.size(); ++n)
    EXPECT_NE(error("m.ply", whole.substr(0, n)), "no error") << n << " of " << whole.size();
}

TEST(MeshReader, ReadsTheOtherForms) {
  EXPECT_NEAR(area(read("m.obj", "v 0 0 0\nv 2 0 0\nv 2 2 0\nv 0 2 0\nf 1 2 3 4\n")), 4, 1e-6);
  EXPECT_NEAR(area(read("M.STL",
                        "solid s\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\n"
                        "endloop\nendfacet\nendsolid s\n")),
              0.5, 1e-6);
  std::string stl(80, ' ');
  stl += bytes<std::uint32_t>(1, false);
  for (float f : {0, 0, 1, 0, 0, 0, 2, 0, 0, 0, 2, 0}) stl += bytes(f, false);
  EXPECT_NEAR(area(read("m.stl", stl + std::string(2, '\0'))), 2, 1e-6);
}

// One triangle under a node that scales by 2 and moves by (10, 0, 0).
const std::string kGltf = R"({"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}],
 "nodes": [{"mesh": 0, "scale": [2, 2, 2], "translation": [10, 0, 0]}],
 "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
 "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3", "min": [0, 0, 0], "max": [1, 1, 0]}],
 "bufferViews": [{"buffer": 0, "byteLength": 36}], "buffers": [{"uri": "@.bin", "byteLength": 36}]})";

std::string gltf_buffer() {
  std::string out;
  for (float f : {0, 0, 0, 1, 0, 0, 0, 1, 0}) out += bytes(f, false);
  return out;
}

TEST(MeshReader, AppliesTheNodesOfAGltf) {
  TempFolder folder;
  folder.write("in/m.bin", gltf_buffer());
  const Mesh mesh = read_mesh(folder.write("in/m.gltf", replaced(kGltf, "@", "m")));
  EXPECT_NEAR(area(mesh), 2, 1e-6);
  EXPECT_EQ(mesh.vertices[0], Eigen::Vector3f(10, 0, 0));
}

TEST(MeshReader, DoesNotFollowAGltfOutOfItsFolder) {
  TempFolder folder;
  folder.write("out.bin", gltf_buffer());
  const auto file = folder.write("in/m.gltf", replaced(kGltf, "@", "../out"));
  EXPECT_THAT(input_error([&] { read_mesh(file); }), says("m.gltf", "cannot be read as a mesh", "export"));
}

const std::string kCollada = R"(<COLLADA version="1.4.1"><asset><unit meter="1"/><up_axis>Z_UP</up_axis></asset>
<library_geometries><geometry id="g"><mesh>
<source id="p"><float_array id="a" count="9">0 0 0 2 0 0 0 0 1</float_array><technique_common>
<accessor source="#a" count="3" stride="3"><param name="X" type="float"/><param name="Y" type="float"/>
<param name="Z" type="float"/></accessor></technique_common></source>
<vertices id="v"><input semantic="POSITION" source="#p"/></vertices>
<triangles count="1"><input semantic="VERTEX" source="#v" offset="0"/><p>0 1 2</p></triangles></mesh></geometry>
</library_geometries><library_visual_scenes><visual_scene id="s"><node id="n"><instance_geometry url="#g"/></node>
</visual_scene></library_visual_scenes><scene><instance_visual_scene url="#s"/></scene></COLLADA>)";

TEST(MeshReader, LeavesTheAxesOfACollada) {
  const Mesh mesh = read("m.dae", kCollada);
  EXPECT_NEAR(area(mesh), 1, 1e-6);
  EXPECT_EQ(mesh.vertices[2], Eigen::Vector3f(0, 0, 1));  // Z_UP stays z
}

// Each of these makes assimp 5.2 read out of bounds or loop for ever.
TEST(MeshReader, RefusesADamagedColladaBeforeAssimpSeesIt) {
  EXPECT_THAT(error("m.dae", replaced(kCollada, "count=\"9\"", "count=\"0\"")),
              says("m.dae:4", "reads beyond its array of 0", "export"));
  EXPECT_THAT(error("m.dae", replaced(kCollada, "count=\"9\"", "")), says("m.dae:3", "no valid count", "export"));
  // assimp makes room for the indices of so many inputs, 24 GB
  EXPECT_THAT(error("m.dae", replaced(kCollada, "offset=\"0\"", "offset=\"1000000000\"")),
              says("m.dae", "no valid offset", "export"));
  EXPECT_THAT(error("m.dae", replaced(kCollada, "count=\"3\"", "count=\"4\"")),
              says("m.dae:4", "reads beyond its array of 9", "export"));
  EXPECT_THAT(error("m.dae", replaced(kCollada, "stride=\"3\"", "stride=\"9223372036854775807\"")),
              says("m.dae:4", "no valid stride", "export"));
  EXPECT_THAT(error("m.dae", replaced(kCollada, "0 1 2</p>", "0 1 x</p>")), says("m.dae:7", "an index list", "export"));
  EXPECT_THAT(error("m.dae", replaced(kCollada, "<p>0 1 2</p>", "<p>0 1 2</p><p>0 1 2</p>")),
              says("m.dae:7", "has 2 index lists where 1 are announced", "export"));
  EXPECT_THAT(error("m.dae", replaced(kCollada, "<p>", "<p>>")), says("m.dae:7", "an index list", "export"));
  const std::string list = replaced(replaced(kCollada, "<triangles", "<polylist"), "</triangles", "</polylist");
  EXPECT_THAT(error("m.dae", list), says("m.dae:7", "has 0 polygon sizes where 1 are announced", "export"));
  EXPECT_EQ(error("m.dae", replaced(list, "<p>", "<vcount> 3 </vcount><p>")), "no error");
  EXPECT_THAT(error("m.dae", replaced(kCollada, "<COLLADA", "<collada")),
              says("m.dae:1", "no COLLADA element", "export"));
  EXPECT_THAT(error("m.dae", replaced(kCollada, "</geometry>", "</geom>")),
              says("m.dae:7", "is no whole XML: Start-end tags mismatch", "export"));
  EXPECT_THAT(error("m.dae", replaced(kCollada, "</scene></COLLADA>", "")),
              says("m.dae:9", "is no whole XML", "export"));
}

// Attributes and text as XML means them: references, quotes of both kinds, comments, and a '>' inside of a value.
TEST(MeshReader, ReadsAColladaAsXmlMeansIt) {
  EXPECT_EQ(error("m.dae", replaced(kCollada, "0 1 2</p>", "0 1 &#50;</p>")), "no error");
  EXPECT_EQ(error("m.dae", replaced(kCollada, "count=\"9\"", "name='a > b' count='9'")), "no error");
  EXPECT_EQ(error("m.dae", replaced(kCollada, "<p>", "<!-- <p>x</p> --><p>")), "no error");
  EXPECT_THAT(error("m.dae", replaced(kCollada, "count=\"9\"", "name='a > b' count='8'")),
              says("m.dae:4", "reads beyond its array of 8", "export"));
  EXPECT_THAT(error("m.dae", replaced(kCollada, "count=\"9\"", "name='>' count='&#56;'")),
              says("m.dae:4", "reads beyond its array of 8", "export"));
}

TEST(MeshReader, RefusesWhatIsNoMesh) {
  EXPECT_THAT(input_error([] { read_mesh("nothing_there"); }), says("nothing_there", "no such file", "name"));
  EXPECT_THAT(error("m.xyz", "1 2 3"), says("m.xyz", "unknown kind of mesh '.xyz'", "convert it to one of .ply"));
  EXPECT_THAT(error("m.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n"), says("m.obj", "cannot be read", "export"));
  EXPECT_THAT(error("m.obj", "v 0 0 0\nv nan 0 0\nv 0 1 0\nf 1 2 3\n"), says("m.obj", "not finite", "repair"));
  EXPECT_THAT(error("m.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\n"), says("m.obj", "", "export"));
  EXPECT_THAT(error("m.glb", "glTF nonsense"), says("m.glb", "cannot be read", "export"));
  TempFolder folder;
  EXPECT_THAT(input_error([&] { read_mesh(folder / "none.ply"); }),
              says("none.ply", "no such file", "correct the name"));
  EXPECT_THAT(input_error([&] { read_mesh(folder / "none.obj"); }),
              says("none.obj", "no such file", "correct the name"));
  std::filesystem::create_directory(folder / "dir.ply");
  EXPECT_THAT(input_error([&] { read_mesh(folder / "dir.ply"); }),
              says("dir.ply", "not a regular file", "name a file"));
}

}  // namespace
}  // namespace foresight::mesh_reader_test
