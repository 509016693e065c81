// A run folder from a recorded line.
#pragma once

#include <filesystem>
#include <istream>
#include <optional>
#include <string>

namespace foresight::link {

struct RunExportOptions {
  std::filesystem::path recording;             ///< for messages
  std::filesystem::path out;                   ///< the run; an earlier one there is replaced
  std::optional<std::filesystem::path> rig;    ///< in place of the recorded one
  std::optional<std::filesystem::path> scene;  ///< in place of the rig's
  bool mock = false;                           ///< the cameras were mock ones, whatever rig and recording say
};

struct RunExport {
  std::uint64_t pairs = 0, without_pose = 0;
  std::string remarks;  ///< what could not be used and why, one a line; "" where all could
  std::string fault;    ///< why it ended early (RunRecorder::fault()); "" where it did not
};

/// Decodes every recorded pair, of either coding, and writes it with its poses, and where everything that moves was by
/// the joints of that instant. Throws InputError (no recording; no rig in it; what the rig lacks; no pair that can be
/// used, or none with a pose), RuntimeFailure (the disk); then nothing is left.
RunExport export_run(const RunExportOptions& options);

}  // namespace foresight::link
