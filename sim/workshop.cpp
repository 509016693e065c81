#include "sim/workshop.hpp"

#include <array>
#include <cmath>
#include <random>

#include "scene/mesh_builder.hpp"
#include "scene/primitives.hpp"
#include "sim/woven.hpp"

namespace foresight::sim {
namespace {

const Eigen::Vector3d kHall(24, 16, 6);  // m
constexpr int kMachinesInRow = 6, kThingsOnMachine = 7, kShelves = 8, kThingsOnShelf = 18, kPipes = 12, kCarts = 6;
constexpr double kAisle = 2.2;                                   // m beside the middle
constexpr double kCraneWay = 9, kCartWay = 3, kWheelTurn = 0.8;  // m, m, rad/s

Pose at(double x, double y, double z, double turned = 0) {
  Pose out = Pose::Identity();
  out.translation() = Eigen::Vector3d(x, y, z);
  out.linear() = Eigen::AngleAxisd(turned, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  return out;
}

/// Everything that is put into the hall, with the share of triangles that each thing gets.
class Workshop {
 public:
  explicit Workshop(const WorkshopOptions& options) : random_(options.seed) {
    const int things =
        2 * kMachinesInRow * (kThingsOnMachine + 2) + 2 * kShelves * kThingsOnShelf + kPipes + kCarts * 2;
    share_ = options.triangles / static_cast<std::size_t>(things);
  }

  std::vector<Node> build() {
    add("hall", make_box(kHall), at(0, 0, kHall.z() / 2));
    for (const int side : {-1, 1}) {
      for (int i = 0; i < kMachinesInRow; ++i) add_machine(side, i);
      for (int i = 0; i < kShelves; ++i) add_shelf(side, i);
    }
    for (int i = 0; i < kPipes; ++i) add_pipe(i);
    for (int i = 0; i < kCarts; ++i) {
      const std::string name = "cart_" + std::to_string(i);
      const double x = -7.5 + 3.0 * i, y = i % 2 == 0 ? -1.2 : 1.2;
      add(name, cast_block(share_, {1.0, 0.6, 0.5}, random_), at(x, y, 0.15));
      add(name + "_load", turned_solid(share_, 0.25, random_), at(0, 0, 0.5), name);
    }
    add("crane", make_box({0.5, kHall.y() - 0.4, 0.4}), at(0, 0, 5.4));
    add("swarf", swarf(3000), at(2, -3.2, 0.02));
    return std::move(nodes_);
  }

 private:
  double any(double low, double high) { return std::uniform_real_distribution(low, high)(random_); }

  void add(const std::string& name, Mesh mesh, const Pose& T, const std::string& on = "") {
    int parent = -1;
    for (std::size_t i = 0; i < nodes_.size(); ++i)
      if (nodes_[i].name == on) parent = static_cast<int>(i);
    nodes_.push_back({name, std::move(mesh), parent, T});
  }
  void add_machine(int side, int i) {
    const std::string name = "machine_" + std::string(side < 0 ? "right_" : "left_") + std::to_string(i);
    const Eigen::Vector3d size(any(1.6, 2.4), any(1.2, 1.8), any(0.8, 1.3));
    const double x = -9.5 + 3.8 * i, y = side * (kAisle + 1.2);
    add(name, cast_block(2 * share_, size, random_), at(x, y, 0));
    for (int k = 0; k < kThingsOnMachine; ++k) {
      const std::string thing = name + (k < 2 ? "_wheel_" : "_part_") + std::to_string(k);
      const Pose T = at(any(-0.4, 0.4) * size.x(), any(-0.35, 0.35) * size.y(), size.z(), any(0, 6));
      if (k < 2)
        add(thing, toothed_wheel(share_, any(0.12, 0.3), 0.08, 12 + 6 * k), T, name);
      else if (k == 2)
        add(thing, spring(any(0.05, 0.12)), T, name);
      else
        add(thing, turned_solid(share_, any(0.06, 0.2), random_), T, name);
    }
  }
  void add_shelf(int side, int i) {
    const std::string name = "shelf_" + std::string(side < 0 ? "right_" : "left_") + std::to_string(i);
    const double x = -10 + 2.8 * i, y = side * (kHall.y() / 2 - 0.5);
    add(name, rack(2.4, 0.6, 2.4), at(x, y, 0));
    for (int k = 0; k < kThingsOnShelf; ++k) {
      const Pose T = at(-1.1 + 2.2 * (k % 6) / 5.0, any(-0.15, 0.15), 0.61 + 0.6 * (k / 6), any(0, 6));
      const double reach = any(0.05, 0.13);
      const std::string thing = name + "_thing_" + std::to_string(k);
      switch (k % 4) {
        case 0: add(thing, toothed_wheel(share_, reach, 0.06, 10 + k), T, name); break;
        case 1: add(thing, cast_block(share_, {2 * reach, 2 * reach, 2 * reach}, random_), T, name); break;
        default: add(thing, turned_solid(share_, reach, random_), T, name);
      }
    }
  }
  void add_pipe(int i) {
    const double side = i % 2 == 0 ? -1 : 1, z = 3 + 0.4 * (i / 2), sag = any(0.02, 0.2);
    add("pipe_" + std::to_string(i),
        tube(share_, 0.06,
             [=](double u) -> Eigen::Vector3d {
               return {-11 + 22 * u, side * (7.4 - sag * std::sin(9 * u)), z + sag * std::cos(14 * u)};
             }),
        Pose::Identity());
  }
  Mesh spring(double radius) {
    return tube(share_, 0.012, [=](double u) -> Eigen::Vector3d {
      return {radius * std::cos(40 * u), radius * std::sin(40 * u), 0.02 + 0.35 * u};
    });
  }
  /// Sheets of many squares, so that posts meet boards along edges of three and four triangles.
  static Mesh rack(double width, double depth, double height) {
    constexpr int kColumns = 24, kRows = 6, kBoards = 4;
    Mesh out;
    const auto sheet = [&](const Eigen::Vector3d& from, const Eigen::Vector3d& u, const Eigen::Vector3d& v, int nu,
                           int nv) {
      const auto first = static_cast<std::uint32_t>(out.vertices.size());
      for (int b = 0; b <= nv; ++b)
        for (int a = 0; a <= nu; ++a) out.vertices.push_back((from + u * a / nu + v * b / nv).cast<float>());
      const auto row = static_cast<std::uint32_t>(nu + 1);
      for (std::uint32_t b = 0; b < static_cast<std::uint32_t>(nv); ++b)
        for (std::uint32_t a = 0; a < static_cast<std::uint32_t>(nu); ++a) {
          const std::uint32_t at = first + b * row + a;
          out.triangles.push_back({at, at + 1, at + row + 1});
          out.triangles.push_back({at, at + row + 1, at + row});
        }
    };
    const Eigen::Vector3d low(-width / 2, -depth / 2, 0);
    for (int board = 0; board < kBoards; ++board)
      sheet(low + Eigen::Vector3d(0, 0, height * board / kBoards), {width, 0, 0}, {0, depth, 0}, kColumns, kRows);
    for (int post = 0; post <= kColumns; ++post)
      sheet(low + Eigen::Vector3d(width * post / kColumns, 0, 0), {0, depth, 0}, {0, 0, height}, kRows, kBoards);
    return merged(std::array{out}, std::array{Eigen::Affine3d::Identity()});
  }
  /// Loose chips, none of which touches another.
  Mesh swarf(int chips) {
    Mesh out;
    for (int i = 0; i < chips; ++i) {
      const Eigen::Vector3d p(any(-0.6, 0.6), any(-0.4, 0.4), any(0, 0.03));
      const auto first = static_cast<std::uint32_t>(out.vertices.size());
      for (int k = 0; k < 3; ++k)
        out.vertices.push_back((p + Eigen::Vector3d(any(-1, 1), any(-1, 1), any(0, 1)) * 0.006).cast<float>());
      out.triangles.push_back({first, first + 1, first + 2});
    }
    return out;
  }

  std::mt19937 random_;
  std::size_t share_ = 0;
  std::vector<Node> nodes_;
};

}  // namespace

SceneModel make_workshop(const WorkshopOptions& options) {
  return SceneModel(Workshop(options).build());
}

SceneState workshop_state(const SceneModel& workshop, double seconds) {
  SceneState out{RobotTime{static_cast<std::int64_t>(seconds * 1e9)}, StateStatus::exact, {}};
  for (const Node& node : workshop.nodes()) {
    Pose T = node.T_parent_node;
    if (node.name == "crane") T.translation().x() += kCraneWay * std::sin(0.2 * seconds);
    if (node.name.starts_with("cart_") && node.parent < 0)
      T.translation().x() += kCartWay * std::sin(0.35 * seconds + T.translation().x());
    if (node.name.find("_wheel_") != std::string::npos)
      T.rotate(Eigen::AngleAxisd(kWheelTurn * seconds, Eigen::Vector3d::UnitZ()));
    out.T_world_node.push_back(node.parent < 0 ? T : out.T_world_node[static_cast<std::size_t>(node.parent)] * T);
  }
  return out;
}

}  // namespace foresight::sim
