// What is wrong with a run or an option ends the program with exit code 2, a last line on stderr
// that names the place, the fault and the cure, and nothing written.
#include <functional>

#include "tests/apps/program.hpp"
#include "tests/scene/test_run.hpp"

namespace foresight::bad_input_test {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

/// A run of three images with a moving node and a second camera, which a case then damages.
class StereoRun : public TestRun {
 public:
  StereoRun() {
    fs::remove(*this / "scene.ply");
    write("mesh.ply", kTriangle);
    write("scene.yaml",
          "nodes:\n  - {name: table, mesh: mesh.ply}\n  - {name: plate, parent: table, mesh: mesh.ply}\n");
    write("nodes.txt", "1700000000.0 plate 0 0 0 0 0 0 1\n1700000000.1 plate 0 0 1 0 0 0 1\n");
    write("camera_right.yaml", kCamera + "T_left_right: {xyz: [0.06, 0, 0], quaternion: [0, 0, 0, 1]}\n");
    write("rgb_right.txt", "1700000000.0 right/a.png\n1700000000.1 right/b.png\n");
    write("right/a.png", encoded(".png", test_pixels()));
    write("right/b.png", encoded(".png", test_pixels()));
  }

  /// Replaces the only `old_text` in `name`.
  void edit(const std::string& name, const std::string& old_text, const std::string& new_text) const {
    std::string content = read(name);
    const std::size_t at = content.find(old_text);
    if (at == std::string::npos) throw std::logic_error(name + " holds no " + old_text);
    write(name, content.replace(at, old_text.size(), new_text));
  }
  void cut(const std::string& name, std::size_t bytes) const { write(name, read(name).substr(0, bytes)); }
};

struct Case {
  const char* name;
  std::function<void(StereoRun&)> damage;
  std::vector<std::string> arguments;
  const char *where, *what, *cure;
};

void nothing(StereoRun&) {}

void one_image(StereoRun& run) {
  run.write("rgb.txt", "1700000000.0 rgb/a.png\n");
  run.write("rgb_right.txt", "1700000000.0 right/a.png\n");
}

std::function<void(StereoRun&)> edited(std::string file, std::string old_text, std::string new_text) {
  return [=](StereoRun& run) { run.edit(file, old_text, new_text); };
}
std::function<void(StereoRun&)> replaced(std::string file, std::string content) {
  return [=](StereoRun& run) { run.write(file, content); };
}

const std::string kPlyHead =
    "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n";

const std::vector<Case>& cases() {
  static const std::vector<Case> all = {
      // Images.
      {"missing image", [](StereoRun& r) { fs::remove(r / "rgb/b.png"); }, {}, "rgb.txt:3", "b.png is missing", "put it there"},
      {"truncated PNG", [](StereoRun& r) { r.cut("rgb/b.png", 60); }, {}, "rgb/b.png", "", "copy"},
      {"PNG cut by its last byte", [](StereoRun& r) { r.cut("rgb/b.png", r.read("rgb/b.png").size() - 1); }, {}, "rgb/b.png", "", "copy"},
      {"truncated JPEG", [](StereoRun& r) { r.cut("rgb/c.jpg", r.read("rgb/c.jpg").size() - 20); }, {}, "rgb/c.jpg", "", "copy"},
      {"empty image", replaced("rgb/a.png", ""), {}, "rgb/a.png", "", ""},
      {"no image at all", replaced("rgb/a.png", "hello"), {}, "rgb/a.png", "", ""},
      {"16-bit image", replaced("rgb/a.png", encoded(".png", cv::Mat(6, 8, CV_16UC1, cv::Scalar(99)))), {}, "rgb/a.png", "16 bits", "convert it to 8-bit"},
      {"image with alpha", replaced("rgb/a.png", encoded(".png", cv::Mat(6, 8, CV_8UC4, cv::Scalar(9, 9, 9, 9)))), {}, "rgb/a.png", "alpha", "convert it to 8-bit"},
      {"another image size", replaced("rgb/a.png", encoded(".png", cv::Mat(8, 6, CV_8UC3, cv::Scalar(9)))), {}, "rgb/a.png", "6x8", "correct image_width and image_height"},
      {"bad right image", [](StereoRun& r) { r.cut("right/b.png", 60); }, {}, "right/b.png", "", "copy"},
      // The camera.
      {"no camera.yaml", [](StereoRun& r) { fs::remove(r / "camera.yaml"); }, {}, "camera.yaml", "is missing", "add what is missing"},
      {"unknown distortion model", edited("camera.yaml", "plumb_bob", "plum_bob"), {}, "distortion_model", "plum_bob", "did you mean 'plumb_bob'"},
      {"focal length 0", edited("camera.yaml", "[10,", "[0,"), {}, "camera_matrix", "must be positive", "calibrate"},
      {"K all 0", edited("camera.yaml", "[10, 0, 3.5, 0, 11, 2.5, 0, 0, 1]", "[0, 0, 0, 0, 0, 0, 0, 0, 0]"), {}, "camera_matrix", "", ""},
      {"K with NaN", edited("camera.yaml", "[10,", "[.nan,"), {}, "camera_matrix", "", ""},
      {"K with infinity", edited("camera.yaml", "3.5,", ".inf,"), {}, "camera_matrix", "", ""},
      {"distortion with NaN", edited("camera.yaml", "[0.1,", "[.nan,"), {}, "distortion_coefficients", "", ""},
      {"image size 0", edited("camera.yaml", "image_width: 8", "image_width: 0"), {}, "camera.yaml", "", ""},
      {"right camera without its pose", replaced("camera_right.yaml", kCamera), {}, "T_left_right", "is missing", "add T_left_right"},
      {"right camera without images", [](StereoRun& r) { fs::remove(r / "rgb_right.txt"); }, {}, "rgb_right.txt", "is missing", "add"},
      // Times and poses.
      {"NaN in a pose", edited("trajectory.txt", "1700000000.1 1", "1700000000.1 nan"), {}, "trajectory.txt:2", "nan", ""},
      {"infinity in a pose", edited("trajectory.txt", "1700000000.1 1", "1700000000.1 inf"), {}, "trajectory.txt:2", "inf", ""},
      {"NaN as a time", edited("trajectory.txt", "1700000000.1", "nan"), {}, "trajectory.txt:2", "nan", ""},
      {"long quaternion", edited("trajectory.txt", "1 0 0 0 0 0 1", "1 0 0 0 0 0 1.0011"), {}, "trajectory.txt:2", "quaternion", ""},
      {"unsorted poses", edited("trajectory.txt", "1700000000.1", "1600000000.1"), {}, "trajectory.txt:2", "", "sort"},
      {"two poses at a time", edited("trajectory.txt", "1700000000.1", "1700000000.0"), {}, "trajectory.txt:2", "", ""},
      {"pose without its end", edited("trajectory.txt", "2 0 0 0 0 0 1", "2 0 0"), {}, "trajectory.txt:3", "", ""},
      {"NaN as an image time", edited("rgb.txt", "1700000000.1", "nan"), {}, "rgb.txt:3", "nan", ""},
      {"unsorted images", edited("rgb.txt", "1700000000.1", "1600000000.1"), {}, "rgb.txt:3", "", "sort"},
      {"two images at a time", edited("rgb.txt", "1700000000.1", "1700000000.000000001"), {}, "rgb.txt:3", "", ""},
      {"two right images at a time", edited("rgb_right.txt", "1700000000.1", "1700000000.0"), {}, "rgb_right.txt:2", "", ""},
      {"no pose for an image", edited("rgb.txt", "1700000000.2", "1700000000.41"), {}, "rgb.txt:4", "no pose", "add poses"},
      {"gap of poses above 0.2 s", replaced("trajectory.txt", "1700000000.0 0 0 0 0 0 0 1\n1700000000.21 1 0 0 0 0 0 1\n"), {}, "rgb.txt:3", "no pose", "add poses"},
      {"no images", replaced("rgb.txt", "# none\n"), {}, "rgb.txt", "", ""},
      {"no poses", replaced("trajectory.txt", ""), {}, "trajectory.txt", "", ""},
      // Paths.
      {"path out of the run", edited("rgb.txt", "rgb/b.png", "../b.png"), {}, "rgb.txt:3", "leaves", "copy the file"},
      {"absolute path", edited("rgb.txt", "rgb/b.png", "/etc/passwd"), {}, "rgb.txt:3", "is absolute", "write it relative"},
      {"link out of the run", [](StereoRun& r) { fs::remove(r / "rgb/b.png"); fs::create_symlink("/etc/passwd", r / "rgb/b.png"); }, {}, "rgb.txt:3", "leaves", "copy the file"},
      {"mesh out of the run", edited("scene.yaml", "mesh.ply", "../mesh.ply"), {}, "scene.yaml", "leaves", "copy the file"},
      // The model.
      {"no model", [](StereoRun& r) { fs::remove(r / "scene.yaml"); }, {}, "scene.ply", "is missing", "add one of the two"},
      {"two models", [](StereoRun& r) { r.write("scene.ply", kTriangle); }, {}, "holds scene.ply and scene.yaml", "", "remove one"},
      {"mesh without faces", replaced("mesh.ply", kPlyHead + "end_header\n0 0 1\n1 0 1\n0 1 1\n"), {}, "mesh.ply", "has no faces", "export"},
      {"mesh with NaN", replaced("mesh.ply", kPlyHead + "element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 1\nnan 0 1\n0 1 1\n3 0 1 2\n"), {}, "mesh.ply", "not finite", "repair"},
      {"index out of range", replaced("mesh.ply", kPlyHead + "element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 1\n1 0 1\n0 1 1\n3 0 1 3\n"), {}, "mesh.ply", "out of range", "export"},
      {"negative index", replaced("mesh.ply", kPlyHead + "element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 1\n1 0 1\n0 1 1\n3 0 1 -1\n"), {}, "mesh.ply", "out of range", "export"},
      {"only degenerate triangles", replaced("mesh.ply", kPlyHead + "element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 1\n1 0 1\n0 1 1\n3 0 1 1\n"), {}, "", "", ""},
      {"truncated mesh", [](StereoRun& r) { r.cut("mesh.ply", r.read("mesh.ply").size() - 5); }, {}, "mesh.ply", "ends before", "export"},
      {"unknown node", edited("nodes.txt", "00.1 plate", "00.1 plato"), {}, "nodes.txt:2", "plato", "did you mean 'plate'"},
      {"unknown parent", edited("scene.yaml", "parent: table", "parent: tabel"), {}, "scene.yaml", "tabel", "did you mean 'table'"},
      {"unknown key", edited("scene.yaml", "parent:", "parnt:"), {}, "scene.yaml", "parnt", "parent"},
      {"NaN in a node's pose", edited("nodes.txt", "00.1 plate 0 0 1", "00.1 plate 0 0 nan"), {}, "nodes.txt:2", "nan", ""},
      {"unsorted node poses", edited("nodes.txt", "1700000000.1", "1600000000.1"), {}, "nodes.txt:2", "", "sort"},
      {"missing --scene", nothing, {"--scene", "/nowhere/model.ply"}, "/nowhere/model.ply", "no such file", "correct the name"},
      {"damaged --scene", replaced("other.ply", "ply\n"), {"--scene", "RUN/other.ply"}, "other.ply", "", ""},
      // Delays.
      {"negative delay in images", nothing, {"--delay-frames", "-1"}, "--delay-frames", "'-1'", "from 0"},
      {"negative delay in time", nothing, {"--delay-ms", "-0.5"}, "--delay-ms", "'-0.5'", "from 0"},
      {"NaN delay", nothing, {"--delay-ms", "nan"}, "--delay-ms", "'nan'", "give one"},
      {"both delays", nothing, {"--delay-ms", "10", "--delay-frames", "1"}, "--delay-ms", "stands beside --delay-frames", "give one of the two"},
      {"both delays, both 0", nothing, {"--delay-ms", "0", "--delay-frames", "0"}, "--delay-ms", "stands beside --delay-frames", "give one of the two"},
      {"too many images of delay", nothing, {"--delay-frames", "3"}, "--delay-frames", "longer than the run", "at most 2"},
      {"too much time of delay", nothing, {"--delay-ms", "201"}, "--delay-ms", "longer than the run", "at most 199.9"},
      {"a delay of the only image", one_image, {"--delay-ms", "30"}, "--delay-ms", "one image", "give 0"},
      // Other options.
      {"margin out of range", nothing, {"--margin-px", "-1"}, "--margin-px", "'-1'", "from 0 to 32"},
      {"density out of range", nothing, {"--texels-per-metre", "0"}, "--texels-per-metre", "'0'", "from 1"},
      {"no texture memory", nothing, {"--texture-memory-mb", "0"}, "--texture-memory-mb", "'0'", "from 1"},
      {"texture too small", nothing, {"--max-texture", "8"}, "--max-texture", "'8'", "from 16"},
      {"unknown option", nothing, {"--delay", "3"}, "option '--delay'", "did you mean '--delay-", "foresight replay --help"},
      {"option without value", nothing, {"--delay-ms"}, "--delay-ms", "", "foresight replay --help"},
  };
  return all;
}

/// All outputs go into a folder of their own, which must stay empty.
class BadInput : public testing::Test {
 protected:
  Outcome replay(const fs::path& run, std::vector<std::string> more) const {
    std::vector<std::string> arguments{
        "replay", run, "--out", out_ / "out", "--report", out_ / "a/report.json", "--html", out_ / "report.html"};
    for (std::string& argument : more) {
      if (argument.starts_with("RUN/")) argument = run / argument.substr(4);
      arguments.push_back(argument);
    }
    return run_program(arguments);
  }

