#include <array>
#include <map>

#include "calibration/placement/placement.hpp"
#include "common/error.hpp"
#include "common/text.hpp"
#include "scene/text_table.hpp"

namespace foresight {
namespace {

double number(const TextRow& row, std::size_t i) {
  const auto value = parse_number(row.fields[i]);
  if (!value || !(std::abs(*value) <= kFarthest))
    throw InputError(row.where(i), in_quotes(row.fields[i]) + " is no coordinate in metres", "write a decimal number");
  return *value;
}

Eigen::Vector3d point(const TextRow& row, std::size_t first) {
  return {number(row, first), number(row, first + 1), number(row, first + 2)};
}

// Of the first row.
std::size_t field_count(const std::filesystem::path& file) {
  std::size_t count = 0;
  for_each_row(file, RowForm{}, [&](const TextRow& row) {
    if (count == 0) count = row.fields.size();
  });
  return count;
}

}  // namespace

std::map<std::pair<long long, long long>, Eigen::Vector3d> read_tag_places(const std::filesystem::path& file) {
  std::map<std::pair<long long, long long>, Eigen::Vector3d> corners;
  for_each_row(file, "id corner x y z", [&](const TextRow& row) {
    const auto id = parse_integer(row.fields[0]), corner = parse_integer(row.fields[1]);
    if (!id || *id < 0 || !corner || *corner < 0 || *corner > 3)
      throw InputError(row.where(), "does not start with a tag's id and a corner from 0 to 3",
                       "write 'id corner x y z'");
    if (!corners.try_emplace({*id, *corner}, point(row, 2)).second)
      throw InputError(row.where(), "the corner is given twice", "remove one row");
  });
  return corners;
}

std::vector<PointPair> read_point_pairs(const std::filesystem::path& file) {
  const bool with_sigma = field_count(file) == 7;
  std::vector<PointPair> points;
  for_each_row(file, with_sigma ? "x y z X Y Z sigma" : "x y z X Y Z", [&](const TextRow& row) {
    PointPair pair{"point " + std::to_string(points.size() + 1), point(row, 0), point(row, 3), 0};
    if (with_sigma && !((pair.sigma_m = number(row, 6)) > 0))
      throw InputError(row.where(), "sigma is not positive", "write a standard deviation in metres");
    points.push_back(pair);
  });
  return points;
}

std::string tag_corner_name(long long tag, long long corner) {
  return "tag " + std::to_string(tag) + " corner " + std::to_string(corner);
}

std::vector<PointPair> read_tag_corners(const std::filesystem::path& file) {
  std::vector<PointPair> points;
  for (const auto& [key, p] : read_tag_places(file))
    points.push_back({tag_corner_name(key.first, key.second), p, Eigen::Vector3d::Zero(), 0});
  return points;
}

std::vector<PointPair> read_tag_pairs(const std::filesystem::path& model, const std::filesystem::path& world) {
  const auto in_model = read_tag_places(model), in_world = read_tag_places(world);
  std::vector<PointPair> points;
  for (const auto& [key, p_model] : in_model)
    if (const auto found = in_world.find(key); found != in_world.end())
      points.push_back({tag_corner_name(key.first, key.second), p_model, found->second, 0});
  if (points.empty())
    throw InputError(world.string(), "has no tag of " + model.string(), "give the corners of the same tags");
  return points;
}

}  // namespace foresight
