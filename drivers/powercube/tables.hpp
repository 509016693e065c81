// The numbers of the PowerCube protocol by name. Private to this module.
#pragma once

#include "drivers/powercube/protocol.hpp"

namespace foresight::powercube {

struct CodeName {
  std::uint8_t code;
  const char* name;
};
extern const std::span<const CodeName> kBroadcastNames;  ///< of frames to 0x100
extern const std::span<const CodeName> kCommandNames;    ///< of frames to and from one module
const char* find_name(std::span<const CodeName> names, std::uint8_t code) noexcept;  ///< null: none

}  // namespace foresight::powercube
