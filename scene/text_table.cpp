#include "scene/text_table.hpp"

#include <algorithm>

#include "common/error.hpp"
#include "common/text.hpp"

namespace foresight {
namespace {

std::size_t words_in(std::string_view form) {
  return 1 + static_cast<std::size_t>(std::count(form.begin(), form.end(), ' '));
}

}  // namespace

void for_each_row(const std::filesystem::path& file, const std::string& form,
                  const std::function<void(const TextRow&)>& visit) {
  const std::size_t expected = words_in(form);
  bool any = false;
  for_each_row(file, RowForm{}, [&](const TextRow& row) {
    if (row.fields.size() != expected)
      throw InputError(row.where(), "has " + std::to_string(row.fields.size()) + " fields",
                       "write " + std::to_string(expected) + ", with blanks between: " + form);
    any = true;
    visit(row);
  });
  if (!any) throw InputError(file.string(), "holds no row", "write at least one line: " + form);
}

RobotTime time_field(const TextRow& row, std::size_t index) {
  const auto time = parse_seconds(row.fields[index]);
  if (!time)
    throw InputError(row.where(index),
                     "time is " + in_quotes(row.fields[index]) + ", not a number of seconds up to " +
                         std::to_string(kLargestSeconds),
                     "write decimal seconds");
  return RobotTime{time->count()};
}

Pose pose_fields(const TextRow& row, std::size_t first) {
  static constexpr const char* kNames[] = {"tx", "ty", "tz", "qx", "qy", "qz", "qw"};
  double v[7];
  for (std::size_t i = 0; i < 7; ++i) v[i] = finite_field(row, first + i, kNames[i]);
  return checked_pose({v[0], v[1], v[2]}, {v[3], v[4], v[5], v[6]}, row.where());
}

Pose checked_pose(const Eigen::Vector3d& t, const Eigen::Vector4d& q_xyzw, const std::string& where) {
  if (!(t.cwiseAbs().maxCoeff() <= kFarthest))
    throw InputError(where, "the position lies more than 1e6 m from the origin", "write positions in metres");
  const double norm = q_xyzw.stableNorm();
  if (!(std::abs(norm - 1) <= 1e-3))
    throw InputError(where, "the quaternion has length " + std::to_string(norm),
                     "write a unit quaternion in the order qx qy qz qw");
  Pose pose = Pose::Identity();
  pose.linear() = Eigen::Quaterniond(q_xyzw / norm).toRotationMatrix();  // coefficients are x, y, z, w
  pose.translation() = t;
  return pose;
}

void require_ascending(const TextRow& row, RobotTime previous, RobotTime time) {
  if (time == previous) throw InputError(row.where(), "repeats the time of an earlier row", "remove one of the two");
  if (time < previous) throw InputError(row.where(), "lies before an earlier row in time", "sort the rows by time");
}

}  // namespace foresight
