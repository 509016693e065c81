// The recorded protocol facts, where they are at hand.
#pragma once

#include <cstdlib>
#include <filesystem>
#include <string>
#include <vector>

#include "common/text_rows.hpp"
#include "tests/support/folders.hpp"

namespace foresight::powercube {

inline std::filesystem::path can_data(const std::string& file) {
  return data_folder() / "can" / file;
}

/// Rows of a CSV file without its header.
inline std::vector<std::vector<std::string>> read_rows(const std::filesystem::path& file) {
  std::vector<std::vector<std::string>> out;
  for_each_row(file, {RowForm::Between::commas},
               [&](const TextRow& row) { out.emplace_back(row.fields.begin(), row.fields.end()); });
  if (!out.empty()) out.erase(out.begin());
  return out;
}

inline std::vector<std::uint8_t> bytes_of(const std::string& hex) {
  std::vector<std::uint8_t> out;
  for (std::size_t i = 0; i + 1 < hex.size(); i += 3)
    out.push_back(static_cast<std::uint8_t>(std::stoi(hex.substr(i, 2), nullptr, 16)));
  return out;
}

}  // namespace foresight::powercube
