// What the frames of a bus say, with the names and the PDOs that its devices' data sheets give them.
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "drivers/canopen/describe.hpp"

namespace foresight::canopen {

/// EDS or DCF files of the nodes on a bus.
struct DataSheets {
  std::optional<std::filesystem::path> of_all;  ///< of every node that has none of its own
  std::map<int, std::filesystem::path> of_node;
};

/// Frames must come in the order of the bus: masters map PDOs anew, and what they write to a node counts from then on
/// in place of what its sheet says, also where it has none. One thread.
class DescribedBus {
 public:
  /// Throws InputError where a file cannot be read, or a node is not 1 .. 127.
  explicit DescribedBus(DataSheets sheets);

  /// describe() of describe.hpp, in the words of the sheet of the frame's node, with its PDOs as they are mapped.
  std::string describe(const CanFrame& frame);

 private:
  struct Node {
    ObjectDictionary objects;
    std::map<std::uint32_t, std::int64_t> written;  // index << 8 | sub -> value, of PDO parameters
    std::vector<Pdo> pdos;
  };
  Node* node_of(const CanFrame& frame);
  static void note_download(Node& node, int id, const CanFrame& frame);
  static void map_pdos(Node& node, int id);

  DataSheets sheets_;
  std::map<int, Node> nodes_;
};

}  // namespace foresight::canopen
