// Mutated inputs: a reader either succeeds or throws InputError; it never throws anything else and
// never crashes. Each run is the same; FORESIGHT_FUZZ_RUNS (default 300) makes it longer, and the
// sanitizer presets make it sharper.
#include <random>

#include "scene/camera_info.hpp"
#include "scene/mesh_reader.hpp"
#include "scene/run_folder.hpp"
#include "scene/scene_reader.hpp"
#include "scene/urdf_reader.hpp"
#include "test_run.hpp"

namespace foresight::fuzz_test {
namespace {

int fuzz_runs() {
  const char* set = std::getenv("FORESIGHT_FUZZ_RUNS");
  return set ? std::atoi(set) : 300;
}

class Mutator {
 public:
  explicit Mutator(unsigned seed) : random_(seed) {}

  std::string operator()(std::string text) {
    for (std::size_t n = 1 + pick(4); n > 0; --n) mutate_once(text);
    return text;
  }

 private:
  std::size_t pick(std::size_t count) { return count == 0 ? 0 : random_() % count; }

  void mutate_once(std::string& text) {
    static const std::vector<std::string> kTokens = {"nan",
                                                     "-1",
                                                     "0",
                                                     "1e999",
                                                     "4294967295",
                                                     "99999999999999999999",
                                                     "-",
                                                     "{",
                                                     "}",
                                                     "[",
                                                     "]",
                                                     ":",
                                                     "\n",
                                                     "\r\n",
                                                     "#",
                                                     "\t",
                                                     "../",
                                                     "/",
                                                     "&a",
                                                     "*a",
                                                     "!!",
                                                     "'",
                                                     "\"",
                                                     "<",
                                                     ">",
                                                     "/>",
                                                     "|",
                                                     "---\n",
                                                     "\xFF\xD9",
                                                     "\xFF",
                                                     "end_header\n",
                                                     " "};
    const std::size_t at = pick(text.size());
    switch (pick(8)) {
      case 0:
        if (!text.empty()) text[at] = static_cast<char>(text[at] ^ (1 << pick(8)));
        break;
      case 1:
        if (!text.empty()) text[at] = static_cast<char>(random_());
        break;
      case 2: text.resize(at); break;
      case 3: text.erase(at, 1 + pick(16)); break;
      case 4: text.insert(at, kTokens[pick(kTokens.size())]); break;
      case 5: text.insert(pick(text.size()), text.substr(at, 1 + pick(64))); break;
      case 6: replace_number(text, at); break;
      case 7: std::swap(text[at], text[pick(text.size())]); break;
    }
  }

  void replace_number(std::string& text, std::size_t at) {
    static const std::vector<std::string> kNumbers = {"nan",    "inf",        "-1",   "0", "1e308",
                                                      "1e-320", "2147483648", "1e20", "x"};
    const std::size_t begin = text.find_first_of("0123456789", at);
    if (begin == std::string::npos) return;
    const std::size_t end = std::min(text.find_first_not_of("0123456789.", begin), text.size());
    text.replace(begin, end - begin, kNumbers[pick(kNumbers.size())]);
  }

