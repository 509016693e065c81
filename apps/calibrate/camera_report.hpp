// The HTML page of a calibrated camera or pair.
#pragma once

#include "calibration/camera/camera_calibration.hpp"
#include "calibration/result/html_report.hpp"
#include "calibration/target/image_input.hpp"

namespace foresight {

/// `files`: pictures of the views, by name; left or the only one, right; views without are not shown.
HtmlReport camera_report(const CameraCalibration& calibration, const PicturesOfViews& files);

}  // namespace foresight
