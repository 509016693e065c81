// Writes MCAP (https://mcap.dev/spec), the container in which ROS 2 keeps recordings.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <span>
#include <string>
#include <vector>

namespace foresight::link {

using McapTexts = std::map<std::string, std::string>;

/// Messages go into chunks, each with its index; finish() adds the summary by which readers find them. A file that ends
/// behind a whole chunk can be read too, from its beginning. One thread.
class McapWriter {
 public:
  /// Gets the file's bytes, in order. Throws where they cannot be written: then the file ends at good_bytes().
  using Sink = std::function<void(std::span<const std::uint8_t>)>;

  McapWriter(Sink sink, const std::string& profile, const std::string& library);

  // What follows is written at once, so that it is there whatever comes, and whoever passes over chunks knows it.

  /// `encoding`: of `definition`, such as "ros2msg"; "" where there is none. Returns its id.
  std::uint16_t add_schema(const std::string& name, const std::string& encoding, const std::string& definition);
  /// Of messages in CDR. Returns its id. At most 65,535 schemas and as many channels.
  std::uint16_t add_channel(std::uint16_t schema, const std::string& topic, const McapTexts& metadata);
  void add_attachment(const std::string& name, const std::string& media_type, std::int64_t time_ns,
                      std::span<const std::uint8_t> data);
  void add_metadata(const std::string& name, const McapTexts& texts);

  /// Into the chunk, in memory. `log_ns` must not fall.
  void add_message(std::uint16_t channel, std::uint32_t sequence, std::int64_t log_ns, std::int64_t publish_ns,
                   std::span<const std::uint8_t> data);
  std::size_t chunk_bytes() const { return chunk_.size(); }
  bool has_messages() const { return has_messages_; }  ///< in the chunk
  /// Writes the chunk if it has messages, compressed (zstd) where that saves an eighth. What is in it is lost where the
  /// sink throws.
  void close_chunk();
  /// The chunk, the summary, the end.
  void finish();

  /// How far the file is whole.
  std::uint64_t good_bytes() const { return good_; }
  /// After the sink threw, and the file was cut at good_bytes(): what comes now goes there.
  void go_on_behind_good() { at_ = good_; }

 private:
  using Bytes = std::vector<std::uint8_t>;
  struct Channel {
    std::uint16_t id = 0;
    Bytes record;
    std::uint64_t messages = 0;
  };
  struct ChunkPlace {
    std::int64_t begin_ns = 0, end_ns = 0;
    std::uint64_t at = 0, length = 0, index_length = 0, stored = 0, size = 0;
    std::map<std::uint16_t, std::uint64_t> indices;
    std::string compression;
  };
  struct Index {
    std::uint16_t channel = 0;
    std::vector<std::pair<std::int64_t, std::uint64_t>> places;  // log time, place in the chunk
  };
  struct Group {
    std::uint8_t opcode;
    std::uint64_t at, length;
  };
  void put(std::uint8_t opcode, const Bytes& content);
  void put_bytes(std::span<const std::uint8_t> bytes);
  void keep() { good_ = at_; }
  void put_indices(const std::vector<Index>& index, ChunkPlace& place);
  std::vector<Group> put_summary();
  void put_group(std::vector<Group>& groups, std::uint8_t opcode, const std::vector<Bytes>& contents);
  Bytes statistics() const;

  Sink sink_;
  std::uint64_t at_ = 0, good_ = 0;
  std::uint32_t crc_ = 0;                                // of what was put since it was set to 0
  std::vector<Bytes> schemas_, attachments_, metadata_;  // records; indices of the latter two
  std::vector<Channel> channels_;
  std::vector<ChunkPlace> chunks_;

  Bytes chunk_;
  std::vector<Index> index_;
  std::int64_t chunk_begin_ns_ = 0, chunk_end_ns_ = 0;
  bool has_messages_ = false;
};

}  // namespace foresight::link
