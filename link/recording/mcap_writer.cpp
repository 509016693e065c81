#include "link/recording/mcap_writer.hpp"

#include <zlib.h>
#include <zstd.h>

#include <algorithm>
#include <bit>
#include <utility>

#include "link/recording/mcap_format.hpp"

namespace foresight::link {
namespace {

using namespace mcap;
using Bytes = std::vector<std::uint8_t>;

static_assert(std::endian::native == std::endian::little);

template <typename T>
void add(Bytes& out, T number) {
  const auto* const begin = reinterpret_cast<const std::uint8_t*>(&number);
  out.insert(out.end(), begin, begin + sizeof(T));
}

void add(Bytes& out, const std::string& text) {
  add(out, static_cast<std::uint32_t>(text.size()));
  out.insert(out.end(), text.begin(), text.end());
}

void add(Bytes& out, std::span<const std::uint8_t> bytes) {
  out.insert(out.end(), bytes.begin(), bytes.end());
}

void add(Bytes& out, const McapTexts& texts) {
  Bytes all;
  for (const auto& [key, value] : texts) {
    add(all, key);
    add(all, value);
  }
  add(out, static_cast<std::uint32_t>(all.size()));
  add(out, std::span<const std::uint8_t>(all));
}

void add_numbers(Bytes& out, const std::map<std::uint16_t, std::uint64_t>& numbers) {
  add(out, static_cast<std::uint32_t>(numbers.size() * (sizeof(std::uint16_t) + sizeof(std::uint64_t))));
  for (const auto& [key, value] : numbers) {
    add(out, key);
    add(out, value);
  }
}

std::uint32_t crc_of(std::uint32_t before, std::span<const std::uint8_t> bytes) {
  return static_cast<std::uint32_t>(::crc32_z(before, bytes.data(), bytes.size()));
}

/// Empty where it would save less than an eighth.
Bytes compressed(const Bytes& bytes) {
  Bytes out(ZSTD_compressBound(bytes.size()));
  const std::size_t size = ZSTD_compress(out.data(), out.size(), bytes.data(), bytes.size(), /*level=*/1);
  if (ZSTD_isError(size) || size > bytes.size() / 8 * 7) return {};
  out.resize(size);
  return out;
}

}  // namespace

McapWriter::McapWriter(Sink sink, const std::string& profile, const std::string& library) : sink_(std::move(sink)) {
  Bytes header;
  add(header, profile);
  add(header, library);
  put_bytes(kMagic);
  put(kHeader, header);
  keep();
}

void McapWriter::put_bytes(std::span<const std::uint8_t> bytes) {
  sink_(bytes);
  at_ += bytes.size();
  crc_ = crc_of(crc_, bytes);
}

void McapWriter::put(std::uint8_t opcode, const Bytes& content) {
  Bytes head;
  add(head, opcode);
  add(head, static_cast<std::uint64_t>(content.size()));
  put_bytes(head);
  put_bytes(content);
}

std::uint16_t McapWriter::add_schema(const std::string& name, const std::string& encoding,
                                     const std::string& definition) {
  const auto id = static_cast<std::uint16_t>(schemas_.size() + 1);
  Bytes& record = schemas_.emplace_back();
  add(record, id);
  add(record, name);
  add(record, encoding);
  add(record, definition);
  put(kSchema, record);
  keep();
  return id;
}

std::uint16_t McapWriter::add_channel(std::uint16_t schema, const std::string& topic, const McapTexts& metadata) {
  Channel channel{static_cast<std::uint16_t>(channels_.size() + 1), {}};
  add(channel.record, channel.id);
  add(channel.record, schema);
  add(channel.record, topic);
  add(channel.record, std::string("cdr"));
  add(channel.record, metadata);
  put(kChannel, channel.record);
  keep();
  channels_.push_back(std::move(channel));
  index_.push_back({channels_.back().id, {}});
  return channels_.back().id;
}

void McapWriter::add_attachment(const std::string& name, const std::string& media_type, std::int64_t time_ns,
                                std::span<const std::uint8_t> data) {
  Bytes record;
  add(record, time_ns);
  add(record, time_ns);
  add(record, name);
  add(record, media_type);
  add(record, static_cast<std::uint64_t>(data.size()));
  add(record, data);
  add(record, crc_of(0, record));
  Bytes index;
  add(index, at_);
  add(index, static_cast<std::uint64_t>(kRecordHead + record.size()));
  add(index, time_ns);
  add(index, time_ns);
  add(index, static_cast<std::uint64_t>(data.size()));
  add(index, name);
  add(index, media_type);
  put(kAttachment, record);
  attachments_.push_back(std::move(index));
  keep();
}

void McapWriter::add_metadata(const std::string& name, const McapTexts& texts) {
  Bytes record;
  add(record, name);
  add(record, texts);
  Bytes index;
  add(index, at_);
  add(index, static_cast<std::uint64_t>(kRecordHead + record.size()));
  add(index, name);
  put(kMetadata, record);
  metadata_.push_back(std::move(index));
  keep();
}

void McapWriter::add_message(std::uint16_t channel, std::uint32_t sequence, std::int64_t log_ns,
                             std::int64_t publish_ns, std::span<const std::uint8_t> data) {
  if (!has_messages_) chunk_begin_ns_ = log_ns;
  chunk_end_ns_ = log_ns;
  has_messages_ = true;
  index_[channel - 1u].places.emplace_back(log_ns, chunk_.size());
  constexpr std::size_t kFields = 22;
  add(chunk_, std::uint8_t{kMessage});
  add(chunk_, static_cast<std::uint64_t>(kFields + data.size()));
  add(chunk_, channel);
  add(chunk_, sequence);
  add(chunk_, log_ns);
  add(chunk_, publish_ns);
  add(chunk_, data);
}

void McapWriter::close_chunk() {
  if (!std::exchange(has_messages_, false)) return;
  const Bytes content = std::exchange(chunk_, {});
  ChunkPlace place;
  place.begin_ns = chunk_begin_ns_;
  place.end_ns = chunk_end_ns_;
  place.at = at_;
  place.size = content.size();
  const Bytes packed = compressed(content);
  if (!packed.empty()) place.compression = "zstd";
  const Bytes& stored = packed.empty() ? content : packed;
  place.stored = stored.size();
  Bytes record;
  add(record, place.begin_ns);
  add(record, place.end_ns);
  add(record, place.size);
  add(record, crc_of(0, content));
  add(record, place.compression);
  add(record, place.stored);
  add(record, std::span<const std::uint8_t>(stored));
  const std::vector<Index> index = index_;
  for (Index& one : index_) one.places.clear();
  put(kChunk, record);
  place.length = at_ - place.at;
  put_indices(index, place);
  chunks_.push_back(std::move(place));
  keep();
  for (const Index& one : index) channels_[one.channel - 1u].messages += one.places.size();
}

void McapWriter::put_indices(const std::vector<Index>& index, ChunkPlace& place) {
  const std::uint64_t begin = at_;
  for (const Index& one : index) {
    if (one.places.empty()) continue;
    place.indices[one.channel] = at_;
    Bytes record;
    add(record, one.channel);
    add(record, static_cast<std::uint32_t>(one.places.size() * 2 * sizeof(std::uint64_t)));
    for (const auto& [time, at] : one.places) {
      add(record, time);
      add(record, at);
    }
    put(kMessageIndex, record);
  }
  place.index_length = at_ - begin;
}

Bytes McapWriter::statistics() const {
  std::map<std::uint16_t, std::uint64_t> counts;
  std::uint64_t messages = 0;
  for (const Channel& channel : channels_) {
    if (channel.messages > 0) counts[channel.id] = channel.messages;
    messages += channel.messages;
  }
  std::int64_t begin = 0, end = 0;
  for (const ChunkPlace& chunk : chunks_) {
    if (begin == 0 || chunk.begin_ns < begin) begin = chunk.begin_ns;
    end = std::max(end, chunk.end_ns);
  }
  Bytes out;
  add(out, messages);
  add(out, static_cast<std::uint16_t>(schemas_.size()));
  add(out, static_cast<std::uint32_t>(channels_.size()));
  add(out, static_cast<std::uint32_t>(attachments_.size()));
  add(out, static_cast<std::uint32_t>(metadata_.size()));
  add(out, static_cast<std::uint32_t>(chunks_.size()));
  add(out, begin);
  add(out, end);
  add_numbers(out, counts);
  return out;
}

void McapWriter::put_group(std::vector<Group>& groups, std::uint8_t opcode, const std::vector<Bytes>& contents) {
  if (contents.empty()) return;
  const std::uint64_t begin = at_;
  for (const Bytes& content : contents) put(opcode, content);
  groups.push_back({opcode, begin, at_ - begin});
}

std::vector<McapWriter::Group> McapWriter::put_summary() {
  std::vector<Group> groups;
  std::vector<Bytes> channels, chunks;
  for (const Channel& channel : channels_) channels.push_back(channel.record);
  for (const ChunkPlace& place : chunks_) {
    Bytes& out = chunks.emplace_back();
    add(out, place.begin_ns);
    add(out, place.end_ns);
    add(out, place.at);
    add(out, place.length);
    add_numbers(out, place.indices);
    add(out, place.index_length);
    add(out, place.compression);
    add(out, place.stored);
    add(out, place.size);
  }
  put_group(groups, kSchema, schemas_);
  put_group(groups, kChannel, channels);
  put_group(groups, kStatistics, {statistics()});
  put_group(groups, kChunkIndex, chunks);
  put_group(groups, kAttachmentIndex, attachments_);
  put_group(groups, kMetadataIndex, metadata_);
  return groups;
}

void McapWriter::finish() {
  close_chunk();
  Bytes end;
  add(end, std::uint32_t{0});  // of the data: chunks have their own
  put(kDataEnd, end);
  crc_ = 0;
  const std::uint64_t summary = at_;
  const std::vector<Group> groups = put_summary();
  const std::uint64_t offsets = at_;
  for (const Group& group : groups) {
    Bytes record;
    add(record, group.opcode);
    add(record, group.at);
    add(record, group.length);
    put(kSummaryOffset, record);
  }
  Bytes footer;  // its checksum counts all of the summary, and itself up to there
  constexpr std::uint64_t kFooterSize = 20;
  add(footer, std::uint8_t{kFooter});
  add(footer, kFooterSize);
  add(footer, summary);
  add(footer, offsets);
  add(footer, crc_of(crc_, footer));
  put_bytes(footer);
  put_bytes(kMagic);
  keep();
}

}  // namespace foresight::link
