#include "apps/calibrate/photometric_command.hpp"

#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>

#include "apps/calibrate/lens_file.hpp"
#include "apps/calibrate/outputs.hpp"
#include "apps/calibrate/robot_output.hpp"
#include "calibration/photometric/exposure_series.hpp"
#include "calibration/result/html_report.hpp"
#include "common/counted.hpp"
#include "common/error.hpp"
#include "common/exact_number.hpp"
#include "common/text.hpp"

namespace foresight {
namespace {

struct Folders {
  std::filesystem::path series, flat, camera;
};

struct PhotometricCommandOptions {
  Folders one, left, right;
  std::filesystem::path exposures;
  CalibrateOutputs outputs;
};

struct CameraPhotometry {
  std::string name;
  SeriesSamples samples;
  PhotometricSummary summary;
};

constexpr int kPlaces = 400;  // blocks of a static scene

CameraPhotometry solve_one(const std::string& name, const Folders& folders,
                           const std::map<std::string, double>& exposures) {
  CameraPhotometry out{name, {}, {}};
  Verdict of_series;
  if (!folders.series.empty()) {
    const auto series = read_series(folders.series, exposures);
    judge_series(series, of_series);
    add_static(series, kPlaces, out.samples);
  }
  if (!folders.flat.empty()) {
    const auto flat = read_series(folders.flat, exposures);
    judge_series(flat, of_series);
    const cv::Size size = flat.front().pixels.size();
    Eigen::Vector2d centre((size.width - 1) / 2.0, (size.height - 1) / 2.0);
    if (!folders.camera.empty()) {
      const auto [camera, which] = read_lens_file(folders.camera, name == "right" ? Side::right : Side::left);
      if (!which.empty()) print_notes({which});
      if (camera.width != size.width || camera.height != size.height)
        throw InputError(folders.camera.string(), "is of another image size", "give the camera of these images");
      centre = {camera.lens[2], camera.lens[3]};
    }
    add_flat(flat, centre, out.samples);
  }
  out.summary = solve_photometric(out.samples.samples);
  out.summary.verdict.add(of_series);
  if (!out.summary.has_vignetting)
    out.summary.warnings.emplace_back("without a flat field (--flat) the vignetting is not known");
  return out;
}

struct Gain {
  double value = 1;  // right over left, at the same light and exposure time
  double sigma = 0;
};

std::optional<Gain> gain_of(const std::vector<CameraPhotometry>& cameras) {
  if (cameras.size() != 2) return std::nullopt;
  const auto &a = cameras[0].samples.flat_radiances, &b = cameras[1].samples.flat_radiances;
  if (a.empty() || a.size() != b.size()) return std::nullopt;
  double log_gain = 0, variance = 0;
  const auto count = static_cast<double>(a.size());
  const auto sigma = [](const PhotometricSummary& s, std::size_t i) {
    return i < s.log_radiance_sigma.size() ? s.log_radiance_sigma[i] : NAN;
  };
  for (std::size_t c = 0; c < a.size(); ++c) {
    const auto left = static_cast<std::size_t>(a[c]), right = static_cast<std::size_t>(b[c]);
    log_gain += (cameras[1].summary.log_radiance[right] - cameras[0].summary.log_radiance[left]) / count;
    variance += (std::pow(sigma(cameras[1].summary, right), 2) + std::pow(sigma(cameras[0].summary, left), 2)) /
                (count * count);
  }
  return Gain{std::exp(log_gain), std::exp(log_gain) * std::sqrt(variance)};
}

nlohmann::ordered_json numbers_of(const CameraPhotometry& camera) {
  const PhotometricSummary& s = camera.summary;
  nlohmann::ordered_json out{{"images", camera.samples.images},
                             {"samples", s.samples},
                             {"outliers", s.outliers},
                             {"saturated_blocks", camera.samples.saturated},
                             {"dark_blocks", camera.samples.dark},
                             {"rms_levels", s.rms_levels},
                             {"inverse_response", s.response.table()},
                             {"response_sigma_relative", s.response_sigma}};
  if (std::isfinite(s.held_out_levels)) out["held_out_levels"] = s.held_out_levels;
  if (s.has_vignetting) {
    out["vignetting"] = s.vignetting.a;
    out["vignetting_corner"] = s.vignetting(1);
    out["vignetting_corner_sigma"] = s.corner_sigma;
  }
  out["warnings"] = s.warnings;
  return out;
}

YAML::Node payload_of(const CameraPhotometry& camera) {
  const auto list = [](const auto& numbers) {
    YAML::Node node(YAML::NodeType::Sequence);
    node.SetStyle(YAML::EmitterStyle::Flow);
    for (const double v : numbers) node.push_back(exact_text(v));
    return node;
  };
  YAML::Node node;
  node["inverse_response"] = list(camera.summary.response.table());
  if (camera.summary.has_vignetting) node["vignetting"] = list(camera.summary.vignetting.a);
  return node;
}

Deliverable deliverable(const std::vector<CameraPhotometry>& cameras, const std::optional<Gain>& gain) {
  Deliverable out;
  out.header.kind = "photometric";
  out.header.score_name = "held_out_levels";
  for (const CameraPhotometry& camera : cameras) {
    const PhotometricSummary& s = camera.summary;
    for (const Objection& objection : s.verdict.against)
      out.verdict.object(cameras.size() > 1 ? camera.name + ": " + objection.what : objection.what, objection.cure);
    if (!std::isfinite(s.held_out_levels)) out.header.score_name = "rms_levels";
    out.payload[camera.name] = payload_of(camera);
    if (s.has_vignetting) out.header.sigma[camera.name + "_corner_relative"] = s.corner_sigma;
  }
  for (const CameraPhotometry& camera : cameras)
    out.header.score =
        std::max(out.header.score,
                 out.header.score_name == "rms_levels" ? camera.summary.rms_levels : camera.summary.held_out_levels);
  if (gain) {
    out.payload["gain_right_over_left"] = exact_text(gain->value);
    if (std::isfinite(gain->sigma)) out.header.sigma["gain_right_over_left"] = gain->sigma;
  }
  return out;
}

HtmlReport report_of(const std::vector<CameraPhotometry>& cameras, const std::optional<Gain>& gain) {
  HtmlReport report("Photometric calibration");
  std::vector<HtmlReport::Series> responses, vignettes;
  for (const CameraPhotometry& camera : cameras) {
    const PhotometricSummary& s = camera.summary;
    report.paragraph(camera.name + ": " + counted(s.samples, "block") + " of " + std::to_string(camera.samples.images) +
                     " images, residuals " + readable(s.rms_levels, 2, " levels") + ", on images left out " +
                     readable(s.held_out_levels, 2, " levels") + ".");
    for (const std::string& warning : s.warnings) report.paragraph("Warning: " + warning + ".");
    responses.push_back({camera.name, {}, true});
    for (int v = 0; v < 256; ++v) responses.back().points.emplace_back(s.response.inverse(v), v);
    if (!s.has_vignetting) continue;
    vignettes.push_back({camera.name, {}, true});
    for (int i = 0; i <= 50; ++i) vignettes.back().points.emplace_back(i / 50.0, s.vignetting(i * i / 2500.0));
  }
  if (gain)
    report.paragraph("Gain, right over left: " + readable(gain->value, 4) + " +/- " + readable(gain->sigma, 4) + ".");
  report.plot("Response", "exposure, 1 saturates", "level", responses);
  if (!vignettes.empty()) report.plot("Vignetting", "radius, half diagonals", "light", vignettes);
  return report;
}

std::vector<std::pair<std::string, Folders>> cameras_of(const PhotometricCommandOptions& options) {
  const auto given = [](const Folders& f) { return !f.series.empty() || !f.flat.empty(); };
  const bool one = given(options.one), left = given(options.left), right = given(options.right);
  if (one && !left && !right) return {{"camera", options.one}};
  if (!one && left && right) return {{"left", options.left}, {"right", options.right}};
  throw InputError("--images", "one camera, or a left and a right one, must be given",
                   "give --images DIR and --flat DIR, or --left, --right, --left-flat and --right-flat");
}

int run_photometric(const PhotometricCommandOptions& options) {
  const auto exposures =
      options.exposures.empty() ? std::map<std::string, double>{} : read_exposures(options.exposures);
  std::vector<CameraPhotometry> cameras;
  nlohmann::ordered_json numbers;
  for (const auto& [name, folders] : cameras_of(options)) {
    cameras.push_back(solve_one(name, folders, exposures));
    const PhotometricSummary& s = cameras.back().summary;
    std::cout << name << ": residuals " << readable(s.rms_levels, 2, " levels") << ", on images left out "
              << readable(s.held_out_levels, 2, " levels");
    if (s.has_vignetting)
      std::cout << ", corners at " << readable(100 * s.vignetting(1), 1, " %") << " +/- "
                << readable(100 * s.corner_sigma, 1);
    std::cout << "\n";
    for (const std::string& warning : s.warnings) std::cerr << "warning: " << name << ": " << warning << "\n";
    numbers[name] = numbers_of(cameras.back());
  }
  const auto gain = gain_of(cameras);
  if (gain) {
    std::cout << "gain, right over left: " << readable(gain->value, 4) << " +/- " << readable(gain->sigma, 4) << "\n";
    numbers["gain_right_over_left"] = gain->value;
    numbers["gain_sigma"] = gain->sigma;
  } else if (cameras.size() == 2) {
    std::cerr << "warning: without flat fields of one surface (--left-flat, --right-flat) the gain is not known\n";
  }
  Deliverable found = deliverable(cameras, gain);
  found.report = [&] { return report_of(cameras, gain); };
  return deliver(found, numbers, options.outputs);
}

}  // namespace

void add_photometric(Command& calibrate, std::function<int()>& action) {
  const auto options = std::make_shared<PhotometricCommandOptions>();
  auto* command = calibrate.add_subcommand("photometric", "Response, vignetting, gain between two cameras");
  command->add_option("--images", options->one.series, "Folder: a still scene at several exposure times")->reads();
  command->add_option("--flat", options->one.flat, "Folder: an evenly lit surface that fills the image")->reads();
  command->add_option("--left", options->left.series, "The same for a pair: left series")->reads();
  command->add_option("--right", options->right.series, "Right series")->reads();
  command->add_option("--left-flat", options->left.flat, "Left flat field; the gain is from the same surface in both")
      ->reads();
  command->add_option("--right-flat", options->right.flat, "Right flat field")->reads();
  command->add_option("--camera", options->one.camera, std::string("For the centre of the vignetting: ") + kLensFile)
      ->reads();
  command->add_option("--left-camera", options->left.camera, "The same of the left camera")->reads();
  command
      ->add_option("--right-camera", options->right.camera,
                   "The same of the right camera; of a result of stereo its right lens")
      ->reads();
  command->add_option("--exposures", options->exposures, "Rows 'NAME SECONDS' for all images; without: EXIF")->reads();
  add_outputs(*command, options->outputs);
  command->footer(
      "Switch automatic exposure, gain and white balance off. A flat field at several exposure times is enough\n"
      "for both response and vignetting.\n\n"
      "Example: foresight calibrate photometric --images series/ --flat flat/ --exposures exposures.txt --out "
      "photometric.yaml");
  command->callback([options, &action] { action = [options] { return run_photometric(*options); }; });
}

}  // namespace foresight
