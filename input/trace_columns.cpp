#include "input/trace_columns.hpp"

#include <algorithm>
#include <cmath>

#include "common/error.hpp"
#include "common/text.hpp"

namespace foresight {
namespace {

constexpr double kFarthest = 1e6;  // m from the origin: beyond it no device is, and differences lose their digits

}  // namespace

TraceColumns::TraceColumns(const TextRow& heading) {
  for (std::size_t i = 0; i < heading.fields.size(); ++i) columns_.emplace(heading.fields[i], i);
}

bool TraceColumns::has_all(std::initializer_list<const char*> names) const {
  return std::ranges::all_of(names, [this](const char* name) { return has(name); });
}

std::size_t TraceColumns::place(const TextRow& row, const std::string& name) const {
  const std::size_t at = columns_.at(name);
  if (at >= row.fields.size())
    throw InputError(row.where(), "has " + std::to_string(row.fields.size()) + " fields, and none for " + name,
                     "give as many as in the heading");
  return at;
}

double TraceColumns::number(const TextRow& row, const std::string& name) const {
  return finite_field(row, place(row, name), name);
}

double TraceColumns::number_or_nan(const TextRow& row, const std::string& name) const {
  const std::size_t at = place(row, name);
  const auto value = parse_number(row.fields[at]);
  if (value) return *value;
  throw InputError(row.where(at), name + " is " + in_quotes(row.fields[at]), "give a number, or nan");
}

Duration TraceColumns::seconds_since(const TextRow& row, const std::string& name) const {
  const std::size_t at = place(row, name);
  if (const auto value = parse_seconds(row.fields[at])) return *value;
  throw InputError(row.where(at), name + " is " + in_quotes(row.fields[at]), "give seconds");
}

Pose TraceColumns::pose(const TextRow& row, const std::string& prefix) const {
  Pose out = Pose::Identity();
  out.translation() << number(row, prefix + "x"), number(row, prefix + "y"), number(row, prefix + "z");
  if (out.translation().cwiseAbs().maxCoeff() > kFarthest)
    throw InputError(row.where(), prefix + "x, y and z are more than 1000 km away", "give metres");
  const Eigen::Quaterniond q(number(row, prefix + "qw"), number(row, prefix + "qx"), number(row, prefix + "qy"),
                             number(row, prefix + "qz"));
  // Three decimals, as some programs write them, are off by that much.
  if (!(std::abs(q.norm() - 1) < 5e-3))
    throw InputError(row.where(), prefix + "qx .. qw is no unit quaternion", "give x y z w of length 1");
  out.linear() = q.normalized().toRotationMatrix();
  return out;
}

}  // namespace foresight
