// What the arm, time and pan-tilt commands print and write alike.
#pragma once

#include <iostream>
#include <map>
#include <nlohmann/json_fwd.hpp>

#include "calibration/camera/camera_model.hpp"
#include "calibration/result/html_report.hpp"
#include "calibration/robot/pan_tilt.hpp"
#include "scene/scene_model.hpp"

namespace foresight {

/// {"xyz": [..], "quaternion": [x, y, z, w]}
nlohmann::ordered_json json_of(const Pose& pose);
nlohmann::ordered_json json_of(const CameraModel& camera);

/// "0.123 0.456 0.789 m, turned 0.1 0.2 0.3 0.9 (qx qy qz qw)"
std::string readable_pose(const Pose& pose);

/// Tables of the model and of standard deviations, and the notes as paragraphs.
void report_model(HtmlReport& report, const PanTiltModel& model);
void report_sigmas(HtmlReport& report, const std::map<std::string, double>& sigmas);
void report_notes(HtmlReport& report, const std::vector<std::string>& notes);

/// One line each on stdout.
void print_notes(const std::vector<std::string>& notes);

}  // namespace foresight
