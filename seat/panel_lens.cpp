#include "seat/panel_lens.hpp"

#include "calibration/camera/camera_result.hpp"
#include "calibration/result/result_file.hpp"

namespace foresight {

Lens read_panel_lens(const std::filesystem::path& file) {
  return to_lens(read_camera(read_result(file, "display").result.map("panel")));
}

}  // namespace foresight
