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

  std::vector<Node> read() {
    const YamlMap yaml = YamlMap::load(file_);
    yaml.require_known({"nodes", "robots", "accuracy_m"});
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
                       "name an earlier node; did you mean '" + nearest_word(name, names) + "'?");
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
};

}  // namespace

SceneModel read_scene(const fs::path& file, const fs::path& root) {
  std::vector<Node> nodes;
  std::optional<double> accuracy;
  if (file.extension() == ".yaml" || file.extension() == ".yml") {
    SceneYaml yaml(file, root);
    nodes = yaml.read();
    accuracy = yaml.accuracy();
  } else {
    nodes.push_back({"scene", read_mesh(file), -1, Pose::Identity()});
  }
  try {
    return SceneModel(std::move(nodes), accuracy);
  } catch (const std::invalid_argument& error) {
    throw InputError(file.string(), error.what(), "add a node with a mesh");
  }
}

}  // namespace foresight
