#include <exception>
#include <filesystem>

#include "apps/doctor/findings.hpp"
#include "link/dds/participant.hpp"

namespace foresight::doctor {

Findings check_link(const Rig& rig) {
  const LinkConfig& config = rig.link;
  // A host has the keys of its own side only, and is not to be given the other's.
  std::vector<link::Role> roles;
  for (const link::Role role : {link::Role::robot, link::Role::operating, link::Role::observer})
    if (config.security && std::filesystem::is_directory(*config.security / to_string(role))) roles.push_back(role);
  if (roles.empty()) roles.push_back(link::Role::observer);  // without keys, any; else the words for what is missing
  std::string who;
  for (const link::Role role : roles) try {
      const link::Participant program(config, "doctor", role);
      if (config.security) who += std::string(who.empty() ? ", keys of " : ", ") + to_string(role);
    } catch (const std::exception& error) {
      return {{Verdict::bad, "link", error.what(), ""}};
    }
  return {{Verdict::good, "link", config.place() + who, ""}};
}

}  // namespace foresight::doctor
