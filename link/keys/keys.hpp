// Who may be on a line, and who may do what on it: certificates and signed permissions for DDS Security (OMG,
// version 1.1).
//
//   DIR/authority   the authority's own key: stays where it was made, it can make anybody a robot
//   DIR/robot       what the robot's host gets: its key and certificate, the rules, what it may do
//   DIR/operator    the same for the operator's host
//   DIR/observer    and for those who only look on
//
// Keys are of the curve P-256. Rules and permissions are XML, signed by the authority (S/MIME).
#pragma once

#include <cstdint>
#include <filesystem>

namespace foresight::link {

/// What a program is on a line.
enum class Role : std::uint8_t {
  robot,      ///< writes what the robot side writes
  operating,  ///< commands
  observer,   ///< reads everything, writes nothing
};
/// "robot", "operator", "observer": also the name of its folder.
const char* to_string(Role role);

/// Makes all of the above, for `days`, from now on. `folder` must not exist, or be empty; only its owner may read what
/// is in it. Throws InputError (something is there), RuntimeFailure (it cannot be written, or libcrypto fails).
void make_keys(const std::filesystem::path& folder, int days);

/// The files of one role; all of them are there, as check_keys() has seen to.
struct KeyFiles {
  std::filesystem::path authority, certificate, key, rules, permissions;
};
KeyFiles key_files(const std::filesystem::path& folder, Role role);

/// Throws InputError at `where` for what would keep the role off the line, saying which: no folder, a file that is
/// missing or damaged, a certificate that has expired or does not count yet (with the date), one that another authority
/// made, a key that is not the certificate's, permissions that are another role's or that another authority signed, or
/// that an older version made, which knew fewer topics.
void check_keys(const std::filesystem::path& folder, Role role, const std::string& where);

}  // namespace foresight::link