  std::mt19937 random_;
};

// Counts how often each outcome came, so that a fuzz run that reaches nothing is seen.
template <typename Read>
void fuzz(const std::string& seed_text, unsigned seed, Read&& read) {
  ASSERT_EQ(input_error([&] { read(seed_text); }), "no error") << "the seed itself must be good";
  Mutator mutate(seed);
  int refused = 0;
  const int runs = fuzz_runs();
  for (int i = 0; i < runs; ++i) {
    const std::string text = mutate(seed_text);
    try {
      read(text);
    } catch (const InputError& error) {
      ++refused;
      EXPECT_THAT(error.what(), testing::HasSubstr("; "));
    } catch (const std::exception& error) {
      ADD_FAILURE() << "run " << i << " threw " << error.what() << " for:\n" << text.substr(0, 2000);
    }
  }
  EXPECT_GT(refused, runs / 20) << "the mutations are too weak";
}

void fuzz_file(TempFolder& folder, const std::string& name, const std::string& seed_text, unsigned seed,
               const std::function<void(const std::filesystem::path&)>& read) {
  fuzz(seed_text, seed, [&](const std::string& text) { read(folder.write(name, text)); });
}

void fuzz_mesh(const std::string& name, const std::string& seed_text, unsigned seed) {
  TempFolder folder;
  fuzz_file(folder, name, seed_text, seed, [](const auto& file) { read_mesh(file); });
}

template <typename T>
void append(std::string& out, T value) {
  out.append(reinterpret_cast<const char*>(&value), sizeof value);
}

TEST(Fuzz, CameraInfo) {
  TempFolder folder;
  fuzz_file(folder, "camera.yaml", kCamera + "T_left_right: {xyz: [0, 1, 2], quaternion: [0, 0, 0, 1]}\n", 1,
            [](const auto& file) { read_camera_info(file); });
}

TEST(Fuzz, RunLists) {
  unsigned seed = 10;
  for (const char* name : {"rgb.txt", "trajectory.txt", "nodes.txt", "rgb_right.txt"}) {
    TestRun run;
    run.write("camera_right.yaml", kCamera + "T_left_right: {xyz: [0.1, 0, 0]}\n");
    run.write("rgb_right.txt", run.read("rgb.txt"));
    run.write("nodes.txt", "1700000000.0 scene 1 0 0 0 0 0 1\n1700000000.1 scene 2 0 0 0 0 0 1\n");
    fuzz_file(run, name, run.read(name), seed++, [&](const auto&) {
      const RunFolder folder = RunFolder::open(run.path(), {});
      folder.state_at(folder.frames()[0].left.time);
    });
  }
}

TEST(Fuzz, AsciiPly) {
  fuzz_mesh("m.ply", kTriangle, 20);
}

TEST(Fuzz, BinaryPly) {
  std::string ply =
      "ply\nformat binary_little_endian 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
      "property uchar red\nelement face 2\nproperty list uchar int vertex_indices\nend_header\n";
  for (const auto& v : {std::array{0.f, 0.f, 1.f}, {1.f, 0.f, 1.f}, {1.f, 1.f, 1.f}, {0.f, 1.f, 1.f}}) {
    for (float f : v) append(ply, f);
    append<std::uint8_t>(ply, 9);
  }
  for (const auto& f : {std::array{0, 1, 2}, {0, 2, 3}}) {
    append<std::uint8_t>(ply, 3);
    for (std::int32_t i : f) append(ply, i);
  }
  fuzz_mesh("m.ply", ply, 21);
}

TEST(Fuzz, Obj) {
  fuzz_mesh("m.obj", "o a\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvn 0 0 1\nvt 0 1\nf 1/1/1 2/1/1 3/1/1\nf 1 3 4\n", 22);
}

TEST(Fuzz, AsciiStl) {
  fuzz_mesh("m.stl",
            "solid s\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 "
            "0\nendloop\nendfacet\nendsolid s\n",
            23);
}

TEST(Fuzz, BinaryStl) {
  std::string stl(80, ' ');
  append<std::uint32_t>(stl, 2);
  for (int i = 0; i < 2; ++i) {
    for (float f : {0, 0, 1, 0, 0, 0, 2, 0, 0, 0, 2, 0}) append(stl, f);
    append<std::uint16_t>(stl, 0);
  }
  fuzz_mesh("m.stl", stl, 24);
}

TEST(Fuzz, Gltf) {
  fuzz_mesh("m.gltf", R"({"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}],
 "nodes": [{"mesh": 0, "scale": [2, 2, 2], "translation": [10, 0, 0]}],
 "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
 "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3", "min": [0, 0, 0], "max": [1, 1, 0]}],
 "bufferViews": [{"buffer": 0, "byteLength": 36}],
 "buffers": [{"uri": "data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA", "byteLength": 36}]})",
            25);
}

TEST(Fuzz, Collada) {
  fuzz_mesh("m.dae",
            R"(<?xml version="1.0"?><COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
<asset><unit meter="1"/><up_axis>Z_UP</up_axis></asset><library_geometries><geometry id="g"><mesh>
<source id="p"><float_array id="a" count="9">0 0 0 1 0 0 0 1 0</float_array><technique_common>
<accessor source="#a" count="3" stride="3"><param name="X" type="float"/><param name="Y" type="float"/><param name="Z" type="float"/>
</accessor></technique_common></source><vertices id="v"><input semantic="POSITION" source="#p"/></vertices>
<triangles count="1"><input semantic="VERTEX" source="#v" offset="0"/><p>0 1 2</p></triangles>
<polylist count="2"><input semantic="VERTEX" source="#v" offset="0"/><vcount>3 3</vcount><p>0 1 2 2 1 0</p></polylist>
<polygons count="2"><input semantic="VERTEX" source="#v" offset="0"/><p>0 1 2</p><p>0 2 1</p></polygons></mesh></geometry></library_geometries>
<library_visual_scenes><visual_scene id="s"><node id="n"><instance_geometry url="#g"/></node></visual_scene></library_visual_scenes>
<scene><instance_visual_scene url="#s"/></scene></COLLADA>)",
            26);
}

