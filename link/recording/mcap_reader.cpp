#include "link/recording/mcap_reader.hpp"

#include <fmt/core.h>
#include <zlib.h>
#include <zstd.h>

#include <algorithm>
#include <cstring>
#include <optional>

#include "common/error.hpp"
#include "common/text.hpp"
#include "link/recording/mcap_format.hpp"

namespace foresight::link {
namespace {

using namespace mcap;
using Bytes = std::vector<std::uint8_t>;

constexpr std::uint64_t kMostRecord = std::uint64_t{64} << 20;
constexpr std::uint64_t kMostAttachment = std::uint64_t{1} << 30;

/// What is wrong, in words. Private to this file: read_mcap() turns it into an outcome.
struct Damage {
  std::string words;
};

/// Fields of a record, never beyond its end.
class Fields {
 public:
  explicit Fields(std::span<const std::uint8_t> bytes) : bytes_(bytes) {}

  template <typename T>
  T number() {
    T out{};
    const auto from = take(sizeof(T));
    std::memcpy(&out, from.data(), sizeof(T));
    return out;
  }
  std::string text() {
    const auto from = take(number<std::uint32_t>());
    return {from.begin(), from.end()};
  }
  std::map<std::string, std::string> texts() {
    Fields all(take(number<std::uint32_t>()));
    std::map<std::string, std::string> out;
    while (!all.rest().empty()) {
      std::string key = all.text();
      out[std::move(key)] = all.text();
    }
    return out;
  }
  std::span<const std::uint8_t> take(std::uint64_t size) {
    if (size > bytes_.size()) throw Damage{"has fields that are longer than it is"};
    const auto out = bytes_.first(static_cast<std::size_t>(size));
    bytes_ = bytes_.subspan(out.size());
    return out;
  }
  std::span<const std::uint8_t> rest() const { return bytes_; }

 private:
  std::span<const std::uint8_t> bytes_;
};

std::uint32_t crc_of(std::span<const std::uint8_t> bytes) {
  return static_cast<std::uint32_t>(::crc32_z(0, bytes.data(), bytes.size()));
}

class Walk {
 public:
  Walk(std::istream& file, const McapVisitor& visitor, McapOutcome& out) : file_(file), visitor_(visitor), out_(out) {
    file_.seekg(0, std::ios::end);
    size_ = static_cast<std::uint64_t>(std::max<std::streamoff>(file_.tellg(), 0));
    file_.seekg(0);
  }

  /// Throws InputError.
  void begin(const std::string& name) {
    const Bytes magic = next(kMagic.size());
    if (std::ranges::equal(magic, kMagic)) return;
    const bool other =
        std::ranges::equal(std::span(magic).first(std::min<std::size_t>(magic.size(), 5)), std::span(kMagic).first(5));
    throw InputError(name, other ? "is an MCAP of another version" : "is no MCAP",
                     "give a file that `foresight record --line` wrote");
  }

  /// False: that was the last record, or the visitor has enough.
  bool step() {
    where_ = at_;
    if (size_ - at_ < kRecordHead) throw Damage{"the file ends"};
    const Bytes head = next(kRecordHead);
    Fields fields(head);
    const auto opcode = fields.number<std::uint8_t>();
    const auto length = fields.number<std::uint64_t>();
    if (length > size_ - at_) throw Damage{fmt::format("the file ends within a record of {} bytes", length)};
    if (skips(opcode) || (opcode == kChunk && visitor_.wants_chunk && !wants_chunk(length))) {
      go_to(at_ + length);
      return true;
    }
    if (length > (opcode == kAttachment ? kMostAttachment : kMostRecord))
      throw Damage{fmt::format("has a record of {} bytes", length)};
    const Bytes content = next(static_cast<std::size_t>(length));
    if (opcode == kFooter) return end();
    if (opcode == kMessage) throw Damage{"has a message outside of its chunks, without a checksum"};
    return of_data(opcode, content);
  }
  std::uint64_t where() const { return where_; }

 private:
  bool skips(std::uint8_t opcode) const {
    if (opcode == kAttachment) return !visitor_.attachment;
    if (opcode == kMetadata) return !visitor_.metadata;
    return opcode != kSchema && opcode != kChannel && opcode != kMessage && opcode != kChunk && opcode != kFooter;
  }

  void go_to(std::uint64_t at) {
    at_ = at;
    file_.seekg(static_cast<std::streamoff>(at_));
  }

  /// Looks at the times that the chunk begins with, and at the indices behind it, which name its channels.
  bool wants_chunk(std::uint64_t length) {
    const std::uint64_t begin = at_;
    constexpr std::size_t kTimes = 2 * sizeof(std::int64_t);
    if (length < kTimes) throw Damage{"has a chunk without its fields"};
    const Bytes times = next(kTimes);
    Fields fields(times);
    fields.number<std::int64_t>();
    const auto end_ns = fields.number<std::int64_t>();
    std::vector<const McapChannel*> channels;
    go_to(begin + length);
    while (size_ - at_ >= kRecordHead + sizeof(std::uint16_t)) {
      const Bytes head = next(kRecordHead + sizeof(std::uint16_t));
      Fields index(head);
      if (index.number<std::uint8_t>() != kMessageIndex) break;
      const auto rest = index.number<std::uint64_t>();
      const auto channel = channels_.find(index.number<std::uint16_t>());
      if (channel != channels_.end()) channels.push_back(&channel->second);
      if (rest < sizeof(std::uint16_t) || rest - sizeof(std::uint16_t) > size_ - at_) break;
      go_to(at_ + rest - sizeof(std::uint16_t));
    }
    const bool has_indices = !channels.empty();
    go_to(begin);
    return !has_indices || visitor_.wants_chunk(end_ns, channels);
  }

