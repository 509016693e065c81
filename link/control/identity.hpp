// What both sides must have in common, compared when they meet.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace foresight {

/// Grows whenever the messages change so that an older program would misunderstand them. Only how Hello and Welcome
/// begin stays as it is, to the name of who says it: so two versions can tell each other which they are.
inline constexpr std::uint32_t kLineProtocol = 4;

/// Of a file's bytes: FNV-1a, 64 bits (G. Fowler, L. C. Noll, K.-P. Vo). Tells apart what differs by mistake; who wants
/// to deceive is for the line's security to keep out. Never 0.
std::uint64_t digest_of(std::string_view bytes);

/// One side, as it introduces itself.
struct Identity {
  std::uint32_t protocol = kLineProtocol;
  std::string program;                               ///< its version
  std::string name;                                  ///< who this is, for people: "lab", "anna at station 2"
  std::uint64_t urdf = 0, rig = 0, calibration = 0;  ///< digests; 0: has none
  std::vector<std::string> joints;                   ///< names, in the order of all positions
  std::uint64_t scene = 0;                           ///< digest of what stands around the cameras; 0: looks at none
};

/// One thing that the two sides do not have in common.
struct Difference {
  std::string words;     ///< what, with both sides' values
  std::string cure;      ///< what to do about it
  bool refuses = false;  ///< nobody commands across it
};

/// Another protocol, URDF, rig or order of joints refuses: a set-point would mean something else on the other side.
/// Across protocols nothing but the program's version is compared besides.
/// Another version of the same protocol, another calibration, or another scene where both look at one, is only told.
std::vector<Difference> differences(const Identity& robot, const Identity& other);
/// Those that refuse, in one line; "" where none does.
std::string refusal_text(std::span<const Difference> differences);

/// As it may be kept: no more names than a robot has joints, no text longer than a line.
Identity bounded(Identity from_outside);

}  // namespace foresight
