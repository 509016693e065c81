#include <array>
#include <cstdio>
#include <iostream>

#include "apps/can_jobs.hpp"
#include "drivers/can/candump_log.hpp"
#include "drivers/canopen/describe.hpp"
#include "drivers/powercube/protocol.hpp"

namespace foresight {
namespace {

// The controller's own frames are none of the protocol's.
std::string explain(const CanFrame& frame, bool powercube) {
  if (frame.error) {
    char text[32];
    std::snprintf(text, sizeof text, "error frame, class 0x%03X", static_cast<unsigned>(frame.id));
    return text;
  }
  return powercube ? powercube::describe(frame) : canopen::describe(frame);
}

bool is_unknown(const std::string& text) {
  return text == "unknown" || text.ends_with(": unknown command") || text.find(": malformed, ") != std::string::npos;
}

}  // namespace

int explain_can(const CanExplainOptions& options) {
  CandumpReader log(options.file);
  std::array<char, kLongestLogLine> line;
  long long frames = 0, unknown = 0;
  while (const auto entry = log.next()) {
    const std::string text = explain(entry->frame, options.protocol == "powercube");
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
