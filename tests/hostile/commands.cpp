#include "tests/hostile/commands.hpp"

#include <regex>
#include <sstream>
#include <stdexcept>

#include "tests/apps/program.hpp"

namespace foresight {
namespace {

void collect(const std::vector<std::string>& words, std::vector<HelpedCommand>& all) {
  std::vector<std::string> help = words;
  help.emplace_back("--help");
  const Outcome outcome = run_program(help);
  if (outcome.exit_code != 0) throw std::runtime_error("no help: " + outcome.err);
  static const std::regex subcommand("^  ([a-z][a-z-]*)( .*)?$"), path("^ +(--[a-z-]+|[A-Z]+) (INPUT|OUTPUT).*$");
  HelpedCommand command{words, {}};
  bool below = false, any_below = false;
  std::istringstream lines(outcome.out);
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

}  // namespace foresight
