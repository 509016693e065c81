#include "sim/building.hpp"

#include <algorithm>
#include <cmath>
#include <random>

#include "sim/woven.hpp"

namespace foresight::sim {
namespace {

const Eigen::Vector3d kRoomSize(5, 4, 2.8);            // m
constexpr double kDoorWidth = 1.0, kDoorHeight = 2.1;  // m
constexpr int kThingsInRoom = 6;                       // in a room
constexpr double kThingReach = 0.45;                   // m around its middle

void add_room_quad(Mesh& mesh, const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c,
                   const Eigen::Vector3d& d) {
  const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
  for (const Eigen::Vector3d& v : {a, b, c, d}) mesh.vertices.push_back(v.cast<float>());
  mesh.triangles.push_back({first, first + 1, first + 2});
  mesh.triangles.push_back({first, first + 2, first + 3});
}

/// A wall along `along`, from `from` so long, that stands `inwards` of its middle; with a door in the midst, whose
/// jambs reach to the wall's middle.
void add_room_wall(Mesh& mesh, const Eigen::Vector3d& from, const Eigen::Vector3d& along, double length,
                   const Eigen::Vector3d& inwards, bool door) {
  const Eigen::Vector3d up = Eigen::Vector3d::UnitZ();
  const auto at = [&](double s, double z, double depth) {
    return Eigen::Vector3d(from + s * along + z * up + depth * inwards);
  };
  const auto piece = [&](double s0, double s1, double z0, double z1) {
    add_room_quad(mesh, at(s0, z0, kHalfWall), at(s1, z0, kHalfWall), at(s1, z1, kHalfWall), at(s0, z1, kHalfWall));
  };
  if (!door) return piece(0, length, 0, kRoomSize.z());
  const double s0 = 0.5 * (length - kDoorWidth), s1 = 0.5 * (length + kDoorWidth);
  piece(0, s0, 0, kRoomSize.z());
  piece(s1, length, 0, kRoomSize.z());
  piece(s0, s1, kDoorHeight, kRoomSize.z());
  for (const double s : {s0, s1})
    add_room_quad(mesh, at(s, 0, kHalfWall), at(s, 0, 0), at(s, kDoorHeight, 0), at(s, kDoorHeight, kHalfWall));
  add_room_quad(mesh, at(s0, kDoorHeight, kHalfWall), at(s1, kDoorHeight, kHalfWall), at(s1, kDoorHeight, 0),
                at(s0, kDoorHeight, 0));
}

/// Where rooms are, and which doors there are.
class FloorPlan {
 public:
  FloorPlan(const BuildingOptions& options, std::mt19937& random) : nx_(options.rooms_x), ny_(options.rooms_y) {
    std::bernoulli_distribution half(0.5);
    for (int y = 0; y < ny_; ++y)
      for (int x = 0; x < nx_; ++x) {
        east_.push_back(x + 1 < nx_ && (y == 0 || half(random)));
        north_.push_back(y + 1 < ny_);
      }
  }
  int index(int x, int y) const { return y * nx_ + x; }
  bool east(int x, int y) const { return x >= 0 && x < nx_ && east_[static_cast<std::size_t>(index(x, y))]; }
  bool north(int x, int y) const { return y >= 0 && y < ny_ && north_[static_cast<std::size_t>(index(x, y))]; }
  static Eigen::Vector3d origin(int x, int y) { return {kRoomSize.x() * x, kRoomSize.y() * y, 0}; }

  Mesh walls(int x, int y) const {
    const Eigen::Vector3d o = origin(x, y), ex(1, 0, 0), ey(0, 1, 0);
    const Eigen::Vector3d far_x = o + kRoomSize.x() * ex, far_y = o + kRoomSize.y() * ey;
    Mesh out;
    add_room_wall(out, o, ey, kRoomSize.y(), ex, east(x - 1, y));
    add_room_wall(out, far_x, ey, kRoomSize.y(), -ex, east(x, y));
    add_room_wall(out, o, ex, kRoomSize.x(), ey, north(x, y - 1));
    add_room_wall(out, far_y, ex, kRoomSize.x(), -ey, north(x, y));
    for (const double z : {0.0, kRoomSize.z()}) {
      const Eigen::Vector3d up(0, 0, z);
      add_room_quad(out, o + up, far_x + up, far_x + kRoomSize.y() * ey + up, far_y + up);
    }
    return out;
  }
  std::vector<Portal> portals() const {
    std::vector<Portal> out;
    for (int y = 0; y < ny_; ++y)
      for (int x = 0; x < nx_; ++x) {
        if (east(x, y))
          out.push_back(door({index(x, y), index(x + 1, y)},
                             origin(x + 1, y) + 0.5 * kRoomSize.y() * Eigen::Vector3d::UnitY(),
                             Eigen::Vector3d::UnitY()));
        if (north(x, y))
          out.push_back(door({index(x, y), index(x, y + 1)},
                             origin(x, y + 1) + 0.5 * kRoomSize.x() * Eigen::Vector3d::UnitX(),
                             Eigen::Vector3d::UnitX()));
      }
    return out;
  }

 private:
  static Portal door(std::array<int, 2> cells, const Eigen::Vector3d& middle, const Eigen::Vector3d& along) {
    const Eigen::Vector3d side = 0.5 * kDoorWidth * along, up = kDoorHeight * Eigen::Vector3d::UnitZ();
    return {cells, {middle - side, middle + side, middle + side + up, middle - side + up}};
  }

  int nx_, ny_;
  std::vector<bool> east_, north_;
};

}  // namespace

SceneModel make_building(const BuildingOptions& options) {
  std::mt19937 random(options.seed);
  const FloorPlan plan(options, random);
  const auto rooms = static_cast<std::size_t>(options.rooms_x * options.rooms_y);
  std::uniform_real_distribution any(0.0, 1.0);
  std::vector<Node> nodes;
  std::vector<Cell> cells;
  for (int y = 0; y < options.rooms_y; ++y)
    for (int x = 0; x < options.rooms_x; ++x) {
      const std::string name = "room_" + std::to_string(x) + "_" + std::to_string(y);
      const Eigen::Vector3d origin = FloorPlan::origin(x, y);
      Cell cell{name, {origin, origin + kRoomSize}, {}};
      const auto add = [&](Node node) {
        cell.nodes.push_back(static_cast<int>(nodes.size()));
        nodes.push_back(std::move(node));
      };
      add({name, plan.walls(x, y), -1, Pose::Identity()});
      for (int i = 0; i < kThingsInRoom; ++i) {
        Pose pose = Pose::Identity();
        const double reach = kThingReach + kHalfWall;
        pose.translation() = origin + Eigen::Vector3d(reach + any(random) * (kRoomSize.x() - 2 * reach),
                                                      reach + any(random) * (kRoomSize.y() - 2 * reach), 0.01);
        add({name + "_thing_" + std::to_string(i),
             turned_solid(options.triangles / (rooms * kThingsInRoom), kThingReach, random), -1, pose});
      }
      cells.push_back(std::move(cell));
    }
  return SceneModel(std::move(nodes), std::nullopt, CellGraph(std::move(cells), plan.portals()));
}

}  // namespace foresight::sim
