// What `foresight record --line`, `play` and `export-run` do.
#pragma once

#include "apps/link_jobs.hpp"

namespace foresight {

struct RecordLineOptions {
  LinkPlace place;  ///< its rig goes into the recording, with the files that it names
  std::string file;
  bool mock = false, pictures = false;
  std::optional<double> seconds;
};
struct PlayOptions {
  LinkPlace place;
  std::string file;
  double rate = 1, from = 0;
};
struct ExportRunOptions {
  std::string file, out, rig, scene;
  bool mock = false;
};

/// Each returns the exit code. They throw what Participant does; InputError (no recording, nothing to play in it, a
/// robot beside the recording), RuntimeFailure (a disk).
int record_line(const RecordLineOptions& options);
int play(const PlayOptions& options);
int export_run(const ExportRunOptions& options);

}  // namespace foresight
