// Calibration results: one YAML file each, kept apart from the rig file that points to it.
//
//   kind: stereo                     what was calibrated
//   date: 2026-03-01T14:05:09Z       when
//   devices: {left: 40123, right: 40127}   serial numbers; a rig refuses a result of other devices
//   score: {name: loo_joint_px, value: 0.205}   error on data that the solver has not seen
//   sigma: {fx_left_px: 0.4, ...}    standard deviations of what was estimated
//   result: ...                      what the kind names
#pragma once

#include <yaml-cpp/yaml.h>

#include <filesystem>
#include <map>
#include <string>

#include "scene/yaml_fields.hpp"

namespace foresight {

struct ResultHeader {
  std::string kind;                            ///< "intrinsics", "stereo", "arm", ...
  std::string date;                            ///< ISO 8601, UTC; now() fills it
  std::map<std::string, std::string> devices;  ///< role -> serial number; may be empty
  std::string score_name;                      ///< as in --json, unit as suffix
  double score = 0;                            ///< on data that was kept out; smaller is better
  std::map<std::string, double> sigma;         ///< name with unit suffix -> standard deviation
};

/// Time of day for ResultHeader::date.
std::string utc_now();

/// Writes `file` at once (a temporary file beside it, then a rename). Refuses with InputError,
/// nothing written, where `file` holds a better result of the same kind and score (by more than
/// 2 %), a result of another kind or of other devices, or something that is no result, unless
/// `force`. Throws RuntimeFailure where it cannot be written.
void write_result(const std::filesystem::path& file, const ResultHeader& header, const YAML::Node& result, bool force);

/// Header and the `result` map of a file of this `kind`. Throws InputError naming file, line and field.
struct ResultFile {
  ResultHeader header;
  YamlMap result;
};
ResultFile read_result(const std::filesystem::path& file, const std::string& kind);

}  // namespace foresight
