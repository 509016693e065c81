// An MCAP that grows while messages come, whatever the disk does.
#pragma once

#include <condition_variable>
#include <deque>
#include <filesystem>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "common/clock.hpp"
#include "common/unique_fd.hpp"
#include "link/recording/mcap_writer.hpp"

namespace foresight::link {

struct RecordingFileOptions {
  std::size_t room = std::size_t{64} << 20;         ///< bytes of messages that wait for the disk, at most
  std::size_t chunk_bytes = std::size_t{4} << 20;   ///< a chunk is closed when it has so many,
  Duration chunk_length = std::chrono::seconds(1);  ///< or when its first message is so old
  double spare_bytes = 16e6;                        ///< of the disk that are left free
};

struct RecordingCounts {
  std::uint64_t written = 0, bytes = 0;  ///< messages, and what they hold
  std::uint64_t dropped = 0;             ///< messages that came while there was no room
};

/// put() never waits for the disk: a thread of its own writes. Chunks are closed once a second, so that whatever ends
/// the program costs a second at most. When the disk is full, or fails, what is there is finished and nothing more is
/// taken. start() gives it the thread; step() does the same in the caller's.
class RecordingFile {
 public:
  /// Throws RuntimeFailure where `path` cannot be written, or the disk is full already.
  RecordingFile(const std::filesystem::path& path, const Clock& clock, const RecordingFileOptions& options = {});
  ~RecordingFile();

  /// Before start() only.
  McapWriter& head() { return *writer_; }
  void start();

  /// A topic, and its messages' type by its name on DDS; returns its number. Any thread, as put().
  std::size_t add_channel(const std::string& topic, const std::string& dds_type, const McapTexts& metadata);
  /// `log_ns` must not fall. False: dropped; then the channel's next message has a number that tells.
  bool put(std::size_t channel, std::int64_t log_ns, std::int64_t publish_ns, std::vector<std::uint8_t> data) noexcept;

  /// Writes what waits; a chunk that is due goes to the disk.
  void step() noexcept;
  /// Writes all that waits, and the end; `remarks` become metadata. Once.
  void finish(const McapTexts& remarks) noexcept;

  RecordingCounts counts() const;
  /// Why nothing is taken any more, and what to do; "" while all is well.
  std::string trouble() const;

 private:
  struct Item {
    std::size_t channel = 0;
    std::uint32_t sequence = 0;
    std::int64_t log_ns = 0, publish_ns = 0;
    std::vector<std::uint8_t> data;
  };
  struct NewChannel {
    std::string topic, type;
    McapTexts metadata;
  };
  void run(const std::stop_token& stop) noexcept;
  void write_all(std::deque<Item>& items);
  void make_channels();
  void guarded(const std::function<void()>& work) noexcept;
  void give_up(const std::string& why) noexcept;
  void require_space() const;

  const std::filesystem::path path_;
  const Clock& clock_;
  const RecordingFileOptions options_;
  UniqueFd file_;
  std::unique_ptr<McapWriter> writer_;  // of the writing thread, from start() on
  std::map<std::string, std::uint16_t> schemas_;
  std::vector<std::uint16_t> channels_;  // in the file
  RobotTime opened_;                     // the chunk
  bool has_failed_ = false;              // of the writing thread

  mutable std::mutex mutex_;  // all below
  std::condition_variable_any came_;
  std::deque<Item> waiting_;
  std::vector<NewChannel> new_channels_;
  std::vector<std::uint32_t> sequences_;
  std::size_t waiting_bytes_ = 0;
  RecordingCounts counts_;
  std::string trouble_;
  std::jthread thread_;
};

}  // namespace foresight::link
