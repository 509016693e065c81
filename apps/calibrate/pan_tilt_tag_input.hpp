// Views of a static tag map at known angles, for `foresight calibrate pan-tilt` and `verify`.
#pragma once

#include <filesystem>
#include <map>
#include <optional>

#include "calibration/registration/tag_correction.hpp"
#include "calibration/robot/head_encoders.hpp"
#include "calibration/robot/pan_tilt_tags.hpp"

namespace foresight {

struct PanTiltTagInput {
  std::optional<std::filesystem::path> images, right,
      angles;                                        ///< one folder of pictures a camera, a row of angles each
  std::optional<std::filesystem::path> run, joints;  ///< or a recording and its joints
  std::optional<std::filesystem::path> tags, camera, camera_right;
  std::optional<std::filesystem::path> photometric;  ///< corners are found in the light that it tells of
  std::string family = "tag36h11";
  std::vector<std::string> joint_names{"pan", "tilt"};
  int most_views = 60;  ///< of a run, spread evenly over its time
  bool in_order = false;
};

/// Pictures in which tags were found, and what gives their angles.
struct TagViews {
  CalibratedCameras cameras;
  TagMap map;
  std::vector<PanTiltView> views;                                     ///< of images: with their angles
  std::vector<RobotTime> times;                                       ///< of a run: of each view
  std::vector<JointRow> joints;                                       ///< of a run: pan and tilt
  std::optional<HeadEncoders> encoders;                               ///< of a run
  std::map<std::string, std::array<std::filesystem::path, 2>> files;  ///< pictures of each view, by name; left, right
  std::vector<std::string> notes;
};

/// Throws InputError naming option, file and line: what is missing, pictures of another size than the lens, rows and
/// pictures that do not match, no tag of the map in any picture (with the family or the ids that were seen).
TagViews read_tag_views(const PanTiltTagInput& input);

/// Views of a run with the angles that its encoders tell at the capture times plus `offset_s`; others as they are.
std::vector<PanTiltView> views_at(const TagViews& all, double offset_s);

}  // namespace foresight
