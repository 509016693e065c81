// What README and docs tell people to type, typed: run where it is quick and needs no hardware, else read for options
// that there are not.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <utility>

#include "tests/apps/program.hpp"
#include "tests/scene/test_run.hpp"
#include "tests/support/folders.hpp"

namespace foresight::documented_test {
namespace {

namespace fs = std::filesystem;

/// The lines of all blocks of that language; a line that ends with a backslash goes on in the next one.
std::vector<std::vector<std::string>> blocks(const std::string& file, const std::string& language) {
  std::ifstream in(source_folder() / file);
  std::vector<std::vector<std::string>> out;
  bool fenced = false, inside = false, goes_on = false;
  for (std::string line; std::getline(in, line);) {
    if (line.starts_with("```")) {
      fenced = !fenced;
      inside = fenced && line == "```" + language;
      if (inside) out.emplace_back();
      continue;
    }
    if (!inside) continue;
    const bool more = line.ends_with('\\');
    if (more) line.pop_back();
    if (goes_on)
      out.back().back() += line;
    else
      out.back().push_back(line);
    goes_on = more;
  }
  return out;
}

struct Typed {
  std::vector<std::string> words;
  std::string output;  // file that stdout goes to
};

/// As a shell takes it apart, of which the docs use quotes, comments and `>`.
Typed typed(const std::string& line) {
  Typed out;
  std::string word;
  bool any = false, to_file = false;
  char quote = 0;
  const auto end_word = [&] {
    if (!any) return;
    if (std::exchange(to_file, false))
      out.output = word;
    else
      out.words.push_back(word);
    word.clear();
    any = false;
  };
  for (const char c : line) {
    if (quote == 0 && !any && c == '#') break;
    if (quote == 0 && (c == ' ' || c == '>')) {
      end_word();
      to_file = to_file || c == '>';
    } else if (c == quote) {
      quote = 0;
    } else if (quote == 0 && (c == '"' || c == '\'')) {
      quote = c;
      any = true;
    } else {
      word += c;
      any = true;
    }
  }
  end_word();
  return out;
}

class Documented : public testing::Test {
 protected:
  Documented() { fs::create_directory_symlink(source_folder() / "configs", folder_ / "configs"); }

  /// `may_run`: needs no hardware.
  void type(const std::string& line, bool may_run = true) {
    Typed what = typed(line);
    if (what.words.empty() || what.words[0] == "export") return;
    SCOPED_TRACE(line);
    const std::string program = what.words[0];
    if (program == "printf") {
      EXPECT_EQ(std::system(("cd '" + folder_.path().string() + "' && " + line).c_str()), 0);
    } else if (program.starts_with("scripts/")) {
      EXPECT_EQ(access((source_folder() / program).c_str(), X_OK), 0);
    } else {
      ASSERT_EQ(program, "foresight") << "this test does not know how to check that";
      what.words.erase(what.words.begin());
      run(what, may_run);
    }
  }

  int ran() const { return ran_; }
  int checked() const { return checked_; }
  TempFolder folder_;

 private:
  void run(const Typed& what, bool may_run) {
    std::vector<std::string> words = what.words;
    const bool runs = may_run && is_quick(words);
    ++(runs ? ran_ : checked_);
    if (!runs) words.insert(words.begin(), "--check-options");
    // Real time and the lab's pictures are tested elsewhere.
    if (runs && words[0] == "robot") words.insert(words.end(), {"--stepped", "--no-cameras"});
    const Outcome out = run_program(words, {.environment = {}, .folder = folder_.path()});
    EXPECT_EQ(out.exit_code, 0) << out.err << out.out.substr(0, 2000);
    if (!what.output.empty()) folder_.write(what.output, out.out);
  }

  static bool is_quick(const std::vector<std::string>& words) {
    const auto has = [&](const char* word) { return std::ranges::find(words, word) != words.end(); };
    if (words[0] == "robot") return has("--follow") && has("--log") && !has("--view");
    return (words[0] == "can" && has("explain")) || (words[0] == "calibrate" && has("target"));
  }

  int ran_ = 0, checked_ = 0;
};

TEST_F(Documented, ReadmeRunsAsPrinted) {
  for (const auto& block : blocks("README.md", "sh"))
    for (const std::string& line : block) type(line);
  EXPECT_GE(ran(), 3);
  EXPECT_GE(checked(), 12);
  for (const char* file :
       {"session-arm.log", "session-head.log", "session.html", "session.html.plots.json", "board.pdf"})
    EXPECT_TRUE(fs::exists(folder_ / file)) << file;
  const std::string words = folder_.read("session-arm.txt");
  EXPECT_THAT(words,
              testing::HasSubstr("shoulder_yaw: SDO request to node 1: download 1016:01 consumer heartbeat time"));
  EXPECT_THAT(words, testing::ContainsRegex("elbow: RPDO1 to node 4: 6040:00 controlword = 0x000F .enable operation.; "
                                            "607A:00 target position = "));
  EXPECT_THAT(words, testing::HasSubstr(", 0 unknown\n"));
}

// Each rig of the page goes through what the page types.
TEST_F(Documented, TheFirstDriveRunsAsPrinted) {
  const auto rigs = blocks("docs/first-drive.md", "yaml");
  ASSERT_EQ(rigs.size(), 2u);
  for (const auto& rig : rigs) {
    std::string text;
    for (const std::string& line : rig) text += line + "\n";
    folder_.write("bench.yaml", text);
    for (const auto& block : blocks("docs/first-drive.md", "sh"))
      for (const std::string& line : block) type(line);
    EXPECT_THAT(folder_.read("bench.txt"), testing::HasSubstr("axis: "));
    EXPECT_TRUE(fs::exists(folder_ / "bench.html"));
  }
  for (const auto& block : blocks("docs/first-drive.md", ""))
    for (const std::string& line : block)
      if (line.starts_with("foresight ")) type(line, false);
}

TEST_F(Documented, ThePageOnOnesOwnRobotKnowsItsOptions) {
  for (const auto& block : blocks("docs/own-robot.md", "sh"))
    for (const std::string& line : block) type(line, false);
  EXPECT_GE(checked(), 6);
}

}  // namespace
}  // namespace foresight::documented_test
