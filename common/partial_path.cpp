#include "common/partial_path.hpp"

#include <signal.h>
#include <unistd.h>

#include <cerrno>
#include <charconv>
#include <fstream>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace foresight {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kMark = ".partial-";

/// The process that `name` was written by, where it is the name of something partial.
std::optional<pid_t> writer_of(std::string_view name) {
  const std::size_t at = name.rfind(kMark);
  if (at == std::string_view::npos || at == 0) return std::nullopt;
  const std::string_view digits = name.substr(at + kMark.size());
  pid_t pid = 0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), pid);
  if (error != std::errc() || end != digits.data() + digits.size() || pid <= 0) return std::nullopt;
  return pid;
}

/// Gone, or ended and not yet waited for by its parent (proc(5): the state follows the name in parentheses).
bool is_dead(pid_t pid) {
  if (::kill(pid, 0) != 0 && errno == ESRCH) return true;
  std::ifstream stream("/proc/" + std::to_string(pid) + "/stat");
  const std::string stat{std::istreambuf_iterator<char>(stream), {}};
  const std::size_t at = stat.rfind(") ");
  return at != std::string::npos && (stat[at + 2] == 'Z' || stat[at + 2] == 'X');
}

void sweep(const fs::path& folder, const std::string& prefix) noexcept {
  try {
    std::error_code ignored;
    std::vector<fs::path> dead;
    for (fs::directory_iterator at(folder, ignored), end; at != end; at.increment(ignored)) {
      const std::string name = at->path().filename().string();
      if (!name.starts_with(prefix)) continue;
      if (const auto pid = writer_of(name); pid && is_dead(*pid)) dead.push_back(at->path());
    }
    for (const fs::path& path : dead) fs::remove_all(path, ignored);
  } catch (const std::exception&) {  // out of memory: the next one sweeps
  }
}

}  // namespace

fs::path without_end_slash(const fs::path& path) {
  return path.has_filename() ? path : path.parent_path();
}

fs::path partial_path(const fs::path& target) {
  return without_end_slash(target) += std::string(kMark) + std::to_string(::getpid());
}

bool is_partial(const fs::path& path) {
  return writer_of(path.filename().string()).has_value();
}

void sweep_partials(const fs::path& target) noexcept {
  try {
    const fs::path folder = target.parent_path();
    sweep(folder.empty() ? fs::path(".") : folder, target.filename().string() + std::string(kMark));
  } catch (const std::exception&) {
  }
}

void sweep_partials_in(const fs::path& folder) noexcept {
  sweep(folder, "");
}

}  // namespace foresight
