#include "drivers/canopen/described_bus.hpp"

#include "common/error.hpp"
#include "drivers/canopen/eds_reader.hpp"
#include "drivers/canopen/wire.hpp"

namespace foresight::canopen {
namespace {

constexpr std::uint32_t kNotThere = 0x80000000, kIdBits = 0x7ff;

std::uint32_t key(std::uint16_t index, std::uint8_t sub) {
  return std::uint32_t{index} << 8 | sub;
}

bool is_pdo_parameter(std::uint16_t index) {
  return index >= 0x1400 && index < 0x1C00;
}

}  // namespace

DescribedBus::DescribedBus(DataSheets sheets) : sheets_(std::move(sheets)) {
  // Before the first frame: a file that cannot be read is a mistake on any bus.
  if (sheets_.of_all) read_eds(*sheets_.of_all, 1);
  for (const auto& [id, file] : sheets_.of_node) {
    Node& node = nodes_[id];
    node.objects = read_eds(file, id);
    map_pdos(node, id);
  }
}

DescribedBus::Node* DescribedBus::node_of(const CanFrame& frame) {
  const int id = static_cast<int>(frame.id & 0x7f);
  if (!is_canopen(frame) || id == 0) return nullptr;
  if (const auto known = nodes_.find(id); known != nodes_.end()) return &known->second;
  Node& node = nodes_[id];
  if (sheets_.of_all) {
    node.objects = read_eds(*sheets_.of_all, id);
    map_pdos(node, id);
  }
  return &node;
}

std::string DescribedBus::describe(const CanFrame& frame) {
  Node* node = node_of(frame);
  if (node == nullptr) return canopen::describe(frame);
  std::string out = canopen::describe(frame, {&node->objects, node->pdos});
  note_download(*node, static_cast<int>(frame.id & 0x7f), frame);
  return out;
}

// An expedited download to a communication or mapping parameter (CiA 301, 7.2.4.3.3).
void DescribedBus::note_download(Node& node, int id, const CanFrame& frame) {
  if (frame.id != kSdoRequestId + static_cast<std::uint32_t>(id) || frame.size != 8) return;
  const std::uint8_t command = frame.data[0];
  const auto index = static_cast<std::uint16_t>(load(frame.payload().subspan(1), 2));
  if (command >> 5 != 1 || (command & 2) == 0 || !is_pdo_parameter(index)) return;
  const std::size_t valid = command & 1 ? 4u - (command >> 2 & 3u) : 4u;
  node.written[key(index, frame.data[3])] = static_cast<std::int64_t>(load(frame.payload().subspan(4), valid));
  map_pdos(node, id);
}

// CiA 301, 7.5.2.35 to 7.5.2.38. A mapping that cannot be is passed over: frames then show their bytes.
void DescribedBus::map_pdos(Node& node, int id) {
  const auto value = [&](std::uint16_t index, std::uint8_t sub) -> std::optional<std::int64_t> {
    if (const auto written = node.written.find(key(index, sub)); written != node.written.end()) return written->second;
    const ObjectEntry* entry = node.objects.find(index, sub);
    if (entry == nullptr) return std::nullopt;
    const auto& given = entry->configured_value ? entry->configured_value : entry->default_value;
    return given ? given->number : std::nullopt;
  };
  node.pdos.clear();
  for (const PdoDirection direction : {PdoDirection::to_node, PdoDirection::from_node})
    for (int number = 1; number <= 512; ++number) {
      const int first = direction == PdoDirection::to_node ? 0x1400 : 0x1800;
      const auto communication = static_cast<std::uint16_t>(first + number - 1);
      const auto mapping = static_cast<std::uint16_t>(communication + 0x200);
      const auto cob_id = value(communication, 1), count = value(mapping, 0);
      if (!cob_id || *cob_id & kNotThere || !count || *count < 1 || *count > 64) continue;
      std::vector<PdoEntry> entries;
      for (std::int64_t i = 1; i <= *count; ++i) {
        const auto mapped = static_cast<std::uint64_t>(value(mapping, static_cast<std::uint8_t>(i)).value_or(0));
        PdoEntry entry{static_cast<std::uint16_t>(mapped >> 16), static_cast<std::uint8_t>(mapped >> 8),
                       static_cast<std::uint8_t>(mapped), false};
        const ObjectEntry* object = node.objects.find(entry.index, entry.sub);
        entry.is_signed = object != nullptr && is_signed(object->type);
        entries.push_back(entry);
      }
      try {
        node.pdos.emplace_back(direction, number, id, static_cast<std::uint32_t>(*cob_id) & kIdBits, 255,
                               std::move(entries));
      } catch (const InputError&) {
      }
    }
}

}  // namespace foresight::canopen
