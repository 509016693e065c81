// The check of all outputs, option by option, on real files and links.
#include "apps/command_line/output_guard.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>

#include "apps/command_line/inputs.hpp"
#include "apps/command_line/named_files.hpp"
#include "tests/scene/test_run.hpp"

namespace foresight::output_guard_test {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using Kind = Output::Kind;

constexpr const char* kOurNumbers = "{\n  \"generator\": \"foresight\"\n}\n";

GivenPath reads(const std::string& option, const fs::path& word) {
  return {option, word.string(), {}};
}
GivenPath writes(const std::string& option, const fs::path& word, const FileForm& form = numbers_form()) {
  return {option, word.string(), [form](const fs::path& file) -> std::vector<Output> {
            return {{file, Kind::file, form}};
          }};
}
GivenPath folder(const std::string& option, const fs::path& word, Kind kind) {
  return {option, word.string(), [kind](const fs::path& path) -> std::vector<Output> { return {{path, kind}}; }};
}

std::string refusal(const std::vector<GivenPath>& given) {
  return input_error([&] { OutputGuard guard(given); });
}

class OutputGuardTest : public testing::Test {
 protected:
  OutputGuardTest() {
    files_.write("in/rig.yaml", "name: x\nrobot: {urdf: robot/arm.urdf}\nlens: 'my lens.yaml'\n");
    files_.write("in/robot/arm.urdf", "<robot><mesh filename=\"package://arm/meshes/link.stl\"/></robot>");
    files_.write("in/meshes/link.stl", "solid");
    files_.write("in/my lens.yaml", "camera_matrix: []");
    files_.write("run/rgb/a.png", "png");
  }
  fs::path at(const std::string& name) const { return files_ / name; }

