// Cyclone's idea of a type, for messages that stay the bytes that they are (link/messages/cdr.hpp). Private to
// link/dds.
//
// Cyclone would make C structs of samples by tables that its IDL compiler writes. Ours come as bytes and go as bytes:
// so one decoder, ours, sees what strangers send, and a recording or a simulated line holds the same bytes as the wire.
// ROS 2's own layer on Cyclone does the same.
#pragma once

#include <dds/dds.h>
#include <dds/ddsi/ddsi_serdata.h>
#include <dds/ddsi/ddsi_sertype.h>

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace foresight::link {

/// Whoever makes a topic of it (dds_create_topic_sertype) hands it over with that.
ddsi_sertype* new_raw_type(const std::string& type_name);

/// A sample of `type` with one reference, which dds_writecdr() takes. `cdr`: with its header.
ddsi_serdata* new_raw_sample(const ddsi_sertype* type, std::vector<std::uint8_t> cdr);

/// The bytes of a sample of such a type, as long as it is referenced.
std::span<const std::uint8_t> raw_bytes(const ddsi_serdata* sample);

}  // namespace foresight::link
