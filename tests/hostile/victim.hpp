// A user's folder with everything that commands read, and a command line for each of them.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "tests/hostile/commands.hpp"
#include "tests/scene/test_run.hpp"

namespace foresight {

/// Words of a command line by option, in order. A word that begins with @ names a file of the victim's.
using CommandWords = std::vector<std::pair<std::string, std::vector<std::string>>>;

class Victim : public TempFolder {
 public:
  Victim();

  /// What is in the folder: names, kinds, bytes.
  std::map<std::string, std::string> snapshot() const;
  /// Names of what differs from `before`.
  std::vector<std::string> changes(const std::map<std::string, std::string>& before) const;

  /// The least that `command` needs to get to its work: rows of a table; null where it has no row.
  static const CommandWords* row(const std::string& command);
  static std::vector<std::string> rows();

  /// The command line of the row, with `more` in place of, or behind, what the row says of the same options.
  std::vector<std::string> line(const HelpedCommand& command, const CommandWords& more) const;
  std::vector<std::string> line(const std::string& command, const CommandWords& more) const;
};

}  // namespace foresight
