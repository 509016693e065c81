#include "scene/scene_reader.hpp"

#include <algorithm>
#include <stdexcept>

#include "common/error.hpp"
#include "common/text.hpp"
#include "scene/files.hpp"
#include "scene/mesh_reader.hpp"
#include "scene/urdf_reader.hpp"
#include "scene/yaml_fields.hpp"

namespace foresight {
namespace fs = std::filesystem;
namespace {

class SceneYaml {
 public:
  SceneYaml(const fs::path& file, const fs::path& root) : file_(file), root_(root) {}

  std::optional<double> accuracy() const { return accuracy_; }
  const std::optional<CellGraph>& cells() const { return cells_; }

  std::vector<Node> read() {
    const YamlMap yaml = YamlMap::load(file_);
    yaml.require_known({"nodes", "robots", "accuracy_m", "cells", "portals"});
    if (yaml.has("accuracy_m")) {
      accuracy_ = yaml.number("accuracy_m");
      if (!(*accuracy_ > 0 && *accuracy_ <= 1))
        throw InputError(yaml.where("accuracy_m"), "an accuracy of " + std::to_string(*accuracy_) + " m",
                         "give the model's largest usual error, above 0 and at most 1");
    }
    if (yaml.has("nodes"))
      for (const YamlMap& node : yaml.maps("nodes")) add_node(node);
    if (yaml.has("robots"))
      for (const YamlMap& robot : yaml.maps("robots")) add_robot(robot);
    if (yaml.has("cells") || yaml.has("portals")) read_cells(yaml);
    return std::move(nodes_);
  }

 private:
  void add_node(const YamlMap& yaml) {
    yaml.require_known({"name", "mesh", "parent", "pose"});
    Node node;
    node.name = yaml.text("name");
    // Names are words in nodes.txt, and "world" is what has no node.
    if (node.name == "world" || node.name.find_first_of(" \t\r\n#") != std::string::npos)
      throw InputError(yaml.where("name"), in_quotes(node.name) + " cannot name a node",
                       "choose one word other than 'world'");
    if (yaml.has("mesh")) node.mesh = read_mesh(resolve(yaml, "mesh"));
    node.parent = parent(yaml);
    if (yaml.has("pose")) node.T_parent_node = yaml.pose("pose");
    require_new(node.name, yaml.where("name"));
    nodes_.push_back(std::move(node));
  }

  void add_robot(const YamlMap& yaml) {
    yaml.require_known({"urdf", "parent", "pose", "joints", "prefix"});
    UrdfRobot robot = read_urdf(resolve(yaml, "urdf"), root_);
    if (yaml.has("joints")) {
      const YamlMap joints = yaml.map("joints");
      joints.require_known(joints.keys());  // refuses a key given twice
      std::map<std::string, double> positions;
      for (const std::string& name : joints.keys()) positions[name] = joints.number(name);
      pose_links(robot, positions, yaml.where("joints"));
    } else {
      pose_links(robot, {}, file_.string());
    }
    const int base = parent(yaml);
    const int first = static_cast<int>(nodes_.size());
    if (yaml.has("pose")) robot.links[0].T_parent_node = yaml.pose("pose");
    const std::string prefix = yaml.has("prefix") ? yaml.text("prefix") : "";
    for (Node& link : robot.links) {
      link.name = prefix + link.name;
      link.parent = link.parent < 0 ? base : first + link.parent;
      require_new(link.name, yaml.where("urdf"));
      nodes_.push_back(std::move(link));
    }
  }

