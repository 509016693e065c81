#include "apps/bench/taken_cores.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <thread>
#include <utility>

#include "common/cpu_time.hpp"

namespace foresight {
namespace {

namespace fs = std::filesystem;

UniqueFd open_statistics(const fs::path& task) {
  return UniqueFd(::open((task / "schedstat").c_str(), O_RDONLY | O_CLOEXEC));
}

/// Seconds; the file says "run_ns wait_ns slices".
double waited(const UniqueFd& file) {
  char text[96] = {};
  unsigned long long run = 0, wait = 0;
  if (!file || ::pread(file.get(), text, sizeof(text) - 1, 0) <= 0) return 0;
  return std::sscanf(text, "%llu %llu", &run, &wait) == 2 ? 1e-9 * static_cast<double>(wait) : 0;
}

bool has_name(const fs::path& task, const std::string& beginning) {
  std::ifstream stream(task / "comm");
  std::string name;
  return std::getline(stream, name) && name.starts_with(beginning);
}

}  // namespace

TakenCores::TakenCores(const std::string& helpers) : cores_(std::max(1u, std::thread::hardware_concurrency())) {
  const fs::path all = "/proc/self/task";
  const std::string self = std::to_string(::gettid());
  threads_.push_back({open_statistics(all / self), 0});
  std::error_code none;
  for (const auto& task : fs::directory_iterator(all, none))
    if (task.path().filename() != self && has_name(task.path(), helpers))
      threads_.push_back({open_statistics(task.path()), 0});
  since_last();
}

double TakenCores::since_last() {
  double own = 0, helpers = 0;
  for (std::size_t i = 0; i < threads_.size(); ++i) {
    const double now = waited(threads_[i].file), more = now - std::exchange(threads_[i].waited_s, now);
    i == 0 ? own = more : helpers = std::max(helpers, more);
  }
  const double wall = cpu_seconds(CLOCK_MONOTONIC), cpu = cpu_seconds(CLOCK_PROCESS_CPUTIME_ID);
  const double passed = wall - std::exchange(wall_s_, wall), used = cpu - std::exchange(cpu_s_, cpu);
  return std::clamp(std::min(own + helpers, cores_ * passed - used), 0.0, passed);
}

}  // namespace foresight
