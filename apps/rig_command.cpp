#include "apps/rig_command.hpp"

#include "apps/rig_view_command.hpp"

namespace foresight {

void add_rig_command(Command& app, std::function<int()>& action) {
  auto* command = app.add_subcommand("rig", "Rig files (docs/rig-files.md)");
  command->require_subcommand();
  add_rig_view_command(*command, action);
}

}  // namespace foresight
