// The words of a command line and the variables that they fill. CLI11 does the work; it is compiled here, once, because
// each of its users would spend ten seconds on it.
//
// An option that names a file or folder says what for: reads(), writes() or writes_folder(). One of the type
// std::filesystem::path that does not is a mistake in the program, which every start of it tells.
//
// One thread. Commands and options live as long as read_command_line() runs.
#pragma once

#include <cstdint>
#include <deque>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "apps/command_line/path_roles.hpp"

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace foresight {

/// What the words of an option must be.
struct OptionCheck {
  std::function<std::string(const std::string&)> fault;  ///< what is wrong with a word; "" where nothing is
  std::string expects;                                   ///< for the help text
};

/// A number of the closed range; "nan" is none.
OptionCheck from_to(double low, double high);
/// One of these words.
OptionCheck one_of(std::vector<std::string> words);
OptionCheck existing_file();

/// Words and what they mean, in the order in which a help text lists them.
template <typename E>
using Choices = std::vector<std::pair<std::string, E>>;

/// One option. Each method returns the option.
class Option {
 public:
  explicit Option(CLI::Option* option) : option_(option) {}
  Option* required();
  Option* check(OptionCheck check);
  Option* expected(int words);
  Option* expected(int least, int most);
  Option* capture_default_str();  ///< the help text shows what the variable holds now
  Option* default_str(const std::string& text);
  Option* excludes(const Option* other);
  Option* needs(const Option* other);

  Option* reads();                ///< a file, a folder, a pattern; words that are no path do no harm
  Option* writes(FileForm form);  ///< one file
  Option* writes(OutputsOf outputs);

 private:
  friend class Command;
  CLI::Option* option_;
  bool is_path_ = false;
  std::optional<OutputsOf> role_;  // empty function: it is read
};

/// A command or subcommand.
class Command {
 public:
  explicit Command(CLI::App& app);
  ~Command();
  Command(const Command&) = delete;

  Command* add_subcommand(const std::string& name, const std::string& help);
  void require_subcommand();  ///< exactly one
  /// Options of a heading of their own in the help text.
  Command* add_option_group(const std::string& name);

  /// `names`: "--long", "-s,--long", or "POSITIONAL". `target` must outlive the parsing. T: bool, int, std::int64_t,
  /// std::uint64_t, double, std::string, std::filesystem::path, std::optional or std::vector of such (command_line.cpp
  /// has the list); others do not link.
  template <typename T>
  Option* add_option(const std::string& names, T& target, const std::string& help);
  /// Sets `target`; "!--no-such-thing" clears it.
  Option* add_flag(const std::string& names, bool& target, const std::string& help);
  /// Of which nothing is a default of its own.
  Option* add_flag(const std::string& names, std::optional<bool>& target, const std::string& help);
  /// A number that goes through a function.
  Option* add_number(const std::string& names, std::function<void(std::uint64_t)> take, const std::string& help);
  /// One of the words of `choices`.
  template <typename E>
  Option* add_choice(const std::string& names, E& target, const Choices<E>& choices, const std::string& help) {
    std::vector<std::string> words;
    for (const auto& [word, value] : choices) words.push_back(word);
    const auto take = [&target, choices](const std::string& given) {
      for (const auto& [word, value] : choices)
        if (word == given) target = value;
    };
    return add_word(names, std::move(words), take, help);
  }

  void footer(const std::string& text);
  /// Called once all words were read, where this command is the one that is asked for.
  void callback(std::function<void()> then);

  /// The words that were given to options with a role, here and in groups.
  std::vector<GivenPath> given_paths() const;
  /// Throws std::logic_error naming the first option of a path, here and below, that does not say what for.
  void require_roles() const;

 private:
  Option* add_word(const std::string& names, std::vector<std::string> words,
                   std::function<void(const std::string&)> take, const std::string& help);
  Option* keep(CLI::Option* option);

  CLI::App& app_;
  std::deque<Option> options_;
  std::deque<Command> commands_;
};

struct CommandLine {
  std::optional<int>
      ended;  ///< exit code where nothing is left to do: help, version, --check-options, a mistake, told on stderr
  std::vector<GivenPath> paths;  ///< of the chosen command, for the OutputGuard
};

/// Reads the command line. `define` adds the subcommands. Where it has not ended, the chosen command's callback was
/// called.
CommandLine read_command_line(int argc, char** argv, const std::string& help, const std::string& version,
                              const std::function<void(Command&)>& define);

}  // namespace foresight
