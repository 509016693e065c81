#include "apps/calibrate/scene_command.hpp"

#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <numbers>

#include "apps/calibrate/lens_file.hpp"
#include "apps/calibrate/outputs.hpp"
#include "apps/calibrate/robot_output.hpp"
#include "calibration/camera/camera_result.hpp"
#include "calibration/placement/placement.hpp"
#include "calibration/placement/tag_views.hpp"
#include "calibration/result/html_report.hpp"
#include "common/counted.hpp"
#include "common/error.hpp"
#include "common/text.hpp"
#include "scene/scene_reader.hpp"

namespace foresight {
namespace {

constexpr double kFarPoint = 0.5;  // of the model's size: points farther from it belong to another model
constexpr double kDegrees = 180 / std::numbers::pi;

struct SceneOptions {
  std::filesystem::path points, tags, tag_corners, seen, camera, camera_poses, model;
  double sigma_px = 0.5;
  PlacementOptions placement;
  CalibrateOutputs outputs;
};

std::vector<PointPair> read_points(const SceneOptions& options) {
  if (options.points.empty() == options.tags.empty())
    throw InputError("--points", "measured points and tags are given both, or neither",
                     "give --points FILE, or --tags FILE");
  if (!options.points.empty()) return read_point_pairs(options.points);
  if (!options.tag_corners.empty()) return read_tag_pairs(options.tags, options.tag_corners);
  if (options.seen.empty() || options.camera.empty() || options.camera_poses.empty())
    throw InputError("--tag-corners", "it is not known where the tags are in the world",
                     "give --tag-corners FILE, or --seen, --camera and --camera-poses");
  const LensInFile lens = read_lens_file(options.camera);
  if (!lens.note.empty()) print_notes({lens.note});
  return triangulate_tags(options.tags, read_seen_corners(options.seen), read_image_poses(options.camera_poses),
                          to_lens(lens.camera), options.sigma_px);
}

// Points that cannot be points of this model: it is another one, or in another unit.
void require_near(const SceneModel& model, const std::vector<PointPair>& points) {
  Eigen::AlignedBox3d box;
  const std::vector<Pose> poses = model.rest_poses();
  for (std::size_t i = 0; i < poses.size(); ++i)
    for (const auto& v : model.nodes()[i].mesh.vertices) box.extend(poses[i] * v.cast<double>());
  for (const PointPair& p : points)
    if (const double d = box.exteriorDistance(p.p_model); d > kFarPoint * model.diagonal())
      throw InputError(
          p.name,
          "lies " + readable(d, 2) + " m outside of the model, which is " + readable(model.diagonal(), 2) + " m large",
          "give points of this model, in metres");
}

HtmlReport report_of(const std::vector<PointPair>& points, const PlacementSummary& s) {
  HtmlReport report("Placement of a model in the world");
  report.paragraph(counted(points.size(), "point") + ", " + readable(1000 * s.rms_m, 1, " mm") + " RMS; " +
                   readable(1000 * s.loo_m, 1, " mm") + " on points left out.");
  for (const std::string& warning : s.warnings) report.paragraph("Warning: " + warning + ".");
  std::vector<std::vector<std::string>> rows;
  HtmlReport::Series series{"points", {}, false};
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Eigen::Vector3d d = s.T_world_model * points[i].p_model - points[i].p_world;
    rows.push_back({points[i].name, readable(1000 * d.x(), 1), readable(1000 * d.y(), 1), readable(1000 * d.z(), 1),
                    readable(1000 * s.residual_m[i], 1)});
    series.points.emplace_back(static_cast<double>(i + 1), 1000 * s.residual_m[i]);
  }
  report.plot("Distance of each point", "point", "mm", {series});
  report.table({"point", "x, mm", "y, mm", "z, mm", "distance, mm"}, rows);
  return report;
}

Deliverable deliverable(const std::vector<PointPair>& points, const PlacementSummary& s) {
  Deliverable out;
  const bool scored = std::isfinite(s.loo_m);
  out.verdict = s.verdict;
  out.header = {"scene",
                {},
                {},
                scored ? "loo_m" : "rms_of_three_m",
                scored ? s.loo_m : s.rms_m,
                {{"position_m", s.sigma_position_m}, {"rotation_rad", s.sigma_rotation_rad}}};
  out.payload["T_world_model"] = to_yaml(s.T_world_model);
  out.report = [&] { return report_of(points, s); };
  return out;
}

int run_scene(const SceneOptions& options) {
  const std::vector<PointPair> points = read_points(options);
  if (!options.model.empty()) require_near(read_scene(options.model, options.model.parent_path()), points);
  const PlacementSummary s = place_model(points, options.placement);
  YAML::Node pose;
  pose["pose"] = to_yaml(s.T_world_model);
  std::cout << counted(points.size(), "point") << " fit to " << readable(1000 * s.rms_m, 1, " mm") << " RMS, "
            << readable(1000 * s.loo_m, 1, " mm") << " on points left out; position to "
            << readable(1000 * s.sigma_position_m, 1, " mm") << ", rotation to "
            << readable(kDegrees * s.sigma_rotation_rad, 2, " degrees") << "\nfor the node in scene.yaml:\n"
            << pose << "\n";
  for (const std::string& warning : s.warnings) std::cerr << "warning: " << warning << "\n";
  nlohmann::ordered_json numbers{{"points", points.size()},
                                 {"rms_mm", 1000 * s.rms_m},
                                 {"scale", s.scale},
                                 {"sigma_position_mm", 1000 * s.sigma_position_m},
                                 {"sigma_rotation_deg", kDegrees * s.sigma_rotation_rad},
                                 {"warnings", s.warnings}};
  if (std::isfinite(s.loo_m)) numbers["loo_mm"] = 1000 * s.loo_m;
  for (const double r : s.residual_m) numbers["residual_mm"].push_back(1000 * r);
  const Eigen::Matrix4d T = s.T_world_model.matrix();
  for (int i = 0; i < 16; ++i) numbers["T_world_model"].push_back(T(i / 4, i % 4));
  return deliver(deliverable(points, s), numbers, options.outputs);
}

}  // namespace

