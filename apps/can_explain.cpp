#include <fmt/core.h>

#include <array>
#include <functional>
#include <iostream>

#include "apps/can_jobs.hpp"
#include "common/error.hpp"
#include "common/text.hpp"
#include "drivers/can/candump_log.hpp"
#include "drivers/canopen/described_bus.hpp"
#include "drivers/powercube/motion_protocol.hpp"
#include "drivers/powercube/protocol.hpp"

namespace foresight {
namespace {

using Explain = std::function<std::string(const CanFrame&)>;

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

Explain explainer(const CanExplainOptions& options) {
  if (!options.eds.empty() && options.protocol != "cia402")
    throw InputError("--eds", "there are none with " + options.protocol, "leave it out, or say --protocol cia402");
  if (options.protocol == "powercube") return [](const CanFrame& frame) { return powercube::describe(frame); };
  if (options.protocol == "schunk-motion")
    return [](const CanFrame& frame) {
      const auto message = powercube::decode_motion(frame);
      return message ? powercube::describe(*message) : std::string("unknown");
    };
  return [bus = canopen::DescribedBus(data_sheets(options.eds))](const CanFrame& frame) mutable {
    return bus.describe(frame);
  };
}

bool is_unknown(const std::string& text) {
  return text == "unknown" || text.ends_with(": unknown command") || text.find(": malformed, ") != std::string::npos;
}

}  // namespace

int explain_can(const CanExplainOptions& options) {
  const Explain explain = explainer(options);
  CandumpReader log(options.file);
  std::array<char, kLongestLogLine> line;
  long long frames = 0, unknown = 0;
  while (const auto entry = log.next()) {
    // The controller's own frames are none of the protocol's.
    const std::string text =
        entry->frame.error ? fmt::format("error frame, class 0x{:03X}", entry->frame.id) : explain(entry->frame);
    ++frames;
    if (is_unknown(text)) ++unknown;
    const std::size_t length =
        write_log_line(entry->time.value_or(Duration{0}), entry->interface, entry->frame, entry->sent, line);
    std::cout.write(line.data(), static_cast<std::streamsize>(length - 1)) << "  " << text << '\n';
  }
  std::cout << frames << " frames, " << unknown << " unknown\n";
  return unknown == 0 ? 0 : 1;
}

}  // namespace foresight