  TempFolder out_;
};

TEST_F(BadInput, EndsWithCode2TheReasonAndNoOutput) {
  for (const Case& bad : cases()) {
    SCOPED_TRACE(bad.name);
    StereoRun run;
    bad.damage(run);
    const Outcome outcome = replay(run.path(), bad.arguments);
    EXPECT_EQ(outcome.exit_code, 2);
    EXPECT_THAT(outcome.last_line(), testing::StartsWith("foresight: "));
    EXPECT_THAT(outcome.last_line(), says(bad.where, bad.what, bad.cure));
    EXPECT_TRUE(fs::is_empty(out_.path()));
    if (std::getenv("FORESIGHT_SHOW_MESSAGES")) std::printf("%-30s %s\n", bad.name, outcome.last_line().c_str());
  }
}

TEST_F(BadInput, OutputsThatCannotBeWrittenAreRefused) {
  const StereoRun run;
  out_.write("file", "kept");
  fs::create_directories(out_ / "folder/predicted");
  fs::create_directories(out_ / "sheet/contact_sheet.png");
  const std::string file = out_ / "file", folder = out_ / "folder", sheet = out_ / "sheet", picture = run / "rgb/a.png";
  const std::vector<std::pair<std::vector<std::string>, std::string>> all = {
      {{"--out", file}, file},
      {{"--out", file + "/below"}, file},
      {{"--out", "/proc/foresight"}, "/proc"},
      {{"--out", folder + "/" + std::string(300, 'x')}, "File name too long"},
      {{"--out", sheet}, "contact_sheet.png"},
      {{"--report", file + "/report.json"}, file},
      {{"--report", folder}, folder},
      {{"--report", "/proc/report.json"}, "/proc"},
      {{"--html", file + "/report.html"}, file},
      {{"--html", folder + "/"}, folder},
      {{"--html", folder + "/x", "--report", folder + "/x"}, "--report"},
      {{"--report", picture}, "would overwrite"},
      {{"--html", run / "scene.yaml"}, "would overwrite"},
  };
  for (const auto& [arguments, what] : all) {
    SCOPED_TRACE(testing::PrintToString(arguments));
    std::vector<std::string> words{"replay", run.path()};
    words.insert(words.end(), arguments.begin(), arguments.end());
    const Outcome outcome = run_program(words);
    EXPECT_EQ(outcome.exit_code, 2);
    EXPECT_THAT(outcome.last_line(), says(arguments[0], what, "give"));
    EXPECT_EQ(out_.read("file"), "kept");
    EXPECT_TRUE(fs::is_empty(out_ / "folder/predicted"));
    EXPECT_EQ(std::distance(fs::directory_iterator(out_ / "folder"), {}), 1);
  }
}

TEST_F(BadInput, WithoutARunNothingHappens) {
  const Outcome outcome = replay(out_ / "no_run", {});
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_THAT(outcome.last_line(), says("no_run", "no such folder", "give the path"));
  const Outcome file = replay(out_.write("file", ""), {});
  EXPECT_EQ(file.exit_code, 2);
  EXPECT_THAT(file.last_line(), says("file", "is not a folder", "give the folder"));
}

}  // namespace
}  // namespace foresight::bad_input_test
