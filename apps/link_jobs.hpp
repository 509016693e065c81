// What `foresight link` does.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "link/config/link_config.hpp"
#include "link/operator_side/operator_end.hpp"

namespace foresight {

/// Where the line is: a rig's `link:` section, and what is given in its place.
struct LinkPlace {
  std::string rig;  ///< "": the defaults
  std::optional<int> domain;
  std::string interface, keys, line;  ///< `line`: file of a line that is pretended (link/line)
  std::vector<std::string> peers;
};

struct LinkStatusOptions {
  LinkPlace place;
  double seconds = 2;
};
struct LinkListenOptions {
  LinkPlace place;
  std::string topic;
  std::optional<std::uint64_t> count;
  std::optional<double> seconds;
};
struct LinkRateOptions {
  LinkPlace place;
  std::string topic;
  double seconds = 5;
};

struct LinkKeysOptions {
  std::string folder;
  int days = 825;
};

/// Each returns the exit code. They throw InputError (a rig that cannot be read; no such interface; a topic that nobody
/// writes, naming the nearest one), RuntimeFailure (the link cannot be opened).
int link_status(const LinkStatusOptions& options);
int link_listen(const LinkListenOptions& options);
int link_rate(const LinkRateOptions& options);
int link_keys(const LinkKeysOptions& options);

LinkConfig link_config_of(const LinkPlace& place);
/// "joint_states" and "/joint_states" as "rt/joint_states".
std::string topic_on_dds(const std::string& given);
/// What status prints of these programs, the own one left out.
std::string peers_text(const std::vector<link::Peer>& peers);
/// And of the line to the robot.
std::string figures_text(const link::LineFigures& line);

}  // namespace foresight
