#include "apps/calibrate/calibrate_command.hpp"

#include "apps/calibrate/arm_command.hpp"
#include "apps/calibrate/capture_command.hpp"
#include "apps/calibrate/display_command.hpp"
#include "apps/calibrate/export_command.hpp"
#include "apps/calibrate/intrinsics_command.hpp"
#include "apps/calibrate/pan_tilt_command.hpp"
#include "apps/calibrate/photometric_command.hpp"
#include "apps/calibrate/scene_command.hpp"
#include "apps/calibrate/stereo_command.hpp"
#include "apps/calibrate/target_command.hpp"
#include "apps/calibrate/time_command.hpp"
#include "apps/calibrate/verify_command.hpp"

namespace foresight {

void add_calibrate_command(Command& app, std::function<int()>& action) {
  auto* calibrate = app.add_subcommand("calibrate", "From a printed target to a rig that places every pixel");
  calibrate->require_subcommand();
  // In the order of a session.
  add_target(*calibrate, action);
  add_capture(*calibrate, action);
  add_intrinsics(*calibrate, action);
  add_stereo(*calibrate, action);
  add_photometric(*calibrate, action);
  add_pan_tilt(*calibrate, action);
  add_arm(*calibrate, action);
  add_time(*calibrate, action);
  add_scene(*calibrate, action);
  add_display(*calibrate, action);
  add_verify(*calibrate, action);
  add_export(*calibrate, action);
}

}  // namespace foresight
