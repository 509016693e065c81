#include "apps/calibrate/arm_input.hpp"

#include <algorithm>
#include <cmath>

#include "apps/calibrate/lens_file.hpp"
#include "apps/calibrate/run_input.hpp"
#include "calibration/result/result_file.hpp"
#include "calibration/robot/robot_poses.hpp"
#include "calibration/target/corner_files.hpp"
#include "calibration/target/image_input.hpp"
#include "common/counted.hpp"
#include "common/error.hpp"
#include "common/text.hpp"
#include "rig/rig.hpp"
#include "session/run_recorder.hpp"

namespace foresight {
namespace {

namespace fs = std::filesystem;

constexpr Duration kAround{100'000'000};  // of a picture, in which the joints must stand still
constexpr double kStill = 1e-3;           // rad or m, within that time: encoders' noise
constexpr double kSameStation = 0.02;     // rad or m: pictures that are nearer show one view
constexpr std::size_t kFewestStations = 8;

std::optional<Board> board_of(const ArmInput& input) {
  if (input.board.empty()) return std::nullopt;
  return parse_board(input.board);
}

Board required_board(const ArmInput& input) {
  const auto board = board_of(input);
  if (!board) throw InputError("--board", "is missing", "name the board in the images, such as chessboard:9x6:0.025");
  return *board;
}

void take(FoundCorners found, ArmViews& out) {
  for (const DroppedView& dropped : found.dropped)
    out.notes.push_back("view " + dropped.name + " is left out: " + dropped.reason);
  out.data.corners = std::move(found.corners);
}

void read_images(const ArmInput& input, ArmViews& out) {
  if (input.images) {
    take(find_in_folder(*input.images, required_board(input)), out);
    for (const fs::path& image : list_images(*input.images)) {
      out.images.push_back(image.stem().string());
      out.files[out.images.back()] = image;
    }
  } else if (input.corners) {
    out.data.corners = read_corners(*input.corners, board_of(input));
    for (const BoardView& view : out.data.corners.views) out.images.push_back(view.name);
  } else {
    throw InputError("--images", "no views are given", "give --images DIR, --run RUN or --corners PATH");
  }
}

std::vector<std::string> view_names(const ArmViews& in) {
  std::vector<std::string> names;
  for (const BoardView& view : in.data.corners.views) names.push_back(view.name);
  return names;
}

void read_poses(const ArmInput& input, ArmViews& out) {
  const PoseUnit unit = input.unit == "auto" ? PoseUnit::automatic
                        : input.unit == "mm" ? PoseUnit::millimetre
                                             : PoseUnit::metre;
  const RobotPoses read = read_robot_poses(*input.poses, unit);
  out.notes.insert(out.notes.end(), read.notes.begin(), read.notes.end());
  const MatchedPoses matched = match_poses(read.poses, out.images, view_names(out));
  out.notes.push_back("robot poses were matched to the images " + matched.how);
  for (const Pose& pose : matched.poses) out.data.poses.push_back({input.invert ? pose.inverse() : pose, {}});
}

struct NamedRow {
  std::string name;  // of the image, or empty
  std::vector<double> positions;
};

// A first field more than the joints is a name; a first row of names says which column is which.
std::vector<NamedRow> read_joint_rows(const fs::path& file, const std::vector<std::string>& joints) {
  std::vector<NamedRow> rows;
  std::vector<std::size_t> column;
  for (const FieldRow& row : read_field_rows(file)) {
    if (rows.empty() && column.empty() &&
        std::find(row.fields.begin(), row.fields.end(), joints[0]) != row.fields.end()) {
      for (const std::string& joint : joints) {
        const auto at = std::find(row.fields.begin(), row.fields.end(), joint);
        if (at == row.fields.end())
          throw InputError(at_line(file, row.line), "has no joint " + in_quotes(joint),
                           "name the columns as the joints of --urdf; " + did_you_mean(joint, row.fields));
        column.push_back(static_cast<std::size_t>(at - row.fields.begin()));
      }
      continue;
    }
    NamedRow out;
    if (row.fields.size() > joints.size()) out.name = fs::path(row.fields[0]).stem().string();
    std::vector<std::string> fields;
    for (const std::size_t c : column)
      if (c < row.fields.size()) fields.push_back(row.fields[c]);
    if (column.empty()) fields.assign(row.fields.begin() + (row.fields.size() > joints.size()), row.fields.end());
    for (const std::string& field : fields) {
      const auto value = parse_number(field);
      if (!value)
        throw InputError(at_line(file, row.line), in_quotes(field) + " is not a number",
                         "write joint positions in rad");
      out.positions.push_back(*value);
    }
    rows.push_back(std::move(out));
  }
  return rows;
}

/// Joint positions of each view: by the rows' names where these are the images', else by order of the images.
void match_rows(const fs::path& file, const std::vector<std::string>& joints, ArmViews& out) {
  const std::vector<NamedRow> rows = read_joint_rows(file, joints);
  std::map<std::string, std::size_t> by_name;
  for (std::size_t i = 0; i < rows.size(); ++i) by_name.emplace(rows[i].name, i);
  const std::vector<std::string> views = view_names(out);
  const bool named = by_name.size() == rows.size() && std::all_of(views.begin(), views.end(), [&](const auto& view) {
                       return by_name.contains(fs::path(view).stem().string());
                     });
  if (!named && rows.size() != out.images.size())
    throw InputError("--joints", counted(rows.size(), "row") + " for " + counted(out.images.size(), "image"),
                     "give one row an image, or name the rows as the images");
  out.notes.push_back("joint positions were matched to the images by " + std::string(named ? "name" : "order"));
  for (const std::string& view : views) {
    const auto place =
        static_cast<std::size_t>(std::find(out.images.begin(), out.images.end(), view) - out.images.begin());
    out.rows.push_back(rows[named ? by_name.at(fs::path(view).stem().string()) : place].positions);
  }
}

/// Where the joints were, and how far each moved around an instant.
class JointHistory {
 public:
  explicit JointHistory(std::vector<JointRow> rows) : rows_(std::move(rows)) {}

