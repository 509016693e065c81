#include "apps/calibrate/pan_tilt_input.hpp"

#include "apps/calibrate/lens_file.hpp"
#include "calibration/robot/hand_eye_start.hpp"
#include "calibration/robot/robot_poses.hpp"
#include "calibration/target/corner_files.hpp"
#include "calibration/target/image_input.hpp"
#include "common/counted.hpp"
#include "common/error.hpp"
#include "common/text.hpp"
#include "scene/text_table.hpp"
#include "scene/yaml_fields.hpp"

namespace foresight {
namespace {

PanTiltAngles angles_of(const std::filesystem::path& file, const FieldRow& row) {
  const std::size_t n = row.fields.size(), first = n == 3 || n == 5 ? 1 : 0;
  if (n < 2 || n > 5)
    throw InputError(at_line(file, row.line), "has " + counted(n, "field"),
                     "write [name] pan tilt [pan_way tilt_way], rad, ways +1 or -1");
  PanTiltAngles angles;
  double* const places[] = {&angles.pan, &angles.tilt};
  for (std::size_t i = 0; i < n - first; ++i) {
    const auto value = parse_number(row.fields[first + i]);
    if (!value || !std::isfinite(*value))
      throw InputError(at_line(file, row.line), in_quotes(row.fields[first + i]) + " is not a number",
                       "write angles in rad");
    if (i < 2)
      *places[i] = *value;
    else
      angles.came[i - 2] = *value > 0 ? 1 : (*value < 0 ? -1 : 0);
  }
  if (std::max(std::abs(angles.pan), std::abs(angles.tilt)) > 20)
    throw InputError(at_line(file, row.line), "an angle is beyond 20 rad", "write angles in rad, not degrees");
  return angles;
}

struct NamedAngles {
  std::string name;
  PanTiltAngles angles;
};

std::vector<NamedAngles> read_angles(const std::optional<std::filesystem::path>& file) {
  if (!file)
    throw InputError("--angles", "no joint angles are given", "give --angles FILE, rows [name] pan tilt in rad");
  std::vector<FieldRow> rows = read_field_rows(*file);
  if (!rows.empty() && !parse_number(rows[0].fields.back())) rows.erase(rows.begin());
  std::vector<NamedAngles> out;
  for (const FieldRow& row : rows)
    out.push_back({row.fields.size() % 2 == 1 ? row.fields[0] : "", angles_of(*file, row)});
  return out;
}

std::vector<PanTiltSample> from_yaml(const std::filesystem::path& file) {
  const YamlMap top = YamlMap::load(file);
  std::vector<PanTiltSample> samples;
  for (const std::string& name : top.keys()) {
    const YamlMap entry = top.map(name), pose = entry.map("pose");
    std::vector<double> joints;
    for (const char* key : {"camera_joints", "target_joints"})
      if (joints.empty() && entry.has(key)) joints = entry.numbers(key);
    if (joints.size() != 2)
      throw InputError(entry.where("target_joints"), "has " + counted(joints.size(), "angle"),
                       "write pan and tilt, rad");
    PanTiltSample sample{name, {joints[0], joints[1], {}}, Pose::Identity()};
    const Eigen::Vector4d q(pose.number("qx"), pose.number("qy"), pose.number("qz"), pose.number("qw"));
    sample.T_world_camera =
        checked_pose({pose.number("x"), pose.number("y"), pose.number("z")}, q, entry.where("pose"));
    samples.push_back(std::move(sample));
  }
  return samples;
}

std::vector<PanTiltSample> from_views(const PanTiltInput& input, std::vector<std::string>& notes) {
  if (!input.camera)
    throw InputError("--camera", "is missing", "give the camera's calibrated lens for poses from views");
  std::optional<Board> board;
  if (!input.board.empty()) board = parse_board(input.board);
  CornerSet corners;
  std::vector<std::string> images;
  if (input.images) {
    if (!board) throw InputError("--board", "is missing", "name the board in the images");
    FoundCorners found = find_in_folder(*input.images, *board);
    for (const DroppedView& dropped : found.dropped)
      notes.push_back("view " + dropped.name + " is left out: " + dropped.reason);
    for (const auto& image : list_images(*input.images)) images.push_back(image.stem().string());
    corners = std::move(found.corners);
  } else {
    corners = read_corners(*input.corners, board);
    for (const BoardView& view : corners.views) images.push_back(view.name);
  }
  const std::vector<PanTiltAngles> angles = read_angles_of(input.angles, images);
  const LensInFile lens = read_lens_file(*input.camera);
  if (!lens.note.empty()) notes.push_back(lens.note);
  std::vector<PanTiltSample> samples;
  for (const BoardView& view : corners.views) {
    const auto at = std::find(images.begin(), images.end(), view.name) - images.begin();
    samples.push_back({view.name, angles[static_cast<std::size_t>(at)],
                       board_pose(lens.camera, corners.p_board, view).T_camera_board.inverse()});
  }
  return samples;
}

std::vector<PanTiltSample> from_files(const PanTiltInput& input, std::vector<std::string>& notes) {
  const RobotPoses read = read_robot_poses(*input.poses, PoseUnit::automatic);
  notes.insert(notes.end(), read.notes.begin(), read.notes.end());
  const std::vector<NamedAngles> angles = read_angles(input.angles);
  if (angles.size() != read.poses.size())
    throw InputError("--angles", counted(angles.size(), "row") + " for " + counted(read.poses.size(), "pose"),
                     "give one row a pose");
  std::vector<PanTiltSample> samples;
  for (std::size_t i = 0; i < angles.size(); ++i)
    samples.push_back({read.poses[i].name, angles[i].angles, read.poses[i].pose});
  return samples;
}

}  // namespace

std::vector<PanTiltAngles> read_angles_of(const std::optional<std::filesystem::path>& file,
                                          const std::vector<std::string>& images) {
  const std::vector<NamedAngles> rows = read_angles(file);
  const auto of = [&](const std::string& image) {
    return std::find_if(rows.begin(), rows.end(), [&](const NamedAngles& row) {
      return row.name == image || std::filesystem::path(row.name).stem() == image;
    });
  };
  std::vector<PanTiltAngles> out;
  const bool by_name =
      std::all_of(images.begin(), images.end(), [&](const std::string& image) { return of(image) != rows.end(); });
  if (!by_name && rows.size() != images.size())
    throw InputError("--angles", counted(rows.size(), "row") + " for " + counted(images.size(), "image"),
                     "give one row an image");
  for (std::size_t i = 0; i < images.size(); ++i) out.push_back(by_name ? of(images[i])->angles : rows[i].angles);
  return out;
}

std::vector<PanTiltSample> read_pan_tilt_samples(const PanTiltInput& input, std::vector<std::string>& notes) {
  std::vector<PanTiltSample> samples;
  if (input.images || input.corners) {
    samples = from_views(input, notes);
  } else if (input.poses) {
    const std::string extension = input.poses->extension().string();
    const bool holds_angles =
        !input.angles && !std::filesystem::is_directory(*input.poses) && (extension == ".yaml" || extension == ".yml");
    samples = holds_angles ? from_yaml(*input.poses) : from_files(input, notes);
  } else {
    throw InputError("--poses", "neither poses nor views are given", "give --poses, --images or --corners");
  }
  if (input.in_order) came_from_order(samples);
  return samples;
}

}  // namespace foresight
