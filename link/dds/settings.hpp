// What Cyclone is told of a link, and what is checked before. Private to link/dds.
#pragma once

#include <string>

#include "link/config/link_config.hpp"

namespace foresight::link {

/// Cyclone's configuration, XML, of a checked `config`. `receive_buffer`: bytes that the kernel grants.
std::string cyclone_settings(const LinkConfig& config, int receive_buffer);

/// Throws InputError: no such interface, or one that is down or has no address; a peer whose name nobody knows.
void check_network(const LinkConfig& config);

inline constexpr int kWantedReceiveBuffer = 4'000'000;  ///< bytes: two coded pairs at the worst
/// Of a socket that asks for kWantedReceiveBuffer: what it gets.
int granted_receive_buffer();

}  // namespace foresight::link
