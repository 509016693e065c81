// What calibrations found, as the registration uses it.
#pragma once

#include <filesystem>
#include <optional>

#include "calibration/registration/head_kinematics.hpp"
#include "calibration/registration/registration.hpp"
#include "calibration/robot/pan_tilt.hpp"

namespace foresight {

/// The same head: T_pan_tilt = Tx(length) Rx(twist), the gains as scales. PanTiltModel adds half its backlash for a
/// joint that came from below, HeadAxis takes half of it away (the shaft lags) and counts it before the scale, so that
/// HeadAxis::backlash_rad = -PanTiltModel::backlash_rad / gain.
HeadModel head_model(const PanTiltModel& model);

/// From results of `foresight calibrate pan-tilt` and `calibrate time`. Standard deviations come from the results:
/// of a head that was calibrated from poses, its left-out error. The offset of a `time` result counts before the one
/// that `pan-tilt` found itself; 0 without either. Throws InputError naming file and field.
HeadModel read_head_model(const std::filesystem::path& pan_tilt, const std::optional<std::filesystem::path>& time);

/// Options whose prior of the tags' correction is what the calibration left: twice its standard deviations, but 1 mrad
/// and 1 mm at least, for a head that was touched since. With the usual prior, ten times as wide, a single tag in view
/// would turn a good pose by more than it corrects.
RegistrationOptions options_for(const HeadModel& head);

/// TagDetector::Options::inverse_response from a result of `foresight calibrate photometric`: the left camera's, or the
/// only one's; the right camera, of the same kind, is taken to answer alike. Throws InputError naming file and field.
std::vector<double> read_inverse_response(const std::filesystem::path& photometric);

/// Rows "id corner x y z" in the world. Throws InputError naming file and line, or the tag: a corner is missing, or
/// they do not stand in their order around it.
TagMap read_tag_map(const std::filesystem::path& file);

}  // namespace foresight
