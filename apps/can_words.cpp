#include "apps/can_words.hpp"

#include <fmt/core.h>

#include <set>

#include "common/error.hpp"
#include "common/text.hpp"
#include "drivers/canopen/described_bus.hpp"
#include "drivers/canopen/emcy.hpp"
#include "drivers/canopen/nmt.hpp"
#include "drivers/canopen/wire.hpp"
#include "drivers/powercube/motion_protocol.hpp"
#include "drivers/powercube/protocol.hpp"

namespace foresight {
namespace {

bool is_unknown(const std::string& text) {
  return text == "unknown" || text.ends_with(": unknown command") || text.find(": malformed, ") != std::string::npos;
}

/// Whether a fault is told that was not there before; it is told in every cycle as long as it lasts.
class NewFaults {
 public:
  bool operator()(int node, bool faulty) { return faulty ? faulty_.insert(node).second : (faulty_.erase(node), false); }

 private:
  std::set<int> faulty_;
};

/// A status word, by its mapping or by the default one.
bool tells_fault(const std::string& text) {
  return text.find("(fault") != std::string::npos || text.find("status word: fault") != std::string::npos;
}

/// "FILE" for all nodes, or "NODE=FILE".
canopen::DataSheets data_sheets(const std::vector<std::string>& options) {
  canopen::DataSheets out;
  for (const std::string& text : options) {
    const std::size_t equals = std::min(text.find('='), text.size());
    const auto node = parse_integer(std::string_view(text).substr(0, equals));
    const bool again =
        node ? !out.of_node.emplace(static_cast<int>(*node), text.substr(equals + 1)).second : out.of_all.has_value();
    if (again) throw InputError("--eds", in_quotes(text) + " is a second one", "give NODE=FILE once for each node");
    if (!node) out.of_all = text;
  }
  return out;
}

class CanopenWords final : public BusWords {
 public:
  explicit CanopenWords(const std::vector<std::string>& eds) : bus_(data_sheets(eds)) {}

  ExplainedFrame explain(const CanFrame& frame) override {
    ExplainedFrame out{bus_.describe(frame), kind_of(frame), {}, false, false};
    out.unknown = is_unknown(out.text);
    if (out.unknown) {
      out.kind = "unknown";
      return out;
    }
    if (frame.id == canopen::kNmtId && frame.data[1] > 0) out.node = frame.data[1];
    if (const int node = frame.id & 0x7f; node > 0 && frame.id != canopen::kNmtId) out.node = node;
    const auto emergency = canopen::parse_emergency(frame);
    const auto heartbeat = canopen::parse_heartbeat(frame);
    const bool pdo = out.kind == std::string_view("TPDO");
    const bool starts = heartbeat && heartbeat->state == canopen::NmtState::boot_up;
    out.trouble = (emergency && emergency->code != 0) || is_abort_of_one_that_hears(frame, out) ||
                  (starts && heard_.contains(*out.node)) ||
                  (pdo && new_fault_(out.node.value_or(0), tells_fault(out.text)));
    if (out.node && !starts && is_from_node(frame.id)) heard_.insert(*out.node);
    if (frame.id == canopen::kNmtId) forget_reset(frame);
    return out;
  }

 private:
  static const char* kind_of(const CanFrame& frame) {
    const std::uint32_t id = frame.id;
    if (id == canopen::kNmtId) return "NMT";
    if (id == canopen::kSyncId) return "SYNC";
    if (id < canopen::kTimeId) return "EMCY";
    if (id == canopen::kTimeId) return "TIME";
    if (id < canopen::kSdoAnswerId) return id & 0x80 ? "TPDO" : "RPDO";
    return id < canopen::kHeartbeatId ? "SDO" : "heartbeat";
  }

  /// Emergencies, TPDOs, SDO answers and heartbeats.
  static bool is_from_node(std::uint32_t id) {
    return id < canopen::kTimeId || (id < canopen::kSdoRequestId && (id & 0x80) != 0) || id > canopen::kHeartbeatId;
  }

  /// A node that was asked before it had booted answers nothing, and nothing is wrong with that, if it boots later.
  bool is_abort_of_one_that_hears(const CanFrame& frame, const ExplainedFrame& words) {
    if (const auto heartbeat = canopen::parse_heartbeat(frame);
        heartbeat && heartbeat->state == canopen::NmtState::boot_up)
      booted_.insert(heartbeat->node);
    if (words.kind != std::string_view("SDO") || !words.node) return false;
    const bool asks = frame.id >= canopen::kSdoRequestId;
    if (words.text.find(": abort ") == std::string::npos) {
      if (asks && !heard_.contains(*words.node) && !booted_.contains(*words.node)) asked_early_.insert(*words.node);
      return false;
    }
    const bool too_early = asked_early_.erase(*words.node) > 0 && booted_.contains(*words.node);
    return !(asks && too_early);
  }

