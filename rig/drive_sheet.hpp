// What the electronic data sheet or configuration file of a CiA 402 drive tells that a rig needs.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace foresight {

struct DriveSheet {
  std::filesystem::path file;
  std::optional<std::uint32_t> vendor, product;  ///< 1018h
  std::optional<double> counts_per_turn;         ///< position units of the drive per turn of the joint's shaft; > 0
  std::string scaling;                           ///< where that comes from: "608Fh 4096 x 6091h 100"
  std::optional<double> fastest_rad_per_s;       ///< of the joint's shaft: 6080h through the gear
  bool can_home = true;                          ///< 6502h has the homing mode
  std::vector<int> homing_methods;               ///< 60E3h; empty: it does not tell
  std::optional<int> homing_method;              ///< 6098h as configured or by default; absent: none
  std::vector<std::string> lacks;                ///< objects that it does without: "607F:00 largest profile velocity"
};

/// Reads an EDS or DCF; values that a DCF configures go before defaults. Throws InputError naming the file: what
/// canopen::read_eds() refuses, another profile than 402, and what makes it impossible to drive it with foresight
/// robot: no cyclic synchronous position mode, or no object that stops it when its master falls silent.
DriveSheet read_drive_sheet(const std::filesystem::path& file);

}  // namespace foresight
