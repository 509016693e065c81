#include "calibration/registration/calibrated_head.hpp"

#include <algorithm>

#include "calibration/placement/placement.hpp"
#include "calibration/result/result_file.hpp"
#include "common/counted.hpp"
#include "common/error.hpp"

namespace foresight {
namespace {

/// Left-out errors of poses: RMS lengths of three coordinates.
Vector6d sigma_of_poses(const ResultFile& file) {
  const double mrad = file.header.score;
  const double mm = file.result.has("loo_mm") ? file.result.number("loo_mm") : mrad;  // 1 m away, as many mm
  Vector6d sigma;
  sigma.head<3>().setConstant(1e-3 * mrad / std::sqrt(3));
  sigma.tail<3>().setConstant(1e-3 * mm / std::sqrt(3));
  return sigma;
}

double sigma_of_offset(const ResultHeader& header, double otherwise) {
  const auto found = header.sigma.find("offset_s");
  return found == header.sigma.end() ? otherwise : found->second;
}

}  // namespace

HeadModel head_model(const PanTiltModel& model) {
  HeadModel head;
  head.T_world_pan = model.T_world_pan;
  head.T_pan_tilt.translate(Eigen::Vector3d(model.length_m, 0, 0));
  head.T_pan_tilt.rotate(Eigen::AngleAxisd(model.twist_rad, Eigen::Vector3d::UnitX()));
  head.T_tilt_camera = model.T_tilt_camera;
  head.pan = {model.gain[0], 0, -model.backlash_rad[0] / model.gain[0]};
  head.tilt = {model.gain[1], 0, -model.backlash_rad[1] / model.gain[1]};
  return head;
}

HeadModel read_head_model(const std::filesystem::path& pan_tilt, const std::optional<std::filesystem::path>& time) {
  const ResultFile file = read_result(pan_tilt, "pan-tilt");
  HeadModel head = head_model(read_pan_tilt(file.result));
  if (file.result.has("pose_sigma")) {
    const std::vector<double> sigma = file.result.numbers("pose_sigma", 6);
    std::copy(sigma.begin(), sigma.end(), head.sigma_pose.data());
    head.sigma_rad = file.result.positive("shaft_sigma_rad");
  } else {
    head.sigma_pose = sigma_of_poses(file);
  }
  if (time) {
    const ResultFile clock = read_result(*time, "time");
    head.offset_s = clock.result.number("offset_s");
    head.sigma_offset_s = sigma_of_offset(clock.header, head.sigma_offset_s);
  } else if (file.result.has("offset_s")) {
    head.offset_s = file.result.number("offset_s");
    head.sigma_offset_s = sigma_of_offset(file.header, head.sigma_offset_s);
  }
  return head;
}

RegistrationOptions options_for(const HeadModel& head) {
  constexpr double kLeast = 1e-3;  // rad and m
  RegistrationOptions options;
  Vector6d sigma = head.sigma_pose;
  for (int i = 0; i < 3; ++i) sigma[i] = std::hypot(sigma[i], head.sigma_rad);
  options.correction.prior_sigma = (2 * sigma).cwiseMax(kLeast);
  return options;
}

std::vector<double> read_inverse_response(const std::filesystem::path& photometric) {
  const YamlMap result = read_result(photometric, "photometric").result;
  return result.map(result.has("camera") ? "camera" : "left").numbers("inverse_response", 256);
}

TagMap read_tag_map(const std::filesystem::path& file) {
  std::map<int, std::map<long long, Eigen::Vector3d>> tags;
  for (const auto& [key, corner] : read_tag_places(file)) {
    if (key.first > 1'000'000)
      throw InputError(file.string(), "there is no tag " + std::to_string(key.first), "correct its id");
    tags[static_cast<int>(key.first)][key.second] = corner;
  }
  TagMap map;
  for (const auto& [id, corners] : tags) {
    if (corners.size() != 4)
      throw InputError(file.string(), "tag " + std::to_string(id) + " has " + counted(corners.size(), "corner"),
                       "give all four, 0 to 3");
    std::array<Eigen::Vector3d, 4>& c = map[id];
    for (const auto& [index, corner] : corners) c[static_cast<std::size_t>(index)] = corner;
    const double least_diagonal = std::min((c[0] - c[2]).norm(), (c[1] - c[3]).norm());
    for (std::size_t i = 0; i < 4; ++i)
      if ((c[i] - c[(i + 1) % 4]).norm() >= least_diagonal)
        throw InputError(file.string(), "the corners of tag " + std::to_string(id) + " do not go round it",
                         "give them as lower left, lower right, upper right, upper left of the print");
  }
  return map;
}

}  // namespace foresight
