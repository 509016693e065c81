// Real-time permissions, graphics and network buffers.
#include <sys/resource.h>

#include <filesystem>
#include <fstream>

#include "apps/doctor/findings.hpp"
#include "common/error.hpp"
#include "common/text.hpp"
#include "gl/context.hpp"

namespace foresight::doctor {
namespace {

std::string first_line(const std::filesystem::path& file) {
  std::ifstream stream(file);
  std::string line;
  std::getline(stream, line);
  return line;
}

}  // namespace

Findings check_real_time() {
  Findings out;
  rlimit priority{}, memory{};
  getrlimit(RLIMIT_RTPRIO, &priority);
  getrlimit(RLIMIT_MEMLOCK, &memory);
  const bool root = geteuid() == 0;
  if (root || priority.rlim_cur >= 80)
    out.push_back({Verdict::good, "real-time priority", "allowed", ""});
  else
    out.push_back({Verdict::poor, "real-time priority", "not allowed: other programs can delay the control loop",
                   "echo '@realtime - rtprio 90' | sudo tee -a /etc/security/limits.conf; sudo groupadd -f realtime; "
                   "sudo usermod -aG realtime $USER; log in again"});
  if (root || memory.rlim_cur == RLIM_INFINITY)
    out.push_back({Verdict::good, "locked memory", "allowed", ""});
  else
    out.push_back(
        {Verdict::poor, "locked memory",
         "limited to " + std::to_string(memory.rlim_cur >> 10) + " KiB: the control loop may wait for the disk",
         "echo '@realtime - memlock unlimited' | sudo tee -a /etc/security/limits.conf; log in again"});
  const bool preemptive = first_line("/sys/kernel/realtime") == "1";
  out.push_back({preemptive ? Verdict::good : Verdict::absent, "real-time kernel",
                 preemptive ? "running" : "not running; the control loop works without, less punctually",
                 preemptive ? "" : "sudo apt-get install linux-image-rt-amd64, if overruns are counted"});
  const std::string governor = first_line("/sys/devices/system/cpu/cpu0/cpufreq/scaling_governor");
  if (!governor.empty() && governor != "performance")
    out.push_back({Verdict::poor, "processor clock",
                   "governor '" + governor + "' slows the processor down while it waits",
                   "echo performance | sudo tee /sys/devices/system/cpu/cpu*/cpufreq/scaling_governor"});
  return out;
}

Findings check_graphics() {
  try {
    const auto context = gl::create_headless_context();
    const gl::DriverInfo driver = gl::query_driver();
    if (driver.is_software)
      return {{Verdict::poor, "OpenGL", driver.renderer + ", a software renderer: a few images per second",
               "install the driver of the graphics card; a card with OpenGL 4.5 shows 90 views per second"}};
    return {{Verdict::good, "OpenGL", driver.renderer + ", " + driver.version, ""}};
  } catch (const std::exception& error) {
    return {{Verdict::bad, "OpenGL", error.what(), "sudo apt-get install libegl-mesa0 libgl1-mesa-dri"}};
  }
}

Findings check_network() {
  constexpr long long kWanted = 4 << 20;
  const auto most = parse_integer(first_line("/proc/sys/net/core/rmem_max"));
  if (!most) return {{Verdict::absent, "network buffers", "the kernel does not say how large they may be", ""}};
  if (*most >= kWanted)
    return {{Verdict::good, "network buffers", "up to " + std::to_string(*most >> 10) + " KiB", ""}};
  return {{Verdict::poor, "network buffers",
           "at most " + std::to_string(*most >> 10) + " KiB: bursts of image packets may be lost",
           "sudo sysctl -w net.core.rmem_max=" + std::to_string(kWanted)}};
}

}  // namespace foresight::doctor
