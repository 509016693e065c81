#include "apps/commands.hpp"

#include "apps/bench/bench_command.hpp"
#include "apps/calibrate/calibrate_command.hpp"
#include "apps/can_command.hpp"
#include "apps/doctor_command.hpp"
#include "apps/export_command.hpp"
#include "apps/input_command.hpp"
#include "apps/line_recording_command.hpp"
#include "apps/link_command.hpp"
#include "apps/operator/operator_command.hpp"
#include "apps/record_command.hpp"
#include "apps/replay_command.hpp"
#include "apps/rig_command.hpp"
#include "apps/robot_command.hpp"
#include "apps/sim_command.hpp"
#include "apps/stereogram_command.hpp"
#include "apps/synth_command.hpp"

namespace foresight {

void add_commands(Command& app, std::function<int()>& action) {
  add_replay_command(app, action);
  add_record_command(app, action);
  add_export_command(app, action);
  add_stereogram_command(app, action);
  add_synth_command(app, action);
  add_can_command(app, action);
  add_sim_command(app, action);
  add_bench_command(app, action);
  add_rig_command(app, action);
  add_robot_command(app, action);
  add_input_command(app, action);
  add_operator_command(app, action);
  add_link_command(app, action);
  add_line_recording_commands(app, action);
  add_doctor_command(app, action);
  add_calibrate_command(app, action);
}

}  // namespace foresight
