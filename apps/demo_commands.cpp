#include "apps/commands.hpp"

#include "apps/export_command.hpp"
#include "apps/operator/operator_command.hpp"
#include "apps/replay_command.hpp"
#include "apps/robot_command.hpp"
#include "apps/synth_command.hpp"

namespace foresight {

void add_commands(Command& app, std::function<int()>& action) {
  add_operator_command(app, action);
  add_robot_command(app, action);
  add_replay_command(app, action);
  add_export_command(app, action);
  add_synth_command(app, action);
}

}  // namespace foresight
