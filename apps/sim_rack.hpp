// Reads which drives are to be emulated from a YAML file.
#pragma once

#include <filesystem>
#include <vector>

#include "sim/drives/drive_node.hpp"

namespace foresight {

/// The file holds
///
///     drives:
///       - name: arm_1
///         kind: powercube            # or cia402
///         node: 1
///         counts_per_unit: 100000    # per rad or m; optional, like all that follows
///         dictionary: drive.dcf      # cia402, relative to the file
///         vendor, product, revision, serial: integers
///         homed: 1                   # 0: loses its position
///         start, home, min_position, max_position, min_stop, max_stop: rad or m
///         max_velocity, max_acceleration, inertia, load, following_error_limit: SI
///         limits_off: 1              # the drive keeps no limit
///
/// Throws InputError naming file, line and field.
std::vector<sim::NodeConfig> read_rack(const std::filesystem::path& file);

}  // namespace foresight
