// The first rig of one's own robot: made of its URDF, for mock drives and mock cameras.
#pragma once

#include <string>
#include <vector>

#include "rig/drive_sheet.hpp"
#include "rig/rig.hpp"

namespace foresight {

struct RigDraftOptions {
  std::filesystem::path urdf;                      ///< as given
  std::optional<std::filesystem::path> mesh_root;  ///< as given
  DriveProtocol protocol = DriveProtocol::cia402;
  std::optional<DriveSheet> sheet;  ///< CiA 402 only; of every drive
};

/// A joint as it will be in the file, and the reasons for its numbers.
struct DraftJoint {
  RigJoint joint;
  std::string urdf_says;  ///< "continuous", "10 rad/s"; for the comment behind it
};

/// A rig that passes all checks of read_rig(), and words about it.
struct RigDraft {
  Rig rig;
  std::vector<DraftJoint> joints;     ///< in the rig's order
  std::vector<std::string> notes;     ///< what was left out or is to be checked; one line each
  std::vector<std::string> warnings;  ///< what will keep it from working, and the cure; one line each
  bool visual_only = false;           ///< the URDF's collision meshes are not there: robot.shapes is `visual`
};

/// Every joint that moves on its own, in the URDF's order; those that follow another and fixed ones have no drive. What
/// the URDF and the sheet do not tell is chosen as rig_draft.cpp says. Throws InputError naming the joint or the file:
/// no joint that moves on its own, too many of them, a turning or sliding joint whose limits are none, what read_urdf()
/// refuses.
RigDraft draft_rig(const RigDraftOptions& options);

/// The draft as a rig file at `file`, to which paths are written relative, with comments that give the reasons.
std::string rig_text(const RigDraft& draft, const RigDraftOptions& options, const std::filesystem::path& file);

}  // namespace foresight
