#include "calibration/robot/robot_poses.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <map>

#include "calibration/robot/rigid_math.hpp"
#include "common/counted.hpp"
#include "common/error.hpp"
#include "common/read_file.hpp"
#include "common/rotation.hpp"
#include "common/text.hpp"
#include "scene/text_table.hpp"
#include "scene/yaml_fields.hpp"

namespace foresight {
namespace {

constexpr double kUnlikelyReach = 20;  // metres that no arm reaches, and millimetres that every arm does
constexpr double kUnrigid = 5e-3;

double number(const std::string& field, const std::string& where) {
  const auto value = parse_number(field);
  if (!value || !std::isfinite(*value))
    throw InputError(where, in_quotes(field) + " is not a finite number", "correct or remove it");
  return *value;
}

Pose matrix_pose(const std::vector<double>& m, const std::string& where) {
  const Eigen::Matrix4d M = Eigen::Map<const Eigen::Matrix<double, 4, 4, Eigen::RowMajor>>(m.data());
  if ((M.row(3) - Eigen::RowVector4d(0, 0, 0, 1)).cwiseAbs().maxCoeff() > 1e-6)
    throw InputError(where, "the last row of the 4x4 matrix is not 0 0 0 1", "write the matrix row by row");
  const Eigen::Matrix3d R = M.topLeftCorner<3, 3>();
  const double off = (R * R.transpose() - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff();
  if (!(off <= kUnrigid) || R.determinant() < 0)
    throw InputError(where,
                     "the 4x4 matrix is no rotation and translation (" +
                         (R.determinant() < 0 ? std::string("it mirrors") : "R R^T is off by " + readable(off, 3)) +
                         ")",
                     "write an orthonormal rotation with determinant 1");
  Pose pose = Pose::Identity();
  pose.linear() = nearest_rotation(R);
  pose.translation() = M.topRightCorner<3, 1>();
  return pose;
}

Pose quaternion_pose(const std::vector<double>& v, const std::string& where) {
  const Eigen::Vector4d q(v[3], v[4], v[5], v[6]);
  if (!(std::abs(q.norm() - 1) <= 1e-3))
    throw InputError(where, "the quaternion has length " + readable(q.norm(), 3),
                     "write x y z qx qy qz qw with a unit quaternion");
  return checked_pose({0, 0, 0}, q, where).pretranslate(Eigen::Vector3d(v[0], v[1], v[2]));
}

std::vector<double> numbers(const std::vector<std::string>& fields, std::size_t first, const std::string& where) {
  std::vector<double> out;
  for (std::size_t i = first; i < fields.size(); ++i) out.push_back(number(fields[i], where));
  return out;
}

// Rows of 4 numbers, four of them a pose.
std::vector<NamedPose> blocks(const std::filesystem::path& file, const std::vector<FieldRow>& rows) {
  std::vector<NamedPose> poses;
  for (std::size_t i = 0; i < rows.size(); i += 4) {
    const std::string where = at_line(file, rows[i].line);
    if (i + 4 > rows.size())
      throw InputError(where, "the last matrix has " + counted(rows.size() - i, "row") + " of 4", "complete it");
    std::vector<double> m;
    for (std::size_t r = i; r < i + 4; ++r) {
      const std::string here = at_line(file, rows[r].line);
      if (rows[r].fields.size() != 4)
        throw InputError(here, "has " + counted(rows[r].fields.size(), "number"), "write 4 rows of 4 a pose");
      for (const double value : numbers(rows[r].fields, 0, here)) m.push_back(value);
    }
    poses.push_back({"", where, matrix_pose(m, where)});
  }
  return poses;
}

NamedPose row_pose(const std::filesystem::path& file, const FieldRow& row) {
  const std::string where = at_line(file, row.line);
  const auto& f = row.fields;
  switch (f.size()) {
    case 16: return {"", where, matrix_pose(numbers(f, 0, where), where)};
    case 17: return {f[0], where, matrix_pose(numbers(f, 1, where), where)};
    case 7: return {"", where, quaternion_pose(numbers(f, 0, where), where)};
    case 8: return {f[0], where, quaternion_pose(numbers(f, 1, where), where)};
    case 12: {
      std::vector<double> m = numbers(f, 0, where);
      m.insert(m.end(), {0, 0, 0, 1});
      return {"", where, matrix_pose(m, where)};
    }
    default:
      throw InputError(where, "has " + counted(f.size(), "field"),
                       "write 16 numbers of a 4x4 matrix, 4 lines of 4, or x y z qx qy qz qw");
  }
}

std::vector<NamedPose> text_poses(const std::filesystem::path& file) {
  std::vector<FieldRow> rows = read_field_rows(file);
  if (rows.size() > 1 && rows[0].fields.size() == 1 && parse_integer(rows[0].fields[0])) rows.erase(rows.begin());
  if (!rows.empty() && !parse_number(rows[0].fields.back())) rows.erase(rows.begin());  // column names
  if (rows.empty()) throw InputError(file.string(), "holds no pose", "write one pose a line");
  if (rows[0].fields.size() == 4) return blocks(file, rows);
  std::vector<NamedPose> poses;
  for (const FieldRow& row : rows) poses.push_back(row_pose(file, row));
  return poses;
}

NamedPose yaml_pose(const std::filesystem::path& file) {
  const YamlMap map = YamlMap::load(file);
  std::vector<double> v;
  for (const char* key : {"x", "y", "z", "qx", "qy", "qz", "qw"}) v.push_back(map.number(key));
  return {file.stem().string(), file.string(), quaternion_pose(v, file.string())};
}

std::vector<NamedPose> folder_poses(const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    const std::string extension = entry.path().extension().string();
    if (extension == ".yaml" || extension == ".yml" || extension == ".txt" || extension == ".csv")
      files.push_back(entry);
  }
  std::sort(files.begin(), files.end(),
            [](const auto& a, const auto& b) { return natural_less(a.stem().string(), b.stem().string()); });
  std::vector<NamedPose> poses;
  for (const auto& file : files) {
    if (file.extension() == ".yaml" || file.extension() == ".yml") {
      poses.push_back(yaml_pose(file));
      continue;
    }
    for (NamedPose pose : text_poses(file)) {
      pose.name = file.stem().string();
      poses.push_back(std::move(pose));
    }
  }
  if (poses.empty())
    throw InputError(folder.string(), "holds no .yaml, .txt or .csv file with a pose", "give the folder of the poses");
  return poses;
}

// A quaternion with w first is a unit one too; it shows where every pose turns the wrong way only
// against images, but a constant first number near 1 is a hint that poses alone give.
bool looks_w_first(const std::vector<NamedPose>& poses) {
  if (poses.size() < 3) return false;
  double least = 1;
  for (const NamedPose& named : poses) {
    const Eigen::Quaterniond q(named.pose.linear());
    least = std::min(least, std::abs(q.x()));
  }
  return least > 0.95;
}

std::string stem(const std::string& name) {
  return std::filesystem::path(name).stem().string();
}

std::optional<long long> last_number(const std::string& name) {
  const std::string text = stem(name);
  const std::size_t end = text.find_last_of("0123456789");
  if (end == std::string::npos) return std::nullopt;
  const std::size_t before = text.find_last_not_of("0123456789", end);
  return parse_integer(text.substr(before == std::string::npos ? 0 : before + 1,
                                   end - (before == std::string::npos ? 0 : before + 1) + 1));
}

// Poses by a key of their names; nothing where keys repeat or a view finds none.
template <typename Key>
std::optional<std::vector<Pose>> match_by(const std::vector<NamedPose>& poses, const std::vector<std::string>& views,
                                          const Key& key) {
  std::map<decltype(key(views[0])), Pose> known;
  for (const NamedPose& named : poses)
    if (!known.emplace(key(named.name), named.pose).second) return std::nullopt;
  std::vector<Pose> out;
  for (const std::string& view : views) {
    const auto found = known.find(key(view));
    if (found == known.end()) return std::nullopt;
    out.push_back(found->second);
  }
  return out;
}

}  // namespace

RobotPoses read_robot_poses(const std::filesystem::path& path, PoseUnit unit) {
  require_there(path);
  RobotPoses out;
  if (std::filesystem::is_directory(path))
    out.poses = folder_poses(path);
  else if (path.extension() == ".yaml" || path.extension() == ".yml")
    out.poses = {yaml_pose(path)};
  else
    out.poses = text_poses(path);
  std::vector<double> reach;
  for (const NamedPose& named : out.poses) reach.push_back(named.pose.translation().norm());
  if (unit == PoseUnit::automatic && median(reach) > kUnlikelyReach) {
    unit = PoseUnit::millimetre;
    out.notes.push_back("robot positions are taken as millimetres: half of them lie beyond " +
                        readable(median(reach), 0) + "; say --pose-unit m if that is wrong");
  }
  if (unit == PoseUnit::millimetre && !reach.empty() && median(reach) < kUnlikelyReach)
    throw InputError(path.string(),
                     "half of the positions lie within " + readable(median(reach), 2) + " of the base: no millimetres",
                     "say --pose-unit m");
  if (unit == PoseUnit::millimetre)
    for (NamedPose& named : out.poses) named.pose.translation() *= 1e-3;
  if (looks_w_first(out.poses))
    out.notes.push_back(
        "the first number of every quaternion is near 1: are they written qw qx qy qz? Foresight reads qx qy qz qw");
  return out;
}

MatchedPoses match_poses(const std::vector<NamedPose>& poses, const std::vector<std::string>& images,
                         const std::vector<std::string>& views) {
  const bool named = std::none_of(poses.begin(), poses.end(), [](const NamedPose& p) { return p.name.empty(); });
  if (named) {
    if (const auto found = match_by(poses, views, stem)) return {*found, "by name"};
    if (const auto found = match_by(poses, views, last_number)) return {*found, "by number"};
  }
  if (poses.size() != images.size())
    throw InputError("--poses", counted(poses.size(), "pose") + " for " + counted(images.size(), "image"),
                     "give one pose an image, or name the poses as the images");
  std::map<std::string, Pose> by_image;
  for (std::size_t i = 0; i < images.size(); ++i) by_image[stem(images[i])] = poses[i].pose;
  MatchedPoses out{{}, "by order"};
  for (const std::string& view : views) {
    const auto found = by_image.find(stem(view));
    if (found == by_image.end())
      throw InputError("view " + view, "is not among the images", "give the folder that the corners come from");
    out.poses.push_back(found->second);
  }
  return out;
}

std::vector<FieldRow> read_field_rows(const std::filesystem::path& file) {
  std::vector<FieldRow> rows;
  for_each_row(file, {RowForm::Between::loose}, [&](const TextRow& row) {
    rows.push_back({row.line, {row.fields.begin(), row.fields.end()}});
  });
  return rows;
}

bool natural_less(const std::string& a, const std::string& b) {
  std::size_t i = 0, j = 0;
  const auto digit = [](char c) { return c >= '0' && c <= '9'; };
  while (i < a.size() && j < b.size()) {
    if (!digit(a[i]) || !digit(b[j])) {
      if (a[i] != b[j]) return a[i] < b[j];
      ++i, ++j;
      continue;
    }
    const auto run = [&](const std::string& s, std::size_t& at) {
      while (at < s.size() && s[at] == '0') ++at;
      const std::size_t first = at;
      while (at < s.size() && digit(s[at])) ++at;
      return std::string_view(s).substr(first, at - first);
    };
    const std::string_view x = run(a, i), y = run(b, j);
    if (x.size() != y.size()) return x.size() < y.size();
    if (x != y) return x < y;
  }
  return a.size() - i < b.size() - j;
}

}  // namespace foresight