  void read_cells(const YamlMap& yaml) {
    std::vector<Cell> cells;
    std::vector<std::string> names;
    if (yaml.has("cells"))
      for (const YamlMap& one : yaml.maps("cells")) {
        one.require_known({"name", "box", "nodes"});
        const std::vector<double> box = one.numbers("box", 6);
        Cell cell{one.text("name"), {}, {}};
        cell.box.extend(Eigen::Vector3d(box[0], box[1], box[2])).extend(Eigen::Vector3d(box[3], box[4], box[5]));
        for (const std::string& name : one.texts("nodes"))
          cell.nodes.push_back(index_of(name, node_names(), one, "nodes"));
        names.push_back(cell.name);
        cells.push_back(std::move(cell));
      }
    std::vector<Portal> portals;
    if (yaml.has("portals"))
      for (const YamlMap& one : yaml.maps("portals")) {
        one.require_known({"between", "corners"});
        const std::vector<std::string> between = one.texts("between");
        if (between.size() != 2)
          throw InputError(one.where("between"), "a portal joins " + std::to_string(between.size()) + " cells",
                           "name two");
        Portal portal;
        for (std::size_t i = 0; i < 2; ++i) portal.cells[i] = index_of(between[i], names, one, "between");
        const std::vector<double> numbers = one.numbers("corners");
        if (numbers.size() % 3 != 0)
          throw InputError(one.where("corners"), "has " + std::to_string(numbers.size()) + " numbers",
                           "give three to each corner");
        for (std::size_t i = 0; i < numbers.size(); i += 3)
          portal.corners.emplace_back(numbers[i], numbers[i + 1], numbers[i + 2]);
        portals.push_back(std::move(portal));
      }
    try {
      cells_.emplace(std::move(cells), std::move(portals));
    } catch (const std::invalid_argument& error) {
      throw InputError(file_.string() + ": cells", error.what(),
                       "correct it, or leave cells and portals out: then all of the scene is drawn");
    }
  }

  std::vector<std::string> node_names() const {
    std::vector<std::string> out;
    for (const Node& node : nodes_) out.push_back(node.name);
    return out;
  }

  static int index_of(const std::string& name, const std::vector<std::string>& names, const YamlMap& yaml,
                      const std::string& key) {
    const auto it = std::find(names.begin(), names.end(), name);
    if (it == names.end())
      throw InputError(yaml.where(key), "there is no " + in_quotes(name),
                       did_you_mean(name, names, "name one that stands above"));
    return static_cast<int>(it - names.begin());
  }

  fs::path resolve(const YamlMap& yaml, const std::string& key) const {
    return resolve_inside(root_, file_.parent_path(), yaml.text(key), yaml.where(key));
  }

  int parent(const YamlMap& yaml) const {
    if (!yaml.has("parent")) return -1;
    const std::string name = yaml.text("parent");
    if (name == "world") return -1;
    std::vector<std::string> names = {"world"};
    for (const Node& node : nodes_) names.push_back(node.name);
    const auto it = std::find(names.begin(), names.end(), name);
    if (it == names.end())
      throw InputError(yaml.where("parent"), "no node " + in_quotes(name) + " stands above",
                       "name an earlier node; " + did_you_mean(name, names));
    return static_cast<int>(it - names.begin()) - 1;
  }

  void require_new(const std::string& name, const std::string& where) const {
    for (const Node& node : nodes_)
      if (node.name == name)
        throw InputError(where, "a second node is named " + in_quotes(name),
                         "rename one; for a second robot of a kind give it a prefix");
  }

  const fs::path& file_;
  const fs::path& root_;
  std::vector<Node> nodes_;
  std::optional<double> accuracy_;
  std::optional<CellGraph> cells_;
};

}  // namespace

SceneModel read_scene(const fs::path& file, const fs::path& root) {
  std::vector<Node> nodes;
  std::optional<double> accuracy;
  std::optional<CellGraph> cells;
  if (file.extension() == ".yaml" || file.extension() == ".yml") {
    SceneYaml yaml(file, root);
    nodes = yaml.read();
    accuracy = yaml.accuracy();
    cells = yaml.cells();
  } else {
    nodes.push_back({"scene", read_mesh(file), -1, Pose::Identity()});
  }
  try {
    return SceneModel(std::move(nodes), accuracy, cells);
  } catch (const std::invalid_argument& error) {
    throw InputError(file.string(), error.what(),
                     cells ? "make its cell larger, or leave it out of the cell: then it is always drawn"
                           : "add a node with a mesh");
  }
}

}  // namespace foresight
