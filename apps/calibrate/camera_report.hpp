// The HTML page of a calibrated camera or pair.
#pragma once

#include "calibration/camera/camera_calibration.hpp"
#include "calibration/result/html_report.hpp"

namespace foresight {

HtmlReport camera_report(const CameraCalibration& calibration);

}  // namespace foresight
