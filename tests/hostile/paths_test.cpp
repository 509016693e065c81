// Every subcommand against names that would lose something of the user's, hang, or fill the memory: all are refused
// with exit code 2, and the user's folder is the same after as before, byte by byte.
#include <set>

#include "tests/apps/program.hpp"
#include "tests/hostile/victim.hpp"

namespace foresight::paths_test {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

constexpr std::chrono::seconds kHangs{120};

/// Options that the row's other words leave without use.
const std::set<std::string> kUnused{"calibrate scene --camera", "calibrate scene --camera-poses",
                                    "calibrate scene --tag-corners", "calibrate scene --seen"};

class Hostile : public testing::Test {
 protected:
  /// Before any work, with a word about `option`; the folder is left alone.
  void refused_by_guard(const HelpedCommand& command, const std::string& option, const CommandWords& more) const {
    const std::vector<std::string> words = victim_.line(command, more);
    SCOPED_TRACE(testing::PrintToString(words));
    // What the parser refuses for another reason (an option that needs or excludes another) never comes to the guard.
    EXPECT_THAT(refusal_of(words), testing::AnyOf(HasSubstr(option), HasSubstr("; see `foresight ")));
    EXPECT_THAT(victim_.changes(before_), testing::IsEmpty());
  }
  /// By the program that was started: with a word, no signal and no wait.
  void survived(const HelpedCommand& command, const std::string& option, const CommandWords& more) const {
    const std::vector<std::string> words = victim_.line(command, more);
    SCOPED_TRACE(testing::PrintToString(words));
    const Outcome outcome = Program(words).wait(kHangs);
    if (kUnused.contains(command.name() + " " + option)) {
      EXPECT_EQ(outcome.exit_code, 0) << outcome.err << "\nit has a use now: take it out of kUnused";
    } else {
      EXPECT_THAT(outcome.exit_code, testing::AnyOf(1, 2)) << outcome.err;
      EXPECT_THAT(outcome.last_line(), testing::StartsWith("foresight: "));
    }
    EXPECT_THAT(victim_.changes(before_), testing::IsEmpty());
    if (std::getenv("FORESIGHT_SHOW_MESSAGES"))
      std::printf("%-24s %s\n", command.name().c_str(), outcome.last_line().c_str());
  }

  const Victim victim_;
  const std::map<std::string, std::string> before_ = victim_.snapshot();
};

std::vector<std::string> options(const HelpedCommand& command, bool writes) {
  std::vector<std::string> out;
  for (const CommandOption& option : command.paths)
    if (option.writes == writes) out.push_back(option.name);
  return out;
}

TEST_F(Hostile, EverySubcommandHasARow) {
  std::vector<std::string> names;
  for (const HelpedCommand& command : all_commands()) names.push_back(command.name());
  EXPECT_THAT(Victim::rows(), testing::UnorderedElementsAreArray(names)) << "rows are in victim.cpp";
}

TEST_F(Hostile, EmptyNamesAreRefused) {
  for (const HelpedCommand& command : all_commands())
    for (const CommandOption& option : command.paths) refused_by_guard(command, option.name, {{option.name, {""}}});
}

TEST_F(Hostile, OutputsOverInputsAreRefused) {
  for (const HelpedCommand& command : all_commands())
    for (const std::string& output : options(command, true))
      for (const std::string& input : options(command, false))
        refused_by_guard(command, output, {{input, {"@notes.txt"}}, {output, {"@run/../notes.txt"}}});
}

TEST_F(Hostile, OutputsOverEachOtherAreRefused) {
  for (const HelpedCommand& command : all_commands()) {
    const std::vector<std::string> outputs = options(command, true);
    for (std::size_t i = 0; i < outputs.size(); ++i)
      for (std::size_t j = 0; j < i; ++j)
        refused_by_guard(command, outputs[i], {{outputs[i], {"@new/x.glb"}}, {outputs[j], {"@run/../new/x.glb"}}});
  }
}

TEST_F(Hostile, ForeignFilesAndPlacesThatCannotBeWrittenAreRefused) {
  for (const HelpedCommand& command : all_commands())
    for (const std::string& output : options(command, true)) {
      refused_by_guard(command, output, {{output, {"@notes.txt"}}});
      refused_by_guard(command, output, {{output, {"/proc/foresight.glb"}}});
      refused_by_guard(command, output, {{output, {"@notes.txt/below.glb"}}});
    }
}

TEST_F(Hostile, TheRowsThemselvesAreNotRefused) {
  for (const HelpedCommand& command : all_commands())
    EXPECT_EQ(refusal_of(victim_.line(command, {})), "") << command.name();
}

// The program itself, as what opens a file is the command: a pipe that nobody writes, and a device without an end.
TEST_F(Hostile, SpecialFilesAreNoInputs) {
  for (const HelpedCommand& command : all_commands()) {
    bool device = false;
    for (const std::string& input : options(command, false)) {
      survived(command, input, {{input, {device ? "/dev/zero" : "@fifo"}}});
      device = !device;
    }
  }
}

}  // namespace
}  // namespace foresight::paths_test
