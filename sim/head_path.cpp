#include "sim/head_path.hpp"

#include <fmt/core.h>

#include "common/error.hpp"
#include "sim/tracer.hpp"

namespace foresight::sim {
namespace {

using Eigen::Vector3f;

// The open side of the room is the operator's.
const Eigen::AlignedBox3d kRoom(Eigen::Vector3d(-2.1, -2.9, -0.73), Eigen::Vector3d(0.60, 2.9, 2.6));
constexpr float kClearance = 0.01f;  // metres between the eye and any surface

std::string seconds_text(double s) {
  return fmt::format("{:.3f} s", s);
}

}  // namespace

HeadPath::HeadPath(const std::filesystem::path& file, double last)
    : track_(read_trajectory(file, PoseTrack::kLargestGap)) {
  const auto& samples = track_.samples();
  const double first = to_seconds(samples.front().time - RobotTime{}),
               end = to_seconds(samples.back().time - RobotTime{});
  if (first > 1e-9)
    throw InputError(file.string(), "starts at " + seconds_text(first), "let it start at 0 s, when the run does");
  if (end < last - 1e-9)
    throw InputError(file.string(), "ends at " + seconds_text(end) + ", but the last image is at " + seconds_text(last),
                     "give fewer --frames or a longer path");
}

Pose HeadPath::at(double t) const {
  const RobotTime time = RobotTime{} + seconds(t);
  const auto& samples = track_.samples();
  if (time <= samples.front().time) return samples.front().pose;
  if (time >= samples.back().time) return samples.back().pose;
  return track_.at(time, Duration{0}).pose;
}

struct RoomCheck::Solid {
  std::string name;
  std::size_t part;
  std::vector<Vector3f> normals;
  Tracer tracer;
};

RoomCheck::RoomCheck(const Lab& lab) {
  for (std::size_t k = 0; k < lab.parts.size(); ++k) {
    std::vector<Triangle> triangles;
    std::vector<Vector3f> normals;
    for (const Facet& f : lab.parts[k].facets) {
      triangles.push_back({f.corners[0].p, f.corners[1].p, f.corners[2].p});
      normals.push_back((f.corners[1].p - f.corners[0].p).cross(f.corners[2].p - f.corners[0].p));
    }
    solids_.push_back(
        std::make_shared<Solid>(Solid{lab.parts[k].name, k, std::move(normals), Tracer(std::move(triangles))}));
  }
}

std::string RoomCheck::fault(const Eigen::Vector3d& eye, const LabState& T_world_part) const {
  if (!kRoom.contains(eye)) return "has left the lab";
  for (const auto& solid : solids_) {
    const Vector3f p = (T_world_part[solid->part].inverse() * eye).cast<float>();
    Eigen::AlignedBox3f box = solid->tracer.bounds();
    box.extend(box.min() - Vector3f::Constant(kClearance)).extend(box.max() + Vector3f::Constant(kClearance));
    if (!box.contains(p)) continue;
    // From inside a closed solid, the first face met is seen from behind.
    const auto hit = solid->tracer.nearest(p, Vector3f(0.31f, 0.17f, 0.94f));
    if (hit && solid->name != "room" && solid->normals[hit->triangle].dot(Vector3f(0.31f, 0.17f, 0.94f)) > 0)
      return "is inside '" + solid->name + "'";
    for (int k = 0; k < 26; ++k) {
      const int i = k < 13 ? k : k + 1;
      const Vector3f d =
          Vector3f(static_cast<float>(i % 3 - 1), static_cast<float>(i / 3 % 3 - 1), static_cast<float>(i / 9 - 1))
              .normalized();
      if (solid->tracer.blocked(p, d, kClearance)) return "touches '" + solid->name + "'";
    }
  }
  return {};
}

}  // namespace foresight::sim