  Bytes next(std::size_t size) {
    size = static_cast<std::size_t>(std::min<std::uint64_t>(size, size_ - at_));
    Bytes out(size);
    file_.read(reinterpret_cast<char*>(out.data()), static_cast<std::streamsize>(size));
    if (file_.gcount() != static_cast<std::streamsize>(size)) throw Damage{"cannot be read any further"};
    at_ += size;
    return out;
  }

  bool end() {
    const Bytes magic = next(kMagic.size());
    if (!std::ranges::equal(magic, kMagic)) throw Damage{"the file ends"};
    out_.whole = true;
    return false;
  }

  bool of_data(std::uint8_t opcode, std::span<const std::uint8_t> content) {
    Fields fields(content);
    if (opcode == kChunk) return of_chunk(fields);
    if (opcode == kMessage) return of_message(fields);
    if (opcode == kSchema) {
      const auto id = fields.number<std::uint16_t>();
      auto schema = std::make_shared<McapSchema>();
      schema->name = fields.text();
      schema->encoding = fields.text();
      schema->definition = fields.text();
      schemas_[id] = std::move(schema);
    } else if (opcode == kChannel) {
      of_channel(fields);
    } else if (opcode == kAttachment) {
      of_attachment(fields, content);
    } else if (opcode == kMetadata) {
      std::string name = fields.text();
      visitor_.metadata(name, fields.texts());
    }
    return true;
  }

  void of_channel(Fields& fields) {
    McapChannel channel;
    channel.id = fields.number<std::uint16_t>();
    const auto schema = fields.number<std::uint16_t>();
    channel.topic = fields.text();
    channel.message_encoding = fields.text();
    channel.metadata = fields.texts();
    if (const auto found = schemas_.find(schema); found != schemas_.end())
      channel.schema = found->second;
    else if (schema == 0)
      channel.schema = std::make_shared<const McapSchema>();
    else
      throw Damage{fmt::format("has a channel, {}, without its schema", channel.id)};
    // The summary repeats what the chunks have; whoever holds on to a channel keeps the one that it saw.
    const auto id = channel.id;
    channels_.try_emplace(id, std::move(channel));
  }

  bool of_message(Fields& fields) {
    const auto id = fields.number<std::uint16_t>();
    const auto channel = channels_.find(id);
    if (channel == channels_.end()) throw Damage{fmt::format("has a message of channel {}, which is not there", id)};
    const auto sequence = fields.number<std::uint32_t>();
    const auto log_ns = fields.number<std::int64_t>(), publish_ns = fields.number<std::int64_t>();
    ++out_.messages;
    if (!visitor_.message || visitor_.message({channel->second, sequence, log_ns, publish_ns, fields.rest()}))
      return true;
    out_.whole = true;
    return false;
  }

  void of_attachment(Fields& fields, std::span<const std::uint8_t> content) {
    fields.take(2 * sizeof(std::int64_t));
    const std::string name = fields.text(), media_type = fields.text();
    const auto data = fields.take(fields.number<std::uint64_t>());
    const auto crc = fields.number<std::uint32_t>();
    if (crc != 0 && crc != crc_of(content.first(content.size() - sizeof(crc))))
      throw Damage{"has an attachment that is damaged: its checksum is another one"};
    visitor_.attachment(name, media_type, {data.begin(), data.end()});
  }

  bool of_chunk(Fields& fields) {
    fields.take(2 * sizeof(std::int64_t));
    const auto size = fields.number<std::uint64_t>();
    const auto crc = fields.number<std::uint32_t>();
    const std::string compression = fields.text();
    const auto stored = fields.take(fields.number<std::uint64_t>());
    if (size > kMostRecord) throw Damage{fmt::format("has a chunk of {} bytes", size)};
    Bytes unpacked;
    if (compression == "zstd") {
      unpacked.resize(static_cast<std::size_t>(size));
      const std::size_t came = ZSTD_decompress(unpacked.data(), unpacked.size(), stored.data(), stored.size());
      if (ZSTD_isError(came) || came != size) throw Damage{"has a chunk that does not unpack"};
    } else if (!compression.empty()) {
      throw Damage{"has a chunk with the compression " + in_quotes(compression) + ", which is not known here"};
    }
    const std::span<const std::uint8_t> content =
        compression.empty() ? stored : std::span<const std::uint8_t>(unpacked);
    if (content.size() != size) throw Damage{"has a chunk of another size than it says"};
    if (crc != 0 && crc != crc_of(content)) throw Damage{"has a chunk that is damaged: its checksum is another one"};
    return in_chunk(content);
  }

  bool in_chunk(std::span<const std::uint8_t> content) {
    for (Fields fields(content); !fields.rest().empty();) {
      const auto opcode = fields.number<std::uint8_t>();
      const auto record = fields.take(fields.number<std::uint64_t>());
      const bool may = opcode == kSchema || opcode == kChannel || opcode == kMessage;
      if (may && !of_data(opcode, record)) return false;
    }
    return true;
  }

  std::istream& file_;
  const McapVisitor& visitor_;
  McapOutcome& out_;
  std::uint64_t size_ = 0, at_ = 0, where_ = 0;
  std::map<std::uint16_t, std::shared_ptr<const McapSchema>> schemas_;
  std::map<std::uint16_t, McapChannel> channels_;
};

}  // namespace

McapOutcome read_mcap(std::istream& file, const std::string& name, const McapVisitor& visitor) {
  McapOutcome out;
  Walk walk(file, visitor, out);
  walk.begin(name);
  try {
    while (walk.step()) {
    }
  } catch (const Damage& damage) {
    out.trouble = fmt::format("{}, at byte {}", damage.words, walk.where());
  }
  return out;
}

}  // namespace foresight::link
