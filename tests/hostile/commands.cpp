#include "tests/hostile/commands.hpp"

#include <iostream>
#include <regex>
#include <sstream>
#include <stdexcept>

#include "apps/command_line/output_guard.hpp"
#include "apps/commands.hpp"
#include "common/error.hpp"

namespace foresight {
namespace {

/// What goes to a stream while this lives.
class Caught {
 public:
  explicit Caught(std::ostream& stream) : stream_(stream), before_(stream.rdbuf(text_.rdbuf())) {}
  ~Caught() { stream_.rdbuf(before_); }
  Caught(const Caught&) = delete;
  Caught& operator=(const Caught&) = delete;
  std::string text() const { return text_.str(); }

 private:
  std::ostringstream text_;
  std::ostream& stream_;
  std::streambuf* before_;
};

CommandLine read(std::vector<std::string> words) {
  words.insert(words.begin(), "foresight");
  std::vector<char*> arguments;
  for (std::string& word : words) arguments.push_back(word.data());
  std::function<int()> action;
  return read_command_line(static_cast<int>(arguments.size()), arguments.data(), "", "0", [&](Command& app) {
    app.require_subcommand();
    add_commands(app, action);
  });
}

void collect(const std::vector<std::string>& words, std::vector<HelpedCommand>& all) {
  std::vector<std::string> asked = words;
  asked.emplace_back("--help");
  const Caught help(std::cout);
  if (read(asked).ended != 0) throw std::runtime_error("no help");
  static const std::regex subcommand("^  ([a-z][a-z-]*)( .*)?$"), path("^ +(--[a-z-]+|[A-Z]+) (INPUT|OUTPUT).*$");
  HelpedCommand command{words, {}};
  bool below = false, any_below = false;
  std::istringstream lines(help.text());
  for (std::string line; std::getline(lines, line);) {
    std::smatch found;
    if (!line.empty() && line[0] != ' ') below = line == "Subcommands:";
    if (below && std::regex_match(line, found, subcommand)) {
      std::vector<std::string> next = words;
      next.push_back(found[1]);
      collect(next, all);
      any_below = true;
    } else if (std::regex_match(line, found, path)) {
      command.paths.push_back({found[1], found[2] == "OUTPUT"});
    }
  }
  if (!any_below) all.push_back(std::move(command));
}

}  // namespace

std::string HelpedCommand::name() const {
  std::string out;
  for (const std::string& word : words) out += (out.empty() ? "" : " ") + word;
  return out;
}

const std::vector<HelpedCommand>& all_commands() {
  static const std::vector<HelpedCommand> all = [] {
    std::vector<HelpedCommand> found;
    collect({}, found);
    return found;
  }();
  return all;
}

std::string refusal_of(const std::vector<std::string>& words) {
  const Caught said(std::cerr);
  try {
    const CommandLine line = read(words);
    if (line.ended) return said.text();
    const OutputGuard guard(line.paths);
    return {};
  } catch (const InputError& error) {
    return error.what();
  }
}

}  // namespace foresight
