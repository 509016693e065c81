#include "apps/calibrate/stereo_command.hpp"

#include <memory>

#include "apps/calibrate/camera_run.hpp"

namespace foresight {

void add_stereo(Command& calibrate, std::function<int()>& action) {
  auto* command = calibrate.add_subcommand("stereo", "Both lenses of a pair, and the right camera's place");
  auto run = std::make_shared<CameraRun>();
  add_camera_run(*command, *run, true);
  command->footer(
      "Example: foresight calibrate stereo --corners corners.vnl --board chessboard:9x6:0.025 "
      "--out stereo.yaml --report stereo.html\nExit code: 1 where the result should not be used.");
  command->callback([run, &action] { action = [run] { return calibrate_cameras(*run, true); }; });
}

}  // namespace foresight
