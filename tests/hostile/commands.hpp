// All subcommands and their options, as the program's own help tells them.
#pragma once

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

/// Every command that has no subcommands. Starts the program once for each of them and of those above.
const std::vector<HelpedCommand>& all_commands();

}  // namespace foresight