TEST(Fuzz, SceneYaml) {
  TempFolder folder;
  folder.write("table.ply", kTriangle);
  fuzz_file(folder, "scene.yaml",
            "nodes:\n  - name: table\n    mesh: table.ply\n    parent: world\n    pose: {xyz: [1, 2, 3]}\n"
            "  - {name: cup, parent: table, pose: {quaternion: [0, 0, 0, 1]}}\n",
            30, [&](const auto& file) { read_scene(file, folder.path()); });
}

TEST(Fuzz, Urdf) {
  TempFolder folder;
  fuzz_file(folder, "r.urdf", R"(<?xml version="1.0"?><robot name="r">
<link name="base"><visual><origin xyz="0 0 1" rpy="0 1 0"/><geometry><box size="1 2 3"/></geometry></visual></link>
<link name="a"><visual><geometry><cylinder radius="1" length="2"/></geometry></visual></link>
<link name="b"><visual><geometry><sphere radius="1"/></geometry></visual></link>
<joint name="j" type="revolute"><parent link="base"/><child link="a"/><origin xyz="0 0 1"/><axis xyz="0 0 1"/>
<limit lower="-1" upper="1" effort="1" velocity="1"/></joint>
<joint name="k" type="prismatic"><parent link="a"/><child link="b"/><axis xyz="1 0 0"/>
<limit lower="-1" upper="1" effort="1" velocity="1"/><mimic joint="j" multiplier="2" offset="0.1"/></joint></robot>)",
            31, [&](const auto& file) {
              UrdfRobot robot = read_urdf(file, folder.path());
              pose_links(robot, {}, "here");
            });
}

// Whatever happens to a URDF, each of its links has its shape, or the file is refused.
TEST(Fuzz, NoShapeOfAUrdfIsLost) {
  const std::string whole = R"(<robot name="r">
<link name="base"><collision><geometry><box size="1 2 3"/></geometry></collision></link>
<link name="a"><collision><origin xyz="0 0 1" rpy="0 1 0"/><geometry><cylinder radius="0.1" length="2"/></geometry></collision></link>
<link name="b"><visual><geometry><sphere radius="0.5"/></geometry></visual></link>
<joint name="j" type="fixed"><parent link="base"/><child link="a"/></joint>
<joint name="k" type="fixed"><parent link="a"/><child link="b"/></joint></robot>)";
  TempFolder folder;
  std::mt19937 random(36);
  int read = 0;
  const int runs = 2 * fuzz_runs();
  for (int i = 0; i < runs; ++i) {
    std::string text = whole;
    const std::size_t at = random() % text.size();
    const char letter = "0123456789.,-+ \t\"'/<>=!?abcdenxyz&"[random() % 35];
    switch (random() % 3) {
      case 0: text[at] = letter; break;
      case 1: text.insert(at, 1, letter); break;
      default: text.erase(at, 1);
    }
    const auto file = folder.write("r.urdf", text);
    try {
      const UrdfRobot robot = read_urdf(file, folder.path(), UrdfShapes::all);
      ++read;
      ASSERT_EQ(robot.links.size(), 3u) << text;
      for (std::size_t link = 0; link < 3; ++link) ASSERT_FALSE(robot.body(link).vertices.empty()) << text;
    } catch (const InputError&) {
    }
  }
  EXPECT_GT(read, runs / 50) << "some changes are harmless";
  EXPECT_LT(read, runs / 2);
}

TEST(Fuzz, Images) {
  const Lens lens(Lens::Parameters{LensModel::plumb_bob, 8, 6, 10, 10, 3.5, 2.5, {}});
  unsigned seed = 40;
  for (const char* extension : {".png", ".jpg"}) {
    TempFolder folder;
    fuzz_file(folder, std::string("i") + extension, encoded(extension, test_pixels()), seed++, [&](const auto& file) {
      RunImage image;
      image.file = file;
      const cv::Mat pixels = read_run_image(image, lens);
      EXPECT_EQ(pixels.size(), cv::Size(8, 6));
    });
  }
}

}  // namespace
}  // namespace foresight::fuzz_test