  std::optional<std::vector<double>> at(RobotTime time) const {
    const auto next = std::lower_bound(rows_.begin(), rows_.end(), time,
                                       [](const JointRow& row, RobotTime t) { return row.time < t; });
    if (next == rows_.end() || (next == rows_.begin() && next->time != time)) return std::nullopt;
    if (next->time == time) return next->positions;
    const JointRow& before = *std::prev(next);
    if (next->time - before.time > kAround) return std::nullopt;
    const double share = to_seconds(time - before.time) / to_seconds(next->time - before.time);
    std::vector<double> out;
    for (std::size_t j = 0; j < before.positions.size(); ++j)
      out.push_back(before.positions[j] + share * (next->positions[j] - before.positions[j]));
    return out;
  }

  /// Largest way of a joint within kAround; infinite where too little is known.
  double moved(RobotTime time) const {
    const auto from = at(time - kAround), to = at(time + kAround);
    if (!from || !to) return INFINITY;
    std::vector<double> low = *from, high = *from;
    auto row = std::lower_bound(rows_.begin(), rows_.end(), time - kAround,
                                [](const JointRow& r, RobotTime t) { return r.time < t; });
    double most = 0;
    for (; row != rows_.end() && row->time < time + kAround; ++row)
      for (std::size_t j = 0; j < low.size(); ++j) {
        low[j] = std::min(low[j], row->positions[j]), high[j] = std::max(high[j], row->positions[j]);
        most = std::max(most, high[j] - low[j]);
      }
    return most;
  }

