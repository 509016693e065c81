#include "common/resident_memory.hpp"

#include <unistd.h>

#include <fstream>

namespace foresight {

double resident_mb() {
  std::ifstream file("/proc/self/statm");
  double all = 0, resident = 0;
  file >> all >> resident;
  return resident * static_cast<double>(::sysconf(_SC_PAGESIZE)) * 1e-6;
}

}  // namespace foresight
