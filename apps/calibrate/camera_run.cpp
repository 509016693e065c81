#include "apps/calibrate/camera_run.hpp"

namespace foresight {

void add_camera_run(Command& command, CameraRun& run, bool pair) {
  add_camera_input(command, run.input, pair);
  command
      .add_option("--model", run.model,
                  "radtan4, radtan5, rational, thin-prism, equidistant; auto: radtan4 unless another one "
                  "lowers the error on views left out")
      ->capture_default_str();
  command.add_flag("!--flat", run.warp, "Take the board as flat");
  add_camera_output(command, run.output);
}

int calibrate_cameras(const CameraRun& run, bool pair) {
  CameraCalibrationOptions options;
  if (run.model != "auto") options.model = parse_distortion(run.model);
  options.warp = run.warp;
  const CameraViewsInput input = read_camera_input(run.input, pair);
  CameraCalibration calibration = calibrate_rig(input.train, input.test, options);
  calibration.notes.insert(calibration.notes.begin(), input.notes.begin(), input.notes.end());
  return deliver(calibration, input, run.output);
}

}  // namespace foresight
