#include "apps/calibrate/display_command.hpp"

#include <algorithm>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <opencv2/imgproc.hpp>

#include "apps/calibrate/lens_file.hpp"
#include "apps/calibrate/outputs.hpp"
#include "apps/calibrate/robot_output.hpp"
#include "calibration/camera/camera_result.hpp"
#include "calibration/display_lens/panel_pattern.hpp"
#include "calibration/result/html_report.hpp"
#include "common/atomic_file.hpp"
#include "common/counted.hpp"
#include "common/error.hpp"
#include "common/text.hpp"
#include "pictures/encode.hpp"
#include "pictures/picture_file.hpp"
#include "scene/files.hpp"

namespace foresight {
namespace {

struct DisplayOptions {
  std::filesystem::path images, points, eye_camera, pattern_out;
  std::string pattern;
  double virtual_distance_m = 0;
  bool colours = false;
  CalibrateOutputs outputs;
};

struct Colour {
  const char* name;
  int channel;  // of an image in OpenCV's order
};
constexpr std::array<Colour, 2> kColours{{{"red", 2}, {"blue", 0}}};

struct Pictures {
  std::vector<PanelPoint> points;                     // grey, or green with --colours
  std::array<std::vector<PanelPoint>, 2> of_colours;  // as kColours
  std::vector<std::string> names, unseen;
};

cv::Mat channel_of(const cv::Mat& image, int channel) {
  cv::Mat out;
  cv::extractChannel(image, out, channel);
  return out;
}

Pictures find_all(const DisplayOptions& options, const PanelPattern& pattern, const CameraModel& eye) {
  Pictures out;
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(canonical_folder(options.images)))
    if (entry.is_regular_file() && names_picture(entry.path())) files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  if (files.empty())
    throw InputError(options.images.string(), "holds no images", "name a folder of PNG or JPEG images");
  for (const auto& file : files) {
    const cv::Mat image = read_picture(file, options.colours ? PictureColours::colour : PictureColours::grey);
    if (image.cols != eye.width || image.rows != eye.height)
      throw InputError(file.string(),
                       "is " + std::to_string(image.cols) + " x " + std::to_string(image.rows) +
                           " px, the eye camera " + std::to_string(eye.width) + " x " + std::to_string(eye.height),
                       "give pictures of the calibrated camera at its full size");
    const int picture = static_cast<int>(out.names.size());
    const auto found = find_pattern(pattern, options.colours ? channel_of(image, 1) : image, picture);
    (found.empty() ? out.unseen : out.names).push_back(file.filename().string());
    out.points.insert(out.points.end(), found.begin(), found.end());
    for (std::size_t c = 0; options.colours && !found.empty() && c < kColours.size(); ++c) {
      const auto coloured = find_pattern(pattern, channel_of(image, kColours[c].channel), picture);
      out.of_colours[c].insert(out.of_colours[c].end(), coloured.begin(), coloured.end());
    }
  }
  if (out.names.empty())
    throw InputError(options.images.string(), "no picture shows the whole pattern",
                     "show a smaller board (--pattern), focus the eye camera on it, and darken the room");
  return out;
}

void write_pattern(const DisplayOptions& options, const PanelPattern& pattern) {
  const std::vector<std::uint8_t> png = encode_png(draw_pattern(pattern));
  write_file_atomically(options.pattern_out, {reinterpret_cast<const char*>(png.data()), png.size()});
  std::cout << options.pattern_out.string() << ": show it unscaled on the panel\n";
}

Deliverable deliverable(const DisplayLensSummary& s, const std::vector<std::pair<std::string, CameraModel>>& colours) {
  Deliverable out;
  out.verdict = s.verdict;
  out.header = {"display",
                {},
                {},
                "held_out_px",
                s.held_out_px,
                {{"focal_px", s.sigma_focal_px}, {"centre_px", s.sigma_centre_px}, {"tilt_rad", s.sigma_tilt_rad}}};
  out.payload["panel"] = to_yaml(s.panel);
  for (const auto& [name, lens] : colours) out.payload["colours"][name] = to_yaml(lens);
  for (const Pose& T : s.T_display_camera) out.payload["T_display_camera"].push_back(to_yaml(T));
  return out;
}

HtmlReport report_of(const DisplayOptions& options, const DisplayLensSummary& s, const std::vector<PanelPoint>& points,
                     const CameraModel& eye) {
  HtmlReport report("Lens of a head display");
  report.paragraph(counted(s.points, "point") + " in " + counted(s.T_display_camera.size(), "picture") + ", " +
                   std::to_string(s.rejected) + " rejected; " + readable(s.held_out_px, 3, " px") +
                   " of the panel on points left out, " + to_string(s.panel.distortion) + ".");
  for (const std::string& warning : s.warnings) report.paragraph("Warning: " + warning + ".");
  HtmlReport::Series residuals{"points", {}, false}, places{"points", {}, false};
  const Lens camera = to_lens(eye);
  for (const PanelPoint& p : points) {
    const auto ray = camera.unproject(p.camera_pixel);
    Eigen::Vector2d pixel;
    if (!ray || options.virtual_distance_m > 0 ||
        !project<double>(s.panel.distortion, s.panel.lens.data(),
                         s.T_display_camera[static_cast<std::size_t>(p.picture)].linear() * *ray, pixel))
      continue;
    residuals.points.push_back(pixel - p.panel_pixel);
    places.points.push_back(p.panel_pixel);
  }
  report.plot("Residuals", "x, panel px", "y, panel px", {residuals}, true);
  report.plot("Points on the panel", "x, panel px", "y, panel px", {places}, true);
  std::vector<std::vector<std::string>> rows;
  for (const auto& [model, score] : s.tried) rows.push_back({to_string(model), readable(score, 3, " px")});
  report.table({"lens model", "held-out RMS"}, rows);
  return report;
}

nlohmann::ordered_json numbers_of(const DisplayLensSummary& s) {
  nlohmann::ordered_json numbers{{"model", to_string(s.panel.distortion)},
                                 {"points", s.points},
                                 {"rejected_points", s.rejected},
                                 {"views", s.T_display_camera.size()},
                                 {"in_sample_px", s.rms_px},
                                 {"held_out_px", s.held_out_px},
                                 {"held_out_worst_px", s.held_out_worst_px},
                                 {"fx_px", s.panel.lens[0]},
                                 {"fy_px", s.panel.lens[1]},
                                 {"cx_px", s.panel.lens[2]},
                                 {"cy_px", s.panel.lens[3]},
                                 {"sigma_focal_px", s.sigma_focal_px},
                                 {"sigma_centre_px", s.sigma_centre_px},
                                 {"warnings", s.warnings}};
  for (const int i : free_parameters(s.panel.distortion))
    if (i >= 4) numbers["distortion"].push_back(s.panel.lens[static_cast<std::size_t>(i)]);
  for (const auto& [model, score] : s.tried) numbers["tried_held_out_px"][to_string(model)] = score;
  for (const Pose& T : s.T_display_camera)
    numbers["eye_position_m"].push_back({T.translation().x(), T.translation().y(), T.translation().z()});
  return numbers;
}

int run_display(const DisplayOptions& options) {
  const PanelPattern pattern = parse_pattern(options.pattern);
  if (!options.pattern_out.empty()) write_pattern(options, pattern);
  if (options.images.empty() && options.points.empty()) {
    if (options.pattern_out.empty())
      throw InputError("--images", "is missing", "give --images DIR with --eye-camera FILE, or --pattern-out FILE");
    return 0;
  }
  if (options.eye_camera.empty())
    throw InputError("--eye-camera", "is missing", "give the lens of the camera that took the pictures");
  const LensInFile lens = read_lens_file(options.eye_camera);
  if (!lens.note.empty()) print_notes({lens.note});
  const CameraModel& eye = lens.camera;
  Pictures pictures;
  if (options.points.empty())
    pictures = find_all(options, pattern, eye);
  else
    pictures.points = read_panel_points(options.points);
  for (const std::string& name : pictures.unseen)
    std::cerr << "warning: " << name << " does not show the whole pattern\n";
  DisplayLensOptions lens_options;
  lens_options.panel_width = pattern.width;
  lens_options.panel_height = pattern.height;
  if (options.virtual_distance_m > 0) lens_options.virtual_distance_m = options.virtual_distance_m;
  const DisplayLensSummary s = solve_display_lens(pictures.points, eye, lens_options);
  std::vector<std::pair<std::string, CameraModel>> colours;
  for (std::size_t c = 0; c < kColours.size(); ++c)
    if (!pictures.of_colours[c].empty())
      colours.emplace_back(kColours[c].name, solve_colour(pictures.of_colours[c], eye, s, lens_options));
  std::cout << to_string(s.panel.distortion) << ": " << readable(s.held_out_px, 3, " px")
            << " of the panel on points left out (worst " << readable(s.held_out_worst_px, 2, " px")
            << "), focal length " << readable(s.panel.lens[0], 1) << " x " << readable(s.panel.lens[1], 1, " px")
            << ", centre " << readable(s.panel.lens[2], 1) << " " << readable(s.panel.lens[3], 1, " px") << "\n";
  for (const std::string& warning : s.warnings) std::cerr << "warning: " << warning << "\n";
  nlohmann::ordered_json numbers = numbers_of(s);
  for (const auto& [name, panel] : colours) numbers["scale_" + name] = panel.lens[0] / s.panel.lens[0];
  Deliverable found = deliverable(s, colours);
  found.report = [&] { return report_of(options, s, pictures.points, eye); };
  return deliver(found, numbers, options.outputs);
}

}  // namespace

