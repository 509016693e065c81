#include "apps/calibrate/calibrate_command.hpp"

#include "apps/calibrate/display_command.hpp"
#include "apps/calibrate/export_command.hpp"
#include "apps/calibrate/photometric_command.hpp"
#include "apps/calibrate/scene_command.hpp"

namespace foresight {

void add_calibrate_command(CLI::App& app, std::function<int()>& action) {
  auto* calibrate = app.add_subcommand("calibrate", "From a printed target to a rig that places every pixel");
  calibrate->require_subcommand(1);
  // In the order of a session.
  add_photometric_command(*calibrate, action);
  add_display_command(*calibrate, action);
  add_scene_command(*calibrate, action);
  add_calibration_export_command(*calibrate, action);
}

}  // namespace foresight