  TempFolder files_;
};

TEST_F(OutputGuardTest, NewOutputsAreAllowedAndNothingIsMade) {
  const std::vector<GivenPath> given{reads("RUN", at("run")), writes("--json", at("new/deep/a.json")),
                                     folder("--out", at("out"), Kind::replaced_folder)};
  const auto before = std::distance(fs::recursive_directory_iterator(files_.path()), {});
  EXPECT_EQ(refusal(given), "no error");
  EXPECT_EQ(std::distance(fs::recursive_directory_iterator(files_.path()), {}), before);
}

TEST_F(OutputGuardTest, AnInputIsNeverAnOutputUnderWhateverName) {
  fs::create_symlink(at("in/rig.yaml"), at("link.json"));
  fs::create_symlink(at("in"), at("same"));
  fs::create_hard_link(at("in/rig.yaml"), at("hard.json"));
  for (const fs::path& name :
       {at("in/rig.yaml"), at("in/../in/./rig.yaml"), at("link.json"), at("same/rig.yaml"), at("hard.json")})
    EXPECT_THAT(refusal({reads("RIG", at("in/rig.yaml")), writes("--json", name)}),
                says("--json " + name.string(), "would overwrite", "give another place"));
  EXPECT_THAT(refusal({reads("--images", at("run/rgb/*.png")), writes("--out", at("run/rgb/a.png"), png_form())}),
              HasSubstr("would overwrite"));
  EXPECT_THAT(refusal({reads("--eds", "12=" + at("in/rig.yaml").string()), writes("--log", at("in/rig.yaml"))}),
              HasSubstr("would overwrite"));
  EXPECT_EQ(files_.read("in/rig.yaml").substr(0, 7), "name: x");
}

TEST_F(OutputGuardTest, WhatInputsNameAreInputs) {
  for (const char* name : {"in/robot/arm.urdf", "in/meshes/link.stl", "in/my lens.yaml"})
    EXPECT_THAT(refusal({reads("RIG", at("in/rig.yaml")), writes("--json", at(name))}), HasSubstr("would overwrite"))
        << name;
  EXPECT_EQ(with_named_files(at("in/rig.yaml")).size(), 4U);
  EXPECT_EQ(with_named_files(at("absent")).size(), 1U);
}

TEST_F(OutputGuardTest, AFolderOfInputsIsKeptButForOurOwnReports) {
  EXPECT_THAT(refusal({reads("RUN", at("run")), writes("--png", at("run/rgb/a.png"), png_form())}),
              HasSubstr("would overwrite"));
  EXPECT_THAT(refusal({reads("RUN", at("run")), folder("--out", at("run"), Kind::folder)}), HasSubstr("the folder of"));
  EXPECT_THAT(refusal({reads("RUN", at("run/rgb")), folder("--out", at("run"), Kind::replaced_folder)}),
              HasSubstr("the folder of"));
  files_.write("run/report.json", kOurNumbers);
  EXPECT_EQ(refusal({reads("RUN", at("run")), writes("--json", at("run/report.json"))}), "no error");
  EXPECT_EQ(refusal({reads("RUN", at("run")), folder("--out", at("run/new"), Kind::folder)}), "no error");
}

TEST_F(OutputGuardTest, TwoOutputsHaveTwoPlaces) {
  fs::create_symlink(files_.path(), at("again"));
  EXPECT_THAT(refusal({writes("--json", at("x")), writes("--html", at("./again/x"))}),
              says("--html", "is the file of --json", "its own name"));
  EXPECT_THAT(refusal({folder("--record", at("run2"), Kind::replaced_folder), writes("--log", at("run2/can.log"))}),
              says("--log", "--record", "a folder of its own"));
  EXPECT_EQ(refusal({folder("--out", at("out"), Kind::folder), writes("--html", at("out/r.html"))}), "no error");
  EXPECT_EQ(refusal({writes("--json", "/dev/null"), writes("--html", "/dev/null")}), "no error");
}

TEST_F(OutputGuardTest, ForeignFilesStay) {
  files_.write("mine.json", R"({"mine": 1})");
  files_.write("notes.txt", "precious");
  files_.write("ours.json", kOurNumbers);
  files_.write("empty", "");
  EXPECT_THAT(refusal({writes("--json", at("mine.json"))}),
              says("--json", "exists and is not a file of numbers", "remove"));
  for (const FileForm& form : {numbers_form(), page_form(), result_form(), camera_info_form(), can_log_form(),
                               joint_log_form(), board_form(), model_form(), png_form(), svg_form()}) {
    EXPECT_THAT(refusal({writes("--out", at("notes.txt"), form)}), HasSubstr("exists and is not " + form.name));
    EXPECT_EQ(refusal({writes("--out", at("empty"), form)}), "no error");
  }
  EXPECT_EQ(refusal({writes("--json", at("ours.json"))}), "no error");
  fs::permissions(at("ours.json"), fs::perms::owner_read);
  EXPECT_THAT(refusal({writes("--json", at("ours.json"))}), HasSubstr("write-protected"));
}

TEST_F(OutputGuardTest, WhatIsToBeNewReplacesNothing) {
  files_.write("notes.txt", "precious");
  const auto fresh = [&](const std::string& name, Kind kind) -> std::vector<GivenPath> {
    return {{"--out", at(name).string(),
             [kind](const fs::path& path) -> std::vector<Output> { return {new_output(path, kind)}; }}};
  };
  EXPECT_THAT(refusal(fresh("notes.txt", Kind::file)), says("--out", "is there already", "another name"));
  EXPECT_THAT(refusal(fresh("run", Kind::folder)), HasSubstr("is there already"));
  fs::create_directory(at("empty"));
  EXPECT_EQ(refusal(fresh("empty", Kind::folder)), "no error");
  EXPECT_EQ(refusal(fresh("new", Kind::file)), "no error");
}

TEST_F(OutputGuardTest, APartBelongsToItsWhole) {
  files_.write("m.png", "a holiday");
  const auto part = part_form(at("m.gltf"), model_form());
  EXPECT_THAT(refusal({writes("--out", at("m.png"), part)}), HasSubstr("not a part of m.gltf"));
  files_.write("m.gltf", R"({"asset":{"generator":"Foresight 1","version":"2.0"}})");
  EXPECT_EQ(refusal({writes("--out", at("m.png"), part)}), "no error");
}

TEST_F(OutputGuardTest, PlacesThatCannotBeWrittenAreNamed) {
  files_.write("file", "x");
  ASSERT_EQ(::mkfifo(at("pipe").c_str(), 0600), 0);
  const std::vector<std::pair<GivenPath, std::string>> all = {
      {writes("--json", ""), "is an empty name"},
      {reads("RIG", ""), "is an empty name"},
      {writes("--json", "-"), "--json -: would be a file that is called '-'"},
      {writes("--json", at("in")), "this is a folder"},
      {writes("--json", at("new") / ""), "this is a folder"},
      {writes("--json", at("file/below")), "cannot be written to"},
      {writes("--json", "/proc/a.json"), "cannot be written to"},
      {writes("--json", at(std::string(300, 'x'))), "File name too long"},
      {writes("--json", at("pipe")), "nobody reads"},
      {folder("--out", at("file"), Kind::folder), "is not a folder"},
      {folder("--out", at("pipe"), Kind::replaced_folder), "is not a folder"},
      {folder("--out", "/proc/new", Kind::replaced_folder), "cannot be written to"},
  };
  for (const auto& [given, what] : all) EXPECT_THAT(refusal({given}), HasSubstr(what)) << given.word;
  const UniqueFd reader(::open(at("pipe").c_str(), O_RDONLY | O_NONBLOCK));
  const OutputGuard guard({writes("--json", at("pipe"))});
  char byte = 0;
  EXPECT_EQ(::read(reader.get(), &byte, 1), -1) << "not its end, which would send the reader away";
  EXPECT_EQ(errno, EAGAIN);
  EXPECT_EQ(refusal({writes("--json", "/dev/full")}), "no error");  // told when it is written
}

}  // namespace
}  // namespace foresight::output_guard_test
