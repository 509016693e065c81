// Runs the built program as a user would, and keeps what it said.
#pragma once

#include <sys/types.h>

#include <chrono>
#include <csignal>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "tests/support/patience.hpp"

namespace foresight {

struct Outcome {
  int exit_code = -1;  ///< 128 + n where signal n ended it
  std::string out, err;
  double seconds = 0;

  /// Last line on stderr, without its end.
  std::string last_line() const;
};

struct ProgramOptions {
  std::map<std::string, std::string> environment = {};  ///< added to this process's; an empty value unsets
  std::string shell = {};             ///< run by sh before the program takes its place: "ulimit -f 8", "exec >&-"
  std::filesystem::path folder = {};  ///< where it runs; empty: here
};

/// A running child. One thread. Killed with its life's end.
class Program {
 public:
  /// Starts `foresight arguments...`. Throws std::system_error.
  explicit Program(const std::vector<std::string>& arguments, const ProgramOptions& options = {});
  ~Program();
  Program(const Program&) = delete;
  Program& operator=(const Program&) = delete;

  pid_t pid() const { return pid_; }
  bool running();
  /// What it has said on stderr so far.
  std::string said() const { return read("err"); }
  void interrupt(int signal = SIGINT) const;  ///< SIGINT, as Ctrl-C sends it, or another one

  /// Waits; kills it and reports exit code 137 `timeout` after its start; where none is given, a little before its test
  /// is ended as one that hangs.
  Outcome wait(std::chrono::seconds timeout = std::chrono::seconds(9 * hangs_after_s() / 10));

 private:
  std::string read(const char* name) const;

  std::filesystem::path folder_;  // holds stdout and stderr: pipes could fill up
  std::chrono::steady_clock::time_point start_;
  pid_t pid_ = -1;
  int status_ = 0;
  bool ended_ = false;
};

/// Starts and waits.
Outcome run_program(const std::vector<std::string>& arguments, const ProgramOptions& options = {});

}  // namespace foresight