void add_display(Command& calibrate, std::function<int()>& action) {
  const auto options = std::make_shared<DisplayOptions>();
  auto* command = calibrate.add_subcommand("display", "The lens of a head display, from pictures taken through it");
  command->add_option("--pattern", options->pattern, "PANEL:CORNERS:SQUARE in pixels, such as 1440x1600:9x8:120")
      ->required();
  command->add_option("--pattern-out", options->pattern_out, "Writes what the panel has to show, a PNG")
      ->writes(png_form());
  command->add_option("--images", options->images, "Folder of pictures that the eye camera took")->reads();
  command->add_option("--corners", options->points, "Instead: rows 'picture u v panel_u panel_v'")->reads();
  command->add_option("--eye-camera", options->eye_camera, std::string("The eye camera: ") + kLensFile)->reads();
  command
      ->add_option("--virtual-distance-m", options->virtual_distance_m,
                   "Distance of the virtual image; then the eye camera's positions are found too")
      ->check(from_to(0.05, 100.0));
  command->add_flag("--colours", options->colours, "Lenses of red and blue too; pictures must be in colour");
  add_outputs(*command, options->outputs);
  command->footer(
      "Turn the eye camera between pictures to reach the edges of the panel; keep it where the eye will be.\n\n"
      "Examples:\n"
      "  foresight calibrate display --pattern 1440x1600:9x8:120 --pattern-out panel.png\n"
      "  foresight calibrate display --pattern 1440x1600:9x8:120 --images pictures/ --eye-camera eye.yaml --out "
      "left.yaml");
  command->callback([options, &action] { action = [options] { return run_display(*options); }; });
}

}  // namespace foresight
