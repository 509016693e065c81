// The files of a rig, in a recording and out of it again.
#pragma once

#include <filesystem>
#include <span>

#include "link/recording/mcap_writer.hpp"

namespace foresight::link {

/// Name of the metadata that say what a recording is of: "rig", the rig file's attachment; "mock", "yes" or "no".
inline constexpr const char* kRecordingFacts = "foresight";
/// Attachments' names begin with it.
inline constexpr const char* kRigFolder = "rig/";

/// Attaches `files`, of which the first is the rig file, under their places below the deepest folder that has all of
/// them: so that each still finds the others. Returns the rig file's name. Throws InputError where one cannot be read.
std::string attach_rig(McapWriter& out, std::span<const std::filesystem::path> files, std::int64_t time_ns);

/// A folder of its own, that goes with this. One thread.
class UnpackedRig {
 public:
  /// Throws RuntimeFailure where none can be made.
  UnpackedRig();
  ~UnpackedRig();
  UnpackedRig(const UnpackedRig&) = delete;

  /// Keeps what attach_rig() attached, and no other. Throws InputError for a name that leads elsewhere, RuntimeFailure
  /// where it cannot be written.
  void take(const std::string& name, std::span<const std::uint8_t> data);
  std::filesystem::path file(const std::string& name) const;

 private:
  std::filesystem::path folder_;
};

}  // namespace foresight::link
