// Numbers for other programs: a JSON object in a file of its own.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

namespace foresight {

/// Writes `object` ("{...}") with "generator": "foresight" as its first key, by which a later run knows that it may
/// replace the file; nothing where there is no `file`. Throws RuntimeFailure like write_file_atomically.
void write_numbers(const std::optional<std::filesystem::path>& file, const std::string& object);

}  // namespace foresight