  /// A node that the master resets boots up, and nothing is wrong with that.
  void forget_reset(const CanFrame& frame) {
    const auto command = static_cast<canopen::NmtCommand>(frame.data[0]);
    if (command != canopen::NmtCommand::reset_node && command != canopen::NmtCommand::reset_communication) return;
    if (frame.data[1] == 0)
      heard_.clear();
    else
      heard_.erase(frame.data[1]);
  }

  canopen::DescribedBus bus_;
  NewFaults new_fault_;
  std::set<int> heard_;                 // nodes that were up: a boot-up from these is a restart
  std::set<int> booted_, asked_early_;  // that booted; that were asked before they did
};

class PowercubeWords final : public BusWords {
 public:
  ExplainedFrame explain(const CanFrame& frame) override {
    using Kind = powercube::Message::Kind;
    const powercube::Message m = powercube::decode(frame);
    ExplainedFrame out{powercube::describe(frame), kind_of(m), {}, m.kind == Kind::unknown, false};
    if (!out.unknown && m.kind != Kind::broadcast) out.node = m.module;
    const bool refused =
        (m.kind == Kind::set_answer || m.kind == Kind::order_answer || m.kind == Kind::motion_answer) && !m.accepted;
    const bool state = m.is(Kind::value, powercube::Param::cube_state);
    const bool faulty = state && *powercube::fault_of(static_cast<std::uint32_t>(m.value)) != '\0';
    out.trouble = refused || (state && new_fault_(m.module, faulty));
    return out;
  }

 private:
  static const char* kind_of(const powercube::Message& m) {
    using Kind = powercube::Message::Kind;
    switch (m.kind) {
      case Kind::unknown: return "unknown";
      case Kind::get: return "Get";
      case Kind::set: return "Set";
      case Kind::order: return "command";
      case Kind::motion:
      case Kind::istep: return "motion";
      case Kind::broadcast: return "broadcast";
      case Kind::position: return "position";
      default: return "answer";
    }
  }

  NewFaults new_fault_;
};

class MotionWords final : public BusWords {
 public:
  ExplainedFrame explain(const CanFrame& frame) override {
    const auto message = powercube::decode_motion(frame);
    if (!message) return {"unknown", "unknown", {}, true, false};
    const bool from_master = message->sender == powercube::MotionSender::master;
    return {powercube::describe(*message), from_master ? "command" : "answer", message->module, false,
            message->command == powercube::MotionCommand::error};
  }
};

}  // namespace

LogWords::LogWords(const CanExplainOptions& options) : options_(options) {
  if (options.rig && options.protocol)
    throw InputError("--protocol", "stands beside --rig, which says it", "leave one out");
  if (!options.rig && !options.protocol)
    throw InputError("can explain", "does not know what the bus speaks",
                     "give the rig with --rig, or say --protocol cia402, powercube or schunk-motion");
  if (!options.eds.empty() && options.protocol && options.protocol != "cia402")
    throw InputError("--eds", "there are none with " + *options.protocol, "leave it out, or say --protocol cia402");
  if (options.rig) rig_ = read_rig(*options.rig);
  if (!options.eds.empty()) CanopenWords(options.eds);  // before the first frame: a file that cannot be read
}

const RigBus* LogWords::bus_of(const std::string& interface) const {
  if (!rig_) return nullptr;
  for (const RigBus& bus : rig_->buses)
    if (bus.interface == interface || bus.name == interface) return &bus;
  throw InputError("--rig", "no bus of it has the log's interface " + in_quotes(interface),
                   "give the rig that the log is of, or --protocol");
}

std::unique_ptr<BusWords> LogWords::make(const std::string& interface) const {
  const RigBus* bus = bus_of(interface);
  const bool powercube = bus ? bus->protocol == DriveProtocol::powercube : options_.protocol == "powercube";
  if (powercube) return std::make_unique<PowercubeWords>();
  if (!bus && options_.protocol == "schunk-motion") return std::make_unique<MotionWords>();
  return std::make_unique<CanopenWords>(options_.eds);
}

ExplainedFrame LogWords::explain(const CanLogEntry& entry) {
  // The controller's own frames are none of the protocol's.
  if (entry.frame.error)
    return {fmt::format("error frame, class 0x{:03X}", entry.frame.id), "error frame", {}, false, true};
  auto bus = buses_.find(entry.interface);
  if (bus == buses_.end()) bus = buses_.emplace(entry.interface, make(entry.interface)).first;
  ExplainedFrame out = bus->second->explain(entry.frame);
  if (rig_ && out.node) {
    const std::string name = node_name(entry.interface, *out.node);
    if (const std::size_t open = name.find('('); open != std::string::npos)
      out.text = name.substr(open + 1, name.size() - open - 2) + ": " + out.text;
  }
  return out;
}

std::string LogWords::node_name(const std::string& interface, int node) const {
  const RigBus* bus = bus_of(interface);
  if (bus)
    for (const RigJoint& joint : rig_->joints)
      if (&rig_->buses[joint.bus] == bus && joint.drive.node == node)
        return std::to_string(node) + " (" + joint.drive.name + ")";
  return std::to_string(node);
}

}  // namespace foresight
