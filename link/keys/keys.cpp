#include "link/keys/keys.hpp"

#include <fmt/core.h>

#include <array>
#include <ctime>
#include <vector>

#include "common/atomic_file.hpp"
#include "common/error.hpp"
#include "common/partial_path.hpp"
#include "common/read_file.hpp"
#include "link/keys/certificates.hpp"

namespace foresight::link {
namespace fs = std::filesystem;
namespace {

constexpr std::array kRoles{Role::robot, Role::operating, Role::observer};
constexpr const char* kAuthority = "authority";

std::string subject_of(Role role) {
  return std::string("foresight ") + to_string(role);
}

/// Everybody must prove who it is, and everything is encrypted, discovery included.
std::string rules() {
  return R"(<?xml version="1.0" encoding="utf-8"?>
<dds xmlns:xsi="http://www.w3.org/2001/XMLSchema-instance"
     xsi:noNamespaceSchemaLocation="http://www.omg.org/spec/DDS-SECURITY/20170901/omg_shared_ca_governance.xsd">
  <domain_access_rules>
    <domain_rule>
      <domains><id_range><min>0</min><max>230</max></id_range></domains>
      <allow_unauthenticated_participants>false</allow_unauthenticated_participants>
      <enable_join_access_control>true</enable_join_access_control>
      <discovery_protection_kind>ENCRYPT</discovery_protection_kind>
      <liveliness_protection_kind>ENCRYPT</liveliness_protection_kind>
      <rtps_protection_kind>NONE</rtps_protection_kind>
      <topic_access_rules>
        <topic_rule>
          <topic_expression>*</topic_expression>
          <enable_discovery_protection>true</enable_discovery_protection>
          <enable_liveliness_protection>true</enable_liveliness_protection>
          <enable_read_access_control>true</enable_read_access_control>
          <enable_write_access_control>true</enable_write_access_control>
          <metadata_protection_kind>ENCRYPT</metadata_protection_kind>
          <data_protection_kind>NONE</data_protection_kind>
        </topic_rule>
      </topic_access_rules>
    </domain_rule>
  </domain_access_rules>
</dds>
)";
}

/// Topics that a role may write, of what others must be able to rely on. Everything may be read by all who are let in.
std::vector<std::string> writes(Role role) {
  switch (role) {
    case Role::robot:
      return {"rt/joint_states",
              "rt/tf",
              "rt/tf_static",
              "rt/diagnostics",
              "rt/left/*",
              "rt/right/*",
              "rt/foresight/frames",
              "rt/foresight/pieces",
              "rt/foresight/robot_state",
              "rt/foresight/set_points",
              "rt/foresight/gate_motion",
              "rt/foresight/control/robot/*"};
    case Role::operating: return {"rt/foresight/reports", "rt/foresight/control/operator/*"};
    case Role::observer: break;
  }
  return {};
}

std::string topic_element(const std::string& topic) {
  return fmt::format("<topic>{}</topic>", topic);
}

std::string may_write(Role role) {
  std::string out;
  for (const std::string& topic : writes(role)) out += "          " + topic_element(topic) + "\n";
  return out.empty() ? out : "        <publish><topics>\n" + out + "        </topics></publish>\n";
}

std::string date(std::time_t time) {
  std::tm parts{};
  ::gmtime_r(&time, &parts);
  return fmt::format("{:04}-{:02}-{:02}T{:02}:{:02}:{:02}", parts.tm_year + 1900, parts.tm_mon + 1, parts.tm_mday,
                     parts.tm_hour, parts.tm_min, parts.tm_sec);
}

std::string permissions(Role role, const Validity& validity) {
  return fmt::format(R"(<?xml version="1.0" encoding="utf-8"?>
<dds xmlns:xsi="http://www.w3.org/2001/XMLSchema-instance"
     xsi:noNamespaceSchemaLocation="http://www.omg.org/spec/DDS-SECURITY/20170901/omg_shared_ca_permissions.xsd">
  <permissions>
    <grant name="{0}">
      <subject_name>CN={1}</subject_name>
      <validity><not_before>{2}</not_before><not_after>{3}</not_after></validity>
      <allow_rule>
        <domains><id_range><min>0</min><max>230</max></id_range></domains>
{4}        <subscribe><topics><topic>*</topic></topics></subscribe>
      </allow_rule>
      <default>DENY</default>
    </grant>
  </permissions>
</dds>
)",
                     to_string(role), subject_of(role), date(validity.from), date(validity.to), may_write(role));
}

void make_private_folder(const fs::path& folder) {
  fs::create_directories(folder);
  fs::permissions(folder, fs::perms::owner_all);
}

