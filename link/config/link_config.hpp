// The `link:` section of a rig file: the network between robot side and operator side.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "common/time.hpp"

namespace foresight {

class YamlMap;

/// How pairs are coded for the operator.
enum class LinkCoding : std::uint8_t {
  jpeg,  ///< each image by itself: for every reader, and exact whatever got lost before; a LAN has room for it
  h264,  ///< predicted from what the one reader has: for lines of a few Mbit/s
};

/// Defaults: both sides on one machine.
struct LinkConfig {
  int domain = 0;                  ///< 0 .. 230; only who has the same one is seen
  std::string interface = "lo";    ///< of the network, as `ip link` shows it
  std::vector<std::string> peers;  ///< addresses or names of other hosts; none: found by multicast, on a LAN
  double joint_rate_hz = 50;       ///< joint states and transforms, at most; > 0
  double state_rate_hz = 10;       ///< robot's state; changes go at once; >= 1
  double image_rate_hz = 30;       ///< pairs, at most; > 0
  LinkCoding coding = LinkCoding::jpeg;
  int jpeg_quality = 85;   ///< 1 .. 100
  Duration round_trip{0};  ///< of a line that is slower than any line may be unasked (SetPointLife); 0: none
  /// Folder of `foresight link keys`: everything is encrypted, and nobody without a certificate is let in.
  std::optional<std::filesystem::path> security;
  std::string where = "link";  ///< "file:line: link", for messages

  bool loopback() const { return interface == "lo"; }
  /// "domain 0, interface lo"
  std::string place() const { return "domain " + std::to_string(domain) + ", interface " + interface; }
};

/// Reads `map`, the section. Throws InputError naming file, line and field: unknown keys, numbers out of range, a name
/// that cannot be one of an interface, a peer that is neither an address nor a host's name. Whether interface, peers
/// and keys exist is known where the link is opened: a rig file is read on other machines, too, and out of recordings,
/// which have no keys in them.
LinkConfig read_link_config(const YamlMap& map);

}  // namespace foresight
