#include "apps/calibrate/pan_tilt_tag_command.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "apps/calibrate/head_drawing.hpp"
#include "apps/calibrate/robot_output.hpp"
#include "apps/calibrate/view_pictures.hpp"
#include "calibration/robot/robot_results.hpp"
#include "common/counted.hpp"
#include "common/text.hpp"

namespace foresight {
namespace {

constexpr double kMoves = 0.02;           // rad/s: a head that moves tells the offset of the clocks
constexpr std::size_t kFewestMoving = 8;  // views
constexpr double kSettled = 1e-4;         // s
constexpr int kRounds = 8;
constexpr std::size_t kMostTagPictures = 12;

struct Solved {
  PanTiltTagSummary summary;
  std::optional<double> offset_s;  // nothing where the clocks were not compared
};

bool moves(const std::vector<PanTiltView>& views) {
  std::size_t moving = 0;
  for (const PanTiltView& view : views) moving += std::max(std::abs(view.rate[0]), std::abs(view.rate[1])) > kMoves;
  return moving >= kFewestMoving;
}

/// Encoders are read at the offset that was found, until it stays.
Solved solve(const TagViews& all, const PanTiltTagCommand& command) {
  PanTiltTagOptions options = command.solver;
  if (command.time) {
    const double offset = read_result(*command.time, "time").result.number("offset_s");
    return {solve_pan_tilt_tags(views_at(all, offset), all.cameras, options), offset};
  }
  double offset = 0;
  options.offset = all.encoders && moves(views_at(all, 0));
  if (!options.offset) return {solve_pan_tilt_tags(views_at(all, 0), all.cameras, options), std::nullopt};
  PanTiltTagOptions quick = options;
  quick.score = false;
  for (int round = 0; round < kRounds; ++round) {
    const double step = solve_pan_tilt_tags(views_at(all, offset), all.cameras, quick).offset_s;
    offset += step;
    if (std::abs(step) < kSettled) break;
  }
  Solved out{solve_pan_tilt_tags(views_at(all, offset), all.cameras, options), {}};
  out.offset_s = offset + out.summary.offset_s;
  return out;
}

nlohmann::ordered_json numbers_of(const Solved& solved) {
  const PanTiltTagSummary& s = solved.summary;
  const PanTiltModel& m = s.model;
  nlohmann::ordered_json out;
  out["loo_px"] = s.loo_px, out["in_sample_px"] = s.in_sample_px;
  out["views"] = s.view_names.size(), out["tags"] = s.tags, out["rejected_points"] = s.rejected_points;
  out["corner_px"] = s.corner_px, out["shaft_mrad"] = 1e3 * s.shaft_rad;
  if (solved.offset_s) out["offset_s"] = *solved.offset_s;
  const auto sigmas = sigmas_of(s);
  if (const auto sigma = sigmas.find("offset_s"); sigma != sigmas.end()) out["offset_sigma_s"] = sigma->second;
  out["model"] = {
      {"T_world_pan", json_of(m.T_world_pan)},     {"length_m", m.length_m}, {"twist_rad", m.twist_rad},
      {"T_tilt_camera", json_of(m.T_tilt_camera)}, {"gain", m.gain},         {"backlash_rad", m.backlash_rad}};
  out["pose_sigma"] = std::vector<double>(s.pose_sigma.begin(), s.pose_sigma.end());
  out["sigmas"] = sigmas;
  out["loo_view_px"] = s.loo_view_px;
  out["notes"] = s.notes;
  return out;
}

void show_pictures(const Solved& solved, const TagViews& all, HtmlReport& report) {
  const std::vector<PanTiltView> views = views_at(all, solved.offset_s.value_or(0));
  const std::vector<int> number = view_numbers(solved.summary.view_names);
  std::vector<HtmlReport::Picture> pictures;
  for (const std::size_t i : some_of(solved.summary.view_names.size(), kMostTagPictures)) {
    const auto view = std::find_if(views.begin(), views.end(),
                                   [&](const PanTiltView& v) { return v.name == solved.summary.view_names[i]; });
    const auto files = all.files.find(solved.summary.view_names[i]);
    if (view == views.end() || files == all.files.end()) continue;
    const auto predicted = predicted_corners(all.cameras, camera_pose(solved.summary.model, view->angles), *view);
    std::array<std::vector<ShownPoint>, 2> points;
    for (std::size_t k = 0; k < predicted.size(); ++k)
      points[static_cast<std::size_t>(view->tags[k / 4].camera)].push_back(
          {view->tags[k / 4].pixels[k % 4], predicted[k].value_or(Eigen::Vector2d::Constant(NAN))});
    for (std::size_t side = 0; side < 2; ++side)
      if (!points[side].empty() && !files->second[side].empty())
        pictures.push_back({draw_view(files->second[side], points[side]),
                            std::to_string(number[i]) + (all.cameras.pair() ? (side == 0 ? ", left" : ", right") : ""),
                            view->name + ": left out " + readable(solved.summary.loo_view_px[i], 2, " px")});
  }
  if (pictures.empty()) return;
  report.heading("Pictures");
  report.paragraph("Rings: corners of tags as found. Lines: to where the encoders alone have them, " +
                   readable(kArrow, 0) + " times too long.");
  report.pictures(pictures);
}

void list_views(const PanTiltTagSummary& s, HtmlReport& report) {
  const std::vector<int> number = view_numbers(s.view_names);
  std::vector<std::vector<std::string>> rows;
  for (std::size_t i = 0; i < s.view_names.size(); ++i)
    rows.push_back({std::to_string(number[i]), s.view_names[i], readable(s.angles[i].pan, 4),
                    readable(s.angles[i].tilt, 4), i < s.loo_view_px.size() ? readable(s.loo_view_px[i], 2) : "-"});
  report.heading("Views");
  report.table({"view", "name", "pan / rad", "tilt / rad", "left out / px"}, rows);
}

HtmlReport report_of(const Solved& solved, const TagViews& all) {
  const PanTiltTagSummary& s = solved.summary;
  HtmlReport report("Pan-tilt calibration from tags");
  report.table({"", ""},
               {{"error of corners by encoders alone, views left out, RMS px", readable(s.loo_px, 3)},
                {"error in sample, RMS px", readable(s.in_sample_px, 3)},
                {"noise of a corner, px", readable(s.corner_px, 3)},
                {"noise of a shaft, mrad", readable(1e3 * s.shaft_rad, 3)},
                {"views, tags in images", std::to_string(s.view_names.size()) + ", " + std::to_string(s.tags)},
                {"corners left out", std::to_string(s.rejected_points)},
                {"t_encoder - t_camera, ms", solved.offset_s ? readable(1e3 * *solved.offset_s, 2) : "-"}});
  report_notes(report, s.notes);
  report_model(report, s.model);
  DrawnHead head{s.model, s.angles};
  const CameraModel& left = all.cameras.left();
  head.tan_x = left.width / (2 * left.lens[0]), head.tan_y = left.height / (2 * left.lens[1]);
  for (const auto& [id, corners] : all.map) head.tags.push_back(corners);
  report.drawing("Where everything stands", head_svg(head));
  HtmlReport::Series pan{"left out", {}, false}, tilt{"left out", {}, false};
  for (std::size_t i = 0; i < s.loo_view_px.size(); ++i) {
    pan.points.emplace_back(s.angles[i].pan, s.loo_view_px[i]);
    tilt.points.emplace_back(s.angles[i].tilt, s.loo_view_px[i]);
  }
  report.plot("Error of each view when it is left out, over pan", "pan / rad", "px", {pan});
  report.plot("Error of each view when it is left out, over tilt", "tilt / rad", "px", {tilt});
  show_pictures(solved, all, report);
  list_views(s, report);
  report_sigmas(report, sigmas_of(s));
  return report;
}

void print(const Solved& solved) {
  const PanTiltTagSummary& s = solved.summary;
  std::cout << "corners by encoders alone, views left out  " << readable(s.loo_px, 3) << " px RMS\n"
            << "corners in sample                          " << readable(s.in_sample_px, 3) << " px RMS\n"
            << counted(s.view_names.size(), "view") << ", " << counted(s.tags, "tag") << " in images, "
            << counted(s.rejected_points, "corner") << " left out; noise " << readable(s.corner_px, 3)
            << " px a corner, " << readable(1e3 * s.shaft_rad, 3) << " mrad a shaft\n"
            << "axes " << readable(1e3 * s.model.length_m, 2) << " mm apart, "
            << readable(s.model.twist_rad * 57.29577951, 3) << " degrees between them; backlash pan "
            << readable(1e3 * s.model.backlash_rad[0], 3) << " mrad, tilt "
            << readable(1e3 * s.model.backlash_rad[1], 3) << " mrad\n";
  if (solved.offset_s)
    std::cout << "t_encoder = t_camera " << (*solved.offset_s < 0 ? "- " : "+ ")
              << readable(1e3 * std::abs(*solved.offset_s), 2) << " ms\n";
}

}  // namespace

void add_tag_options(Command& command, PanTiltTagInput& input) {
  command
      .add_option("--tags", input.tags,
                  "Map of tags that stand still: rows id corner x y z, world, m (tags.txt of RUN)")
      ->reads();
  command.add_option("--run", input.run, "A recorded run and its joints (RUN-joints.csv), instead of images")->reads();
  command.add_option("--joints", input.joints, "The joints of the run: rows time and positions, after a row of names")
      ->reads();
  command.add_option("--joint-names", input.joint_names, "Of pan and tilt in that row")
      ->expected(2)
      ->capture_default_str();
  command.add_option("--right", input.right, "Pictures of the right camera, as many as --images has")->reads();
  command.add_option("--camera-right", input.camera_right, "The right camera's lens (camera_info with T_left_right)")
      ->reads();
  command
      .add_option("--photometric", input.photometric,
                  "Result of `calibrate photometric`: corners of tags are found in the light")
      ->reads();
  command.add_option("--family", input.family, "Of the tags")->capture_default_str();
  command.add_option("--most-views", input.most_views, "Of a run, spread over its time")
      ->check(from_to(8, 2000))
      ->capture_default_str();
}

int calibrate_from_tags(PanTiltTagCommand& command) {
  const TagViews all = read_tag_views(command.input);
  Solved solved = solve(all, command);
  solved.summary.notes.insert(solved.summary.notes.begin(), all.notes.begin(), all.notes.end());
  print(solved);
  print_notes(solved.summary.notes);
  nlohmann::ordered_json numbers = numbers_of(solved);
  ResultHeader header{"pan-tilt", {}, {}, "loo_px", solved.summary.loo_px, sigmas_of(solved.summary)};
  header.views = prints_of(all.views);
  return deliver({solved.summary.verdict, header, to_yaml(solved.summary, solved.offset_s),
                  [&] { return report_of(solved, all); }},
                 numbers, command.outputs);
}

}  // namespace foresight
