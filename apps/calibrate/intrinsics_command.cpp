#include "apps/calibrate/intrinsics_command.hpp"

#include <memory>

#include "apps/calibrate/camera_run.hpp"

namespace foresight {

void add_intrinsics(Command& calibrate, std::function<int()>& action) {
  auto* command = calibrate.add_subcommand("intrinsics", "The lens of one camera, from views of a board");
  auto run = std::make_shared<CameraRun>();
  add_camera_run(*command, *run, false);
  command->footer(
      "Example: foresight calibrate intrinsics --corners corners.vnl --board chessboard:9x6:0.025 "
      "--out lens.yaml --report lens.html\nExit code: 1 where the result should not be used.");
  command->callback([run, &action] { action = [run] { return calibrate_cameras(*run, false); }; });
}

}  // namespace foresight
