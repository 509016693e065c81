// All subcommands and their options, as the program's own help tells them; and command lines read as the program reads
// them, without starting it: its start costs more than all that is checked here.
#pragma once

#include <optional>
#include <string>
#include <vector>

namespace foresight {

struct CommandOption {
  std::string name;     ///< "--json", or "RUN" of a positional one
  bool writes = false;  ///< OUTPUT, else INPUT; options that are no paths are left out
};

struct HelpedCommand {
  std::vector<std::string> words;  ///< "calibrate", "arm"
  std::vector<CommandOption> paths;
  std::string name() const;
};

/// Every command that has no subcommands.
const std::vector<HelpedCommand>& all_commands();

/// What the program says of a command line before any work; "" where it would begin.
std::string refusal_of(const std::vector<std::string>& words);

}  // namespace foresight
