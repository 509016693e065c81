#include "apps/calibrate/lens_file.hpp"

#include "calibration/camera/camera_result.hpp"
#include "calibration/result/result_file.hpp"
#include "common/error.hpp"
#include "common/text.hpp"
#include "scene/camera_info.hpp"

namespace foresight {
namespace {

/// "" for a file that is no result.
std::string kind_of(const std::filesystem::path& file) {
  const YamlMap top = YamlMap::load(file);
  return top.has("kind") ? top.text("kind") : "";
}

}  // namespace

LensInFile read_lens_file(const std::filesystem::path& file, Side side) {
  const std::string kind = kind_of(file);
  if (kind.empty()) return {to_camera_model(read_camera_info(file).lens), ""};
  if (kind == "intrinsics") return {read_camera(read_result(file, kind).result), ""};
  if (kind == "arm") {
    const ResultFile arm = read_result(file, kind);
    if (arm.result.has("camera")) return {read_camera(arm.result.map("camera")), ""};
    throw InputError(file.string(), "it holds no lens: its images came without their size",
                     "give the file of --camera that it was solved with");
  }
  if (kind != "stereo")
    throw InputError(file.string(), "it holds a result of kind " + in_quotes(kind) + ", which has no lens",
                     "give one of `foresight calibrate intrinsics`, `stereo` or `arm`, or a camera_info");
  const CalibratedCameras pair = read_calibrated_cameras(read_result(file, kind).result);
  const bool left = side == Side::left;
  return {left ? pair.left() : pair.cameras.at(1),
          std::string("the ") + (left ? "left" : "right") + " lens of " + file.string() + " is taken"};
}

CalibratedCameras read_cameras_file(const std::filesystem::path& file,
                                    const std::optional<std::filesystem::path>& right) {
  if (kind_of(file) == "stereo") return read_calibrated_cameras(read_result(file, "stereo").result);
  CalibratedCameras cameras;
  cameras.cameras = {read_lens_file(file).camera};
  if (!right) return cameras;
  const CameraInfo info = read_camera_info(*right);
  if (!info.T_left_right) throw InputError(right->string(), "has no T_left_right", "say where the right camera is");
  cameras.cameras.push_back(to_camera_model(info.lens));
  cameras.T_left_right = *info.T_left_right;
  return cameras;
}

}  // namespace foresight
