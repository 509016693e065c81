// Reads an object dictionary from a device configuration file or an electronic data sheet (CiA 306-1).
#pragma once

#include <filesystem>
#include <string_view>

#include "sim/drives/object_dictionary.hpp"

namespace foresight::sim {

/// All objects of the sections [1000] .. [FFFF] and [1018sub1] .. with their data types, access, limits and values
/// (ParameterValue, else DefaultValue, else 0; `$NODEID+...` is resolved). Other sections are skipped. Also reads
/// CompactSubObj. Throws InputError naming file and line: no such file, more than 1 MiB or 20,000 objects, a line
/// that is neither section, key nor comment, a section given twice, a data type or access that is unknown, a value
/// that does not fit its type.
ObjectDictionary read_dcf(const std::filesystem::path& file, int node);
/// The same of text in memory; `name` is for messages.
ObjectDictionary parse_dcf(std::string_view text, int node, const std::filesystem::path& name);

}  // namespace foresight::sim