void add_scene(Command& calibrate, std::function<int()>& action) {
  const auto options = std::make_shared<SceneOptions>();
  auto* command = calibrate.add_subcommand("scene", "Places a model in the world from measured points or tags");
  command->add_option("--points", options->points, "Rows 'x y z X Y Z [sigma]': model, world, in metres")->reads();
  command->add_option("--tags", options->tags, "Rows 'id corner x y z': tag corners in the model")->reads();
  command->add_option("--tag-corners", options->tag_corners, "The same corners in the world")->reads();
  command->add_option("--seen", options->seen, "Instead: rows 'image id corner u v', found in images")->reads();
  command->add_option("--camera", options->camera, std::string("With --seen: ") + kLensFile)->reads();
  command
      ->add_option("--camera-poses", options->camera_poses,
                   "With --seen: rows 'image tx ty tz qx qy qz qw', camera to world")
      ->reads();
  command->add_option("--sigma-px", options->sigma_px, "With --seen: standard deviation of a corner")
      ->check(from_to(1e-3, 20.0))
      ->capture_default_str();
  command->add_option("--model", options->model, "Mesh or scene.yaml: checks that the points can be its points")
      ->reads();
  command->add_option("--sigma-m", options->placement.sigma_m, "Standard deviation of a measured coordinate")
      ->check(from_to(1e-6, 1.0))
      ->capture_default_str();
  add_outputs(*command, options->outputs);
  command->footer(
      "The model is turned and moved, never scaled. Points that do not fit are refused by name.\n\n"
      "Example: foresight calibrate scene --points measured.txt --model table.ply --out table_pose.yaml");
  command->callback([options, &action] { action = [options] { return run_scene(*options); }; });
}

}  // namespace foresight
