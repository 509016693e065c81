#include <exception>

#include "apps/doctor/findings.hpp"
#include "link/dds/participant.hpp"

namespace foresight::doctor {

Findings check_link(const Rig& rig) {
  const LinkConfig& config = rig.link;
  const std::string place = "domain " + std::to_string(config.domain) + ", interface " + config.interface;
  // A host has the keys of one side only.
  std::string trouble;
  for (const link::Role role : {link::Role::robot, link::Role::operating, link::Role::observer}) try {
      const link::Participant program(config, "doctor", role);
      return {{Verdict::good, "link", place + (config.security ? ", with keys" : ""), ""}};
    } catch (const std::exception& error) {
      if (trouble.empty()) trouble = error.what();
    }
  return {{Verdict::bad, "link", trouble, ""}};
}

}  // namespace foresight::doctor
