#include "apps/calibrate/export_command.hpp"

#include <fmt/core.h>

#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>

#include "apps/calibrate/outputs.hpp"
#include "calibration/camera/camera_result.hpp"
#include "calibration/formats/camera_formats.hpp"
#include "calibration/formats/urdf_offsets.hpp"
#include "calibration/result/html_report.hpp"
#include "calibration/robot/pan_tilt.hpp"
#include "common/atomic_file.hpp"
#include "common/counted.hpp"
#include "common/error.hpp"
#include "common/text.hpp"
#include "scene/files.hpp"

namespace foresight {
namespace {

constexpr const char* kLeftLink = "left_camera";
constexpr const char* kRightLink = "right_camera";

struct ExportOptions {
  std::filesystem::path input;
  std::string from = "result";
  std::string to;
  std::filesystem::path urdf;  // empty: a new one
  std::string link;            // of it, to which the mount or head is attached
  std::vector<std::string> joints{"pan", "tilt"};
  CalibrateOutputs outputs;
};

struct Source {
  std::optional<CalibratedCameras> cameras;
  UrdfOffsets offsets;
  std::map<std::string, std::string> devices;
  std::vector<std::string> notes;  // of what is lost
};

// Results of arms and heads name what a URDF takes: joint_offsets: {NAME: rad or m}, and
// mounts: [{parent: LINK, child: LINK, pose: {...}}].
UrdfOffsets read_offsets(const YamlMap& result) {
  UrdfOffsets offsets;
  if (result.has("joint_offsets")) {
    const YamlMap joints = result.map("joint_offsets");
    for (const std::string& name : joints.keys()) offsets.joints[name] = joints.number(name);
  }
  if (result.has("mounts"))
    for (const YamlMap& mount : result.maps("mounts"))
      offsets.mounts.push_back({mount.text("parent"), mount.text("child"), mount.pose("pose")});
  return offsets;
}

void add_pair(Source& source) {
  if (source.cameras && source.cameras->pair())
    source.offsets.mounts.push_back({kLeftLink, kRightLink, source.cameras->T_left_right});
}

/// A head stands in the world in which its tags or poses were measured; in a URDF, that is the link it hangs on.
void add_head(const YamlMap& result, Source& source) {
  const PanTiltModel model = read_pan_tilt(result);
  UrdfHead head;
  head.parent = "world";
  head.T_parent_pan = model.T_world_pan;
  head.T_pan_tilt.translate(Eigen::Vector3d(model.length_m, 0, 0));
  head.T_pan_tilt.rotate(Eigen::AngleAxisd(model.twist_rad, Eigen::Vector3d::UnitX()));
  head.T_tilt_camera = model.T_tilt_camera;
  head.camera = kLeftLink;
  source.offsets.head = head;
  for (const std::size_t joint : {0u, 1u}) {
    const std::string name = joint == 0 ? "pan" : "tilt";
    if (model.gain[joint] != 1)
      source.notes.push_back("a URDF cannot hold the gain of " + name + ", " + readable(model.gain[joint], 5));
    if (model.backlash_rad[joint] != 0)
      source.notes.push_back("a URDF cannot hold the backlash of " + name + ", " +
                             readable(1000 * model.backlash_rad[joint], 2, " mrad"));
  }
}

Source read_result_source(const std::filesystem::path& file) {
  const std::string kind = YamlMap::load(file).text("kind");
  const ResultFile result = read_result(file, kind);
  Source source;
  source.devices = result.header.devices;
  if (kind == "intrinsics" || kind == "stereo") {
    source.cameras = read_calibrated_cameras(result.result);
  } else if (kind == "display") {
    source.cameras = CalibratedCameras{{read_camera(result.result.map("panel"))}, Pose::Identity()};
  } else if (kind == "pan-tilt") {
    add_head(result.result, source);
  } else {
    if (result.result.has("camera"))
      source.cameras = CalibratedCameras{{read_camera(result.result.map("camera"))}, Pose::Identity()};
    source.offsets = read_offsets(result.result);
  }
  add_pair(source);
  return source;
}

Source read_source(const ExportOptions& options) {
  if (options.from == "result") return read_result_source(options.input);
  if (options.from == "urdf") {
    const UrdfMount mount = read_mount(read_file(options.input), kRightLink, options.input.string());
    Source source;
    source.offsets.mounts = {mount};
    return source;
  }
  Source source;
  source.cameras = read_cameras(parse_camera_format(options.from), options.input);
  add_pair(source);
  return source;
}

const CalibratedCameras& cameras_of(const Source& source, const ExportOptions& options) {
  if (!source.cameras)
    throw InputError(options.input.string(), "it holds no lens",
                     "give a result of `calibrate intrinsics`, `stereo` or `arm`, or use --to urdf");
  return *source.cameras;
}

/// "2.3e-13 px": rounding of the numbers, as a rule.
std::string px_text(double px) {
  return fmt::format("{:.1e} px", px);
}

ExportSummary write_urdf(const Source& source, const ExportOptions& options) {
  const std::filesystem::path& out = *options.outputs.out;
  if (std::filesystem::exists(out) && !options.outputs.force)
    throw InputError(out.string(), "it exists", "write to another place, or give --force to replace it");
  if (source.offsets.mounts.empty() && source.offsets.joints.empty() && !source.offsets.head)
    throw InputError(options.input.string(), "it holds nothing that a URDF takes",
                     "give a result of `calibrate stereo`, `arm` or `pan-tilt`");
  if (!options.link.empty() && options.urdf.empty())
    throw InputError("--link", "there is no robot that has it", "give --urdf ROBOT.urdf");
  if (options.urdf.empty() && !source.offsets.joints.empty())
    throw InputError("--urdf", "joint offsets need the robot that they belong to", "give --urdf ROBOT.urdf");
  UrdfOffsets offsets = source.offsets;
  if (offsets.head) offsets.head->joints = {options.joints.at(0), options.joints.at(1)};
  const auto root = [&] { return offsets.head ? offsets.head->parent : offsets.mounts.front().parent; };
  const std::string before = options.urdf.empty() ? empty_urdf(root()) : read_file(options.urdf);
  const std::string where = options.urdf.empty() ? options.input.string() : options.urdf.string();
  if (!options.link.empty()) {
    for (UrdfMount& mount : offsets.mounts) mount = attached(mount, options.link, before, where);
    if (offsets.head) offsets.head->parent = options.link;
  }
  const std::string text = with_offsets(before, offsets, where);
  ExportSummary summary{{out}, 0, 0};
  for (const UrdfMount& mount : offsets.mounts) {
    const Pose back = read_mount(text, mount.child, out.string()).T_parent_child;
    if (!source.cameras || !source.cameras->pair()) continue;
    CalibratedCameras as_read = *source.cameras;
    as_read.T_left_right = back;
    summary.rays = kRays;
    summary.worst_px = worst_ray(*source.cameras, as_read, kRays);
  }
  if (!(summary.worst_px <= kMostPx))
    throw RuntimeFailure("the URDF would differ by " + px_text(summary.worst_px), "report this");
  write_file_atomically(out, text);
  return summary;
}

// Its score is named so that no solver's score is ever compared with it.
ExportSummary write_own(const Source& source, const ExportOptions& options) {
  const CalibratedCameras& cameras = cameras_of(source, options);
  ResultHeader header;
  header.kind = cameras.pair() ? "stereo" : "intrinsics";
  header.date = utc_now();
  header.devices = source.devices;
  header.score_name = "imported_not_measured";
  const YAML::Node payload = to_yaml(cameras);
  const CalibratedCameras read = read_calibrated_cameras(YamlMap::parse(*options.outputs.out, YAML::Dump(payload)));
  const ExportSummary summary{{*options.outputs.out}, kRays, worst_ray(cameras, read, kRays)};
  if (!(summary.worst_px <= kMostPx)) throw RuntimeFailure("the result does not read back", "report this");
  write_result(*options.outputs.out, header, payload, options.outputs.force);
  return summary;
}

std::vector<std::vector<std::string>> lens_rows(const CalibratedCameras& cameras) {
  std::vector<std::vector<std::string>> rows;
  for (const CameraModel& camera : cameras.cameras)
    rows.push_back({rows.empty() ? "left" : "right", to_string(camera.distortion),
                    std::to_string(camera.width) + " x " + std::to_string(camera.height),
                    readable(camera.lens[0], 3, " px"), readable(camera.lens[1], 3, " px"),
                    readable(camera.lens[2], 3, " px"), readable(camera.lens[3], 3, " px")});
  return rows;
}

void write_report(const Source& source, const ExportOptions& options, const ExportSummary& summary) {
  if (!options.outputs.report) return;
  HtmlReport report("Export to " + options.to);
  report.paragraph(counted(summary.rays, "ray") + " per camera, read back from the files, differ by at most " +
                   px_text(summary.worst_px) + ".");
  std::vector<std::vector<std::string>> files;
  for (const auto& file : summary.files) files.push_back({file.string()});
  report.table({"file"}, files);
  if (source.cameras)
    report.table({"camera", "lens model", "size", "fx", "fy", "cx", "cy"}, lens_rows(*source.cameras));
  report.write(*options.outputs.report);
}

int run_export(const ExportOptions& options) {
  if (!options.outputs.out) throw InputError("--out", "is missing", "name the file or folder to write");
  const Source source = read_source(options);
  const ExportSummary summary = options.to == "urdf" ? write_urdf(source, options)
                                : options.to == "result"
                                    ? write_own(source, options)
                                    : write_cameras(parse_camera_format(options.to), cameras_of(source, options),
                                                    *options.outputs.out, options.outputs.force);
  nlohmann::ordered_json numbers{
      {"from", options.from}, {"to", options.to}, {"rays", summary.rays}, {"worst_px", summary.worst_px}};
  for (const auto& file : summary.files) {
    numbers["files"].push_back(file.string());
    std::cout << file.string() << "\n";
  }
  for (const std::string& note : source.notes) std::cout << "note: " << note << "\n";
  if (summary.rays > 0)
    std::cout << counted(summary.rays, "ray") << " per camera agree within " << px_text(summary.worst_px) << "\n";
  write_json(options.outputs.json, numbers);
  write_report(source, options, summary);
  return 0;
}

std::vector<Output> outputs_of(const ExportOptions& options, const std::filesystem::path& out) {
  if (options.to == "result") return {{out, Output::Kind::file, result_form()}};
  const auto refuse = [force = options.outputs.force](const std::string& where, const std::filesystem::path&) {
    if (!force) throw InputError(where, "exists", "write to another place, or give --force to replace it");
  };
  return {{out, Output::Kind::either, {}, refuse}};
}

}  // namespace

void add_export(Command& calibrate, std::function<int()>& action) {
  const auto options = std::make_shared<ExportOptions>();
  auto* command = calibrate.add_subcommand("export", "Writes a calibration for other programs, and reads theirs");
  command->add_option("INPUT", options->input, "Result file, or what --from names")->reads()->required();
  command->add_option("--to", options->to, "camera-info, kalibr, opencv, mrcal, urdf, or result")
      ->required()
      ->check(one_of({"camera-info", "kalibr", "opencv", "mrcal", "urdf", "result"}));
  command->add_option("--from", options->from, "Format of INPUT: one of the same")
      ->capture_default_str()
      ->check(one_of({"camera-info", "kalibr", "opencv", "mrcal", "urdf", "result"}));
  command->add_option("--urdf", options->urdf, "With --to urdf: the robot to correct; else a new file")->reads();
  command->add_option("--link", options->link,
                      "With --urdf: its link that carries the camera, the pair's left camera or the head, where the\n"
                      "result knows it by another name, or one that is fixed to it");
  command->add_option("--joint-names", options->joints, "With --to urdf, of a head: its joints")
      ->expected(2)
      ->capture_default_str();
  add_outputs(*command, options->outputs,
              [options](const std::filesystem::path& out) { return outputs_of(*options, out); });
  command->footer(
      "A pair becomes a folder with camera-info and mrcal, one file with the others. What is written is read\n"
      "back, and 1,000 rays per camera must meet the same pixels within 1e-6 px.\n\n"
      "Examples:\n"
      "  foresight calibrate export stereo.yaml --to kalibr --out camchain.yaml\n"
      "  foresight calibrate export camchain.yaml --from kalibr --to mrcal --out models/\n"
      "  foresight calibrate export arm.yaml --to urdf --urdf robot.urdf --link tool0 --out robot_calibrated.urdf\n"
      "  foresight calibrate export arm.yaml --to camera-info --out camera.yaml\n"
      "  foresight calibrate export head.yaml --to urdf --urdf robot.urdf --link torso --out robot_calibrated.urdf");
  command->callback([options, &action] { action = [options] { return run_export(*options); }; });
}

}  // namespace foresight