 private:
  std::vector<JointRow> rows_;
};

struct Still {
  TimedPicture picture;
  std::vector<double> positions;
};

double farthest(const std::vector<double>& a, const std::vector<double>& b) {
  double most = 0;
  for (std::size_t j = 0; j < a.size(); ++j) most = std::max(most, std::abs(a[j] - b[j]));
  return most;
}

/// Pictures in which the robot held still, one for each place where it did; at most `most`, evenly.
std::vector<Still> stills_of(const std::vector<TimedPicture>& pictures, const JointHistory& joints, Duration offset,
                             std::size_t most) {
  std::vector<Still> all;
  for (const TimedPicture& picture : pictures) {
    const RobotTime time = picture.time + offset;
    if (!(joints.moved(time) < kStill)) continue;
    const std::vector<double> positions = *joints.at(time);
    const bool known = std::any_of(all.begin(), all.end(), [&](const Still& still) {
      return farthest(still.positions, positions) < kSameStation;
    });
    if (!known) all.push_back({picture, positions});
  }
  std::vector<Still> out;
  for (std::size_t i = 0; i < std::min(most, all.size()); ++i)
    out.push_back(all[i * all.size() / std::min(most, all.size())]);
  return out;
}

void read_run(const ArmInput& input, const std::vector<std::string>& names, ArmViews& out) {
  require_run(*input.run);
  const fs::path joints = input.joints.value_or(beside_run(*input.run, "-joints.csv"));
  const fs::path list = *input.run / (input.side == "right" ? "rgb_right.txt" : "rgb.txt");
  const double offset = input.time ? read_result(*input.time, "time").result.number("offset_s") : 0;
  const std::vector<TimedPicture> pictures = read_picture_list(list);
  const JointHistory history(read_named_joints(joints, names, "--urdf"));
  const auto stills = stills_of(pictures, history, seconds(offset), static_cast<std::size_t>(input.most_views));
  if (stills.size() < kFewestStations)
    throw InputError(input.run->string(),
                     "the robot held still at " + counted(stills.size(), "place") + " before the camera",
                     "let it stop for half a second at 15 places and more (`foresight calibrate arm --guided`)");
  std::vector<fs::path> files;
  for (const Still& still : stills) files.push_back(still.picture.file);
  take(find_in_files(files, required_board(input)), out);
  for (const Still& still : stills) {
    out.images.push_back(still.picture.file.stem().string());
    out.files[out.images.back()] = still.picture.file;
  }
  for (const std::string& view : view_names(out)) {
    const auto at = std::find(out.images.begin(), out.images.end(), view) - out.images.begin();
    out.rows.push_back(stills[static_cast<std::size_t>(at)].positions);
  }
  out.notes.push_back("the robot held still at " + counted(stills.size(), "place") + ", in " +
                      counted(pictures.size(), "picture"));
}

JointChain chain_of(const ArmInput& input) {
  if (input.urdf) return read_joint_chain(*input.urdf, input.names.base, input.names.flange);
  Rig rig = read_rig(*input.rig);
  if (!rig.robot) throw InputError(input.rig->string(), "has no robot.urdf", "add it to the rig, or give --urdf FILE");
  return joint_chain_of(std::move(*rig.robot), input.names.base, input.names.flange, *input.rig);
}

void read_with_joints(const ArmInput& input, ArmViews& out) {
  out.chain = chain_of(input);
  const UrdfRobot& robot = out.chain->robot;
  for (const int joint : out.chain->joints)
    out.names.joints.push_back(robot.joints[static_cast<std::size_t>(joint)].name);
  out.names.base = robot.links[static_cast<std::size_t>(out.chain->base)].name;
  out.names.flange = robot.links[static_cast<std::size_t>(out.chain->flange)].name;
  if (input.run) return read_run(input, out.names.joints, out);
  read_images(input, out);
  if (!input.joints)
    throw InputError(input.urdf ? "--urdf" : "--rig", "no joint positions are given",
                     "give --joints FILE, one row an image");
  const std::vector<std::string> columns = column_names(*input.joints);
  if (!columns.empty() && columns.front().starts_with("time"))
    throw InputError(input.joints->string(), "holds joints over time, and the images tell no times",
                     "give the recording that it was written beside: --run RUN");
  match_rows(*input.joints, out.names.joints, out);
}

}  // namespace

ArmViews read_arm_views(const ArmInput& input) {
  ArmViews out;
  out.names = input.names;
  if (out.names.camera.empty()) out.names.camera = "camera";
  if (input.urdf || input.rig) {
    read_with_joints(input, out);
  } else {
    if (input.run)
      throw InputError("--run", "its joints need the robot that they belong to", "give --rig RIG or --urdf FILE");
    if (input.joints)
      throw InputError("--joints", "they need the robot that they belong to", "give --rig RIG or --urdf FILE");
    read_images(input, out);
    if (!input.poses)
      throw InputError("--poses", "no robot poses are given", "give --poses FILE or DIR, or --urdf and --joints");
    if (out.names.base.empty()) out.names.base = "base";
    if (out.names.flange.empty()) out.names.flange = "flange";
    read_poses(input, out);
  }
  const auto board = board_of(input);
  if (board && (board->kind == BoardKind::chessboard || board->kind == BoardKind::circles))
    out.data.cols = board->cols, out.data.rows = board->rows;
  return out;
}

ArmViews some_views(const ArmViews& all, const std::vector<std::size_t>& indices) {
  ArmViews out = all;
  out.data.corners.views.clear(), out.data.poses.clear(), out.rows.clear();
  for (const std::size_t v : indices) {
    out.data.corners.views.push_back(all.data.corners.views[v]);
    if (!all.data.poses.empty()) out.data.poses.push_back(all.data.poses[v]);
    if (!all.rows.empty()) out.rows.push_back(all.rows[v]);
  }
  return out;
}

ArmViews keep_back(ArmViews& views) {
  constexpr std::size_t kEvery = 5, kFirst = 2;
  std::vector<std::size_t> solved, kept;
  for (std::size_t v = 0; v < views.data.corners.views.size(); ++v) (v % kEvery == kFirst ? kept : solved).push_back(v);
  ArmViews out = some_views(views, kept);
  views = some_views(views, solved);
  return out;
}

HandEyeData with_poses(const ArmViews& views, const std::map<std::string, double>& offsets) {
  HandEyeData data = views.data;
  if (!views.chain) return data;
  JointChain chain = *views.chain;
  for (UrdfJoint& joint : chain.robot.joints) joint.lower -= 0.2, joint.upper += 0.2;  // of what the joints report
  data.poses.clear();
  for (std::vector<double> row : views.rows) {
    for (std::size_t j = 0; j < row.size(); ++j)
      if (const auto offset = offsets.find(views.names.joints[j]); offset != offsets.end()) row[j] += offset->second;
    data.poses.push_back({flange_pose(chain, row, "joints"), {}});
  }
  return data;
}

std::optional<CameraModel> lens_of_run(const ArmInput& input) {
  if (!input.run) return std::nullopt;
  const fs::path file = *input.run / (input.side == "right" ? "camera_right.yaml" : "camera.yaml");
  if (!fs::exists(file)) return std::nullopt;
  return read_lens_file(file).camera;
}

void add_arm_input(Command& command, ArmInput& input) {
  command.add_option("--images", input.images, "Folder of images")->reads();
  command.add_option("--corners", input.corners, "Found corners instead: .vnl file, or folder of .csv")->reads();
  command
      .add_option("--run", input.run,
                  "Instead: a recording of a robot that held still at many places, and its joints\n"
                  "(RUN-joints.csv); with --rig or --urdf")
      ->reads();
  command
      .add_option("--side", input.side, "Of a recording, or of a pair in --camera: the left camera, or the right one")
      ->check(one_of({"left", "right"}))
      ->capture_default_str();
  command.add_option("--most-views", input.most_views, "Of a recording, evenly over its places")
      ->check(from_to(8, 200))
      ->capture_default_str();
  command.add_option("--time", input.time, "Result of `calibrate time`, for --run")->reads();
  command.add_option("--board", input.board,
                     "Board, such as chessboard:9x6:0.025 or charuco:5x7:0.036:0.018:DICT_6X6_250");
  command
      .add_option("--poses", input.poses,
                  "Robot poses, base to flange: 4x4 rows, x y z qx qy qz qw, or a folder with one file each")
      ->reads();
  command.add_option("--pose-unit", input.unit, "Of the positions")
      ->check(one_of({"auto", "m", "mm"}))
      ->capture_default_str();
  command.add_flag("--invert-poses", input.invert, "The poses are written from flange to base");
  command
      .add_option("--joints", input.joints,
                  "Joint positions instead, rad, rows [name] q1 q2 ..., or columns under the joints' names; for\n"
                  "--urdf or --rig; also gives their offsets")
      ->reads();
  command.add_option("--urdf", input.urdf, "The arm")->reads();
  command.add_option("--rig", input.rig, "The arm of this rig")->reads();
  command.add_option("--base-link", input.names.base, "Link that stands still (default: the root)");
  command.add_option("--flange-link", input.names.flange, "Link that carries camera or board (default: the last)");
}

}  // namespace foresight
