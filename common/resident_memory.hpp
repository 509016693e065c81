// What this program holds of the machine's memory.
#pragma once

namespace foresight {

/// MB (1e6 bytes) that are resident, libraries and all. 0 where the system does not tell.
double resident_mb();

}  // namespace foresight
