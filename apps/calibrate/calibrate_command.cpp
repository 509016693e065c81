#include "apps/calibrate/calibrate_command.hpp"

#include "apps/calibrate/capture_command.hpp"
#include "apps/calibrate/target_command.hpp"

namespace foresight {

void add_calibrate_command(CLI::App& app, std::function<int()>& action) {
  auto* calibrate = app.add_subcommand("calibrate", "From a printed target to a rig that places every pixel");
  calibrate->require_subcommand(1);
  // In the order of a session.
  add_target(*calibrate, action);
  add_capture(*calibrate, action);
}

}  // namespace foresight
