// What the subcommands of `foresight can` do. All throw InputError and RuntimeFailure, and return
// the exit code: 0, or 130 after Ctrl-C.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace foresight {

/// Lists the interfaces with what the kernel knows of them, and what to type where something is
/// missing. Returns 1 where none can be used (none there, or all down or bus-off).
int scan_can();

struct CanDumpOptions {
  std::string interface;
  bool fd = false;                           ///< FD frames too
  std::optional<long long> count;            ///< stop after so many frames
  std::optional<double> seconds;             ///< stop after so long
  std::optional<std::filesystem::path> log;  ///< and write a log there
  std::vector<std::string> filters;          ///< "ID:MASK" in hex, as candump's
};
/// Prints frames as can-utils' log form, with unix times.
int dump_can(const CanDumpOptions& options);

struct CanSendOptions {
  std::string interface, frame;
};
int send_can(const CanSendOptions& options);

struct CanReplayOptions {
  std::filesystem::path file;
  std::string interface;
  double speed = 1;
  double gap_ms = 1;
};
int replay_can(const CanReplayOptions& options);

struct CanExplainOptions {
  std::filesystem::path file;
  std::optional<std::string> protocol;       ///< "cia402", "powercube" or "schunk-motion"; or `rig`
  std::optional<std::filesystem::path> rig;  ///< protocols by the log's interfaces, and the names of joints
  std::vector<std::string> eds;    ///< "FILE" or "NODE=FILE": data sheets, which name the objects; cia402 only
  std::optional<int> node;         ///< only this one
  bool errors = false;             ///< only what went wrong
  std::optional<double> from, to;  ///< only these seconds, from the log's first frame on
  bool absolute = false;           ///< the log's own times
};
/// Prints a summary (lines with `#`, which readers of logs pass over), then each frame of a log with what it says in
/// words, and how many of all say nothing known. Returns 1 where there are any.
int explain_can(const CanExplainOptions& options);

}  // namespace foresight
