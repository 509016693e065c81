// Reads MCAP (https://mcap.dev/spec) from its beginning to its end, whole or cut off.
#pragma once

#include <cstdint>
#include <functional>
#include <istream>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace foresight::link {

struct McapSchema {
  std::string name, encoding, definition;
};
struct McapChannel {
  std::uint16_t id = 0;
  std::string topic, message_encoding;
  std::map<std::string, std::string> metadata;
  std::shared_ptr<const McapSchema> schema;  ///< not null; without name where the channel has none
};
/// A file may say anything: nobody needs a later time than this one, to which differences may still be added, ns.
constexpr std::int64_t kLatestLog = 4'000'000'000'000'000'000;

/// While it is visited.
struct McapMessage {
  const McapChannel& channel;
  std::uint32_t sequence = 0;
  std::int64_t log_ns = 0, publish_ns = 0;
  std::span<const std::uint8_t> data;
};

/// What a reader of a file wants to see; what is empty is passed over.
struct McapVisitor {
  std::function<bool(const McapMessage&)> message = {};  ///< false: enough
  /// A chunk that is to be read; others are passed over. With the channels that it has messages of.
  std::function<bool(std::int64_t end_ns, std::span<const McapChannel* const> channels)> wants_chunk = {};
  std::function<void(const std::string& name, const std::string& media_type, std::vector<std::uint8_t> data)>
      attachment = {};
  std::function<void(const std::string& name, const std::map<std::string, std::string>& texts)> metadata = {};
};

struct McapOutcome {
  bool whole = false;          ///< read to its regular end, or as far as the visitor wanted
  std::string trouble;         ///< else: what is wrong with it and where; what came before was visited
  std::uint64_t messages = 0;  ///< visited
};

/// Takes any bytes: never makes room for what is not there, and for no chunk of more than 64 MiB. In the order of the
/// file. Throws InputError at `name` where it is no MCAP at all, or another version's.
McapOutcome read_mcap(std::istream& file, const std::string& name, const McapVisitor& visitor);

}  // namespace foresight::link