std::string read(const fs::path& file, const std::string& where, Role role) {
  if (!fs::is_regular_file(file))
    throw InputError(
        where,
        "the " + std::string(to_string(role)) + "'s " + file.filename().string() + " is missing: " + file.string(),
        "copy the folder '" + std::string(to_string(role)) + "' of `foresight link keys` there");
  return read_file(file);
}

void write_keys(const fs::path& folder, int days) {
  const std::time_t now = std::time(nullptr);
  const Validity validity{now - 3600, now + std::time_t{days} * 24 * 3600};  // clocks differ
  const Credentials authority = make_credentials("foresight authority", validity, nullptr);
  make_private_folder(folder);
  make_private_folder(folder / kAuthority);
  write_file_atomically(folder / kAuthority / "key.pem", authority.key_pem);
  write_file_atomically(folder / kAuthority / "certificate.pem", authority.certificate_pem);
  const std::string signed_rules = sign(authority, rules());
  for (const Role role : kRoles) {
    make_private_folder(folder / to_string(role));
    const Credentials made = make_credentials(subject_of(role), validity, &authority);
    const KeyFiles files = key_files(folder, role);
    write_file_atomically(files.authority, authority.certificate_pem);
    write_file_atomically(files.certificate, made.certificate_pem);
    write_file_atomically(files.key, made.key_pem);
    write_file_atomically(files.rules, signed_rules);
    write_file_atomically(files.permissions, sign(authority, permissions(role, validity)));
  }
}

}  // namespace

const char* to_string(Role role) {
  switch (role) {
    case Role::robot: return "robot";
    case Role::operating: return "operator";
    case Role::observer: return "observer";
  }
  return "?";
}

KeyFiles key_files(const fs::path& folder, Role role) {
  const fs::path at = folder / to_string(role);
  return {at / "authority.pem", at / "certificate.pem", at / "key.pem", at / "rules.p7s", at / "permissions.p7s"};
}

void make_keys(const fs::path& folder, int days) {
  if (fs::exists(folder) && !fs::is_empty(folder))
    throw InputError(folder.string(), "has something in it", "name a new folder: keys replace nothing");
  // Half of the keys would be worse than none. A folder that is there may be the root of another disk.
  const bool is_there = fs::exists(folder);
  const fs::path partial = partial_path(is_there ? folder / "keys" : folder);
  try {
    write_keys(partial, days);
    if (is_there) {
      fs::permissions(folder, fs::perms::owner_all);
      for (const fs::directory_entry& made : fs::directory_iterator(partial))
        fs::rename(made.path(), folder / made.path().filename());
      fs::remove(partial);
    } else {
      fs::rename(partial, folder);
    }
  } catch (const std::exception& error) {
    std::error_code ignored;
    fs::remove_all(partial, ignored);
    if (const auto* const failure = dynamic_cast<const fs::filesystem_error*>(&error))
      throw RuntimeFailure("cannot write " + folder.string() + " (" + failure->code().message() + ")",
                           "choose a writable place");
    throw;
  }
}

void check_keys(const fs::path& folder, Role role, const std::string& where) {
  if (!fs::is_directory(folder))
    throw InputError(where, "there is no folder " + folder.string() + " with keys",
                     "make one with `foresight link keys`, and give its path, relative to the rig file");
  const KeyFiles files = key_files(folder, role);
  const std::string authority = read(files.authority, where, role), certificate = read(files.certificate, where, role),
                    key = read(files.key, where, role), signed_rules = read(files.rules, where, role),
                    signed_permissions = read(files.permissions, where, role);
  const std::string anew = "make keys anew with `foresight link keys`, and copy them to all hosts";
  const auto refuse = [&](const fs::path& file, const std::string& what) {
    throw InputError(where, file.string() + " " + what, anew);
  };
  for (const auto& [file, pem] : {std::pair{files.authority, authority}, {files.certificate, certificate}})
    if (const std::string wrong = objection_to(pem, std::time(nullptr)); !wrong.empty()) refuse(file, wrong);
  if (!is_made_by(certificate, authority)) refuse(files.certificate, "was made by another authority");
  if (!belongs_to(key, certificate)) refuse(files.key, "is not the key of its certificate");
  for (const auto& [file, text] : {std::pair{files.rules, signed_rules}, {files.permissions, signed_permissions}})
    if (!is_signed_by(text, authority)) refuse(file, "was not signed by this authority, or was changed");
  if (signed_permissions.find("CN=" + subject_of(role) + "<") == std::string::npos)
    refuse(files.permissions, "does not permit the role " + std::string(to_string(role)));
  // Signed by a version that knew fewer topics: what is missing would be told by no word of DDS's, or by one that names
  // neither file nor cure.
  for (const std::string& topic : writes(role))
    if (signed_permissions.find(topic_element(topic)) == std::string::npos)
      refuse(files.permissions, "is of an older version: it does not permit to write " + topic);
}

}  // namespace foresight::link
