// Levels of detail as commands that show views ask for them.
#pragma once

#include <optional>

#include "apps/command_line/command_line.hpp"
#include "scene/lod/level_director.hpp"

namespace foresight {

struct LevelArguments {
  LevelRule rule = LevelRule::full;
  std::optional<double> budget_ms;
};

/// Adds --detail and --detail-budget-ms. `arguments` must live as long as `command`.
void add_level_options(Command& command, LevelArguments& arguments);

/// Nothing where all is to be drawn in full. Throws InputError: a rule with a budget without one, or the other way
/// round.
std::optional<LevelSettings> level_settings(const LevelArguments& arguments);

/// The word of --detail.
std::string to_string(LevelRule rule);

}  // namespace foresight
