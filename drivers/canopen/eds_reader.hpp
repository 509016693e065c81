// Electronic data sheets and device configuration files (CiA 306): what objects a device has.
#pragma once

#include <filesystem>
#include <string_view>

#include "drivers/canopen/object_dictionary.hpp"

namespace foresight::canopen {

/// Reads the object lists and every object named in them. $NODEID in a value becomes `node` (1 .. 127).
/// Numbers are decimal, 0x... or octal with a leading 0 (CiA 306, 4.4). A value of a signed type may be
/// given as its bit pattern (0xFFFF for -1). CompactSubObj is expanded; CompactPDO is not. Sections that name
/// no object are skipped. Throws InputError with file:line.
ObjectDictionary read_eds(const std::filesystem::path& file, int node);
/// The same from memory; `file` is for messages.
ObjectDictionary parse_eds(std::string_view text, const std::filesystem::path& file, int node);

}  // namespace foresight::canopen
