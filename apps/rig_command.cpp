#include "apps/rig_command.hpp"

#include "apps/rig_new_command.hpp"
#include "apps/rig_view_command.hpp"

namespace foresight {

void add_rig_command(Command& app, std::function<int()>& action) {
  Command* const rig = app.add_subcommand("rig", "Rig files: which drives and cameras a robot has (docs/rig-files.md)");
  rig->require_subcommand();
  add_rig_new_command(*rig, action);
  add_rig_view_command(*rig, action);
}

}  // namespace foresight
