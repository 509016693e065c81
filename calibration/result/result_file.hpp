// Calibration results: one YAML file each, kept apart from the rig file that points to it.
//
//   kind: stereo                     what was calibrated
//   date: 2026-03-01T14:05:09Z       when
//   devices: {left: 40123, right: 40127}   serial numbers; a rig refuses a result of other devices
//   score: {name: loo_joint_px, value: 0.205}   error on data that the solver has not seen
//   sigma: {fx_left_px: 0.4, ...}    standard deviations of what was estimated
//   verdict: usable                  its solver judged it; absent where nobody did (imported, or of an older program)
//   views: [[54, 312.41, 220.11, 143.02], ...]   points, centre and spread in px of each view that it was solved from
//   result: ...                      what the kind names
//
// A result that its solver found not to be usable is never written.
#pragma once

#include <yaml-cpp/yaml.h>

#include <filesystem>
#include <map>
#include <string>

#include "calibration/result/verdict.hpp"
#include "calibration/result/view_print.hpp"
#include "scene/yaml_fields.hpp"

namespace foresight {

struct ResultHeader {
  std::string kind;                            ///< "intrinsics", "stereo", "arm", ...
  std::string date;                            ///< ISO 8601, UTC; now() fills it
  std::map<std::string, std::string> devices;  ///< role -> serial number; may be empty
  std::string score_name;                      ///< as in --json, unit as suffix
  double score = 0;                            ///< on data that was kept out; smaller is better
  std::map<std::string, double> sigma;         ///< name with unit suffix -> standard deviation
  bool judged = false;                         ///< its solver judged it, and found it usable
  ViewPrints views{};                          ///< that it was solved from; may be empty
};

/// Time of day for ResultHeader::date.
std::string utc_now();

/// Writes `file` at once (a temporary file beside it, then a rename). Refuses with InputError,
/// nothing written, where `file` holds a better result of the same kind and score (by more than
/// 2 %), one that was judged while this one was not, a result of another kind or of other devices, or
/// something that is no result, unless `force`. The score of a result that nobody judged protects it from no judged
/// one. Throws RuntimeFailure where it cannot be written.
void write_result(const std::filesystem::path& file, const ResultHeader& header, const YAML::Node& result, bool force);

/// Header and the `result` map of a file of this `kind`. Throws InputError naming file, line and field.
struct ResultFile {
  ResultHeader header;
  YamlMap result;
};
ResultFile read_result(const std::filesystem::path& file, const std::string& kind);

}  // namespace foresight
