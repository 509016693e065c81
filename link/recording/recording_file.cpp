#include "link/recording/recording_file.hpp"

#include <fcntl.h>
#include <fmt/core.h>

#include <cerrno>
#include <cstring>

#include "common/atomic_file.hpp"
#include "common/error.hpp"
#include "link/recording/message_definitions.hpp"

namespace foresight::link {
namespace {

using namespace std::chrono_literals;
namespace fs = std::filesystem;

constexpr auto kFlushLook = 200ms;

RuntimeFailure cannot_write(const fs::path& path, int error) {
  return {"cannot write " + path.string() + " (" + std::strerror(error) + ")", cure_of_write_error(error)};
}

UniqueFd opened(const fs::path& path) {
  UniqueFd out(::open(path.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666));
  if (!out) throw cannot_write(path, errno);
  return out;
}

}  // namespace

RecordingFile::RecordingFile(const fs::path& path, const Clock& clock, const RecordingFileOptions& options)
    : path_(path), clock_(clock), options_(options), file_(opened(path)) {
  require_space();
  const auto sink = [this](std::span<const std::uint8_t> bytes) {
    while (!bytes.empty()) {
      const ssize_t written = ::write(file_.get(), bytes.data(), bytes.size());
      if (written < 0 && errno == EINTR) continue;
      if (written <= 0) throw cannot_write(path_, written < 0 ? errno : ENOSPC);
      bytes = bytes.subspan(static_cast<std::size_t>(written));
    }
  };
  writer_ = std::make_unique<McapWriter>(sink, "ros2", "foresight");
}

RecordingFile::~RecordingFile() {
  thread_.request_stop();
}

void RecordingFile::start() {
  thread_ = std::jthread([this](const std::stop_token& stop) { run(stop); });
}

std::size_t RecordingFile::add_channel(const std::string& topic, const std::string& dds_type,
                                       const McapTexts& metadata) {
  const std::lock_guard lock(mutex_);
  new_channels_.push_back({topic, dds_type, metadata});
  sequences_.push_back(0);
  return sequences_.size() - 1;
}

bool RecordingFile::put(std::size_t channel, std::int64_t log_ns, std::int64_t publish_ns,
                        std::vector<std::uint8_t> data) noexcept {
  {
    const std::lock_guard lock(mutex_);
    const std::uint32_t sequence = ++sequences_[channel];
    const std::size_t size = data.size() + sizeof(Item);
    if (!trouble_.empty() || waiting_bytes_ + size > options_.room) {
      ++counts_.dropped;
      return false;
    }
    waiting_bytes_ += size;
    waiting_.push_back({channel, sequence, log_ns, publish_ns, std::move(data)});
  }
  came_.notify_one();
  return true;
}

void RecordingFile::run(const std::stop_token& stop) noexcept {
  while (!stop.stop_requested()) {
    {
      std::unique_lock lock(mutex_);
      came_.wait_for(lock, stop, kFlushLook, [this] { return !waiting_.empty(); });
    }
    step();
  }
}

void RecordingFile::step() noexcept {
  std::deque<Item> items;
  {
    const std::lock_guard lock(mutex_);
    items.swap(waiting_);
  }
  guarded([&] { write_all(items); });
  std::size_t bytes = 0, size = 0;
  for (const Item& item : items) size += item.data.size();
  bytes = size + items.size() * sizeof(Item);
  const std::lock_guard lock(mutex_);  // only now there is room again: the bytes were in memory until here
  waiting_bytes_ -= bytes;
  if (has_failed_) {
    counts_.dropped += items.size();
  } else {
    counts_.written += items.size();
    counts_.bytes += size;
  }
}

void RecordingFile::make_channels() {
  std::vector<NewChannel> wanted;
  {
    const std::lock_guard lock(mutex_);
    wanted.swap(new_channels_);
  }
  for (const NewChannel& channel : wanted) {
    auto [schema, is_new] = schemas_.try_emplace(channel.type, std::uint16_t{0});
    if (is_new) {
      const MessageDefinition definition = message_definition(channel.type);
      schema->second = writer_->add_schema(definition.name, definition.encoding, definition.text);
    }
    channels_.push_back(writer_->add_channel(schema->second, channel.topic, channel.metadata));
  }
}

void RecordingFile::write_all(std::deque<Item>& items) {
  make_channels();
  for (const Item& item : items) {
    if (!writer_->has_messages()) opened_ = clock_.now();
    writer_->add_message(channels_[item.channel], item.sequence, item.log_ns, item.publish_ns, item.data);
    if (writer_->chunk_bytes() >= options_.chunk_bytes) {
      require_space();
      writer_->close_chunk();
    }
  }
  if (!writer_->has_messages() || clock_.now() - opened_ < options_.chunk_length) return;
  require_space();
  writer_->close_chunk();
}

void RecordingFile::require_space() const {
  std::error_code error;
  const fs::space_info space = fs::space(path_, error);
  if (!error && static_cast<double>(space.available) < options_.spare_bytes)
    throw RuntimeFailure(fmt::format("the disk of {} is full", path_.string()), "free some disk space");
}

void RecordingFile::guarded(const std::function<void()>& work) noexcept {
  if (has_failed_) return;
  try {
    work();
  } catch (const std::exception& error) {
    give_up(error.what());
  }
}

/// Nothing after the last whole chunk counts; the summary goes there where there is still room for it.
void RecordingFile::give_up(const std::string& why) noexcept {
  has_failed_ = true;
  const auto cut = [this] {
    const auto good = static_cast<off_t>(writer_->good_bytes());
    return ::ftruncate(file_.get(), good) == 0 && ::lseek(file_.get(), good, SEEK_SET) == good;
  };
  if (cut()) {
    try {
      writer_->go_on_behind_good();
      writer_->finish();
    } catch (const std::exception&) {  // it can be read without its summary
      cut();
    }
  }
  const std::lock_guard lock(mutex_);
  trouble_ = why;
}

void RecordingFile::finish(const McapTexts& remarks) noexcept {
  if (thread_.joinable()) {
    thread_.request_stop();
    thread_.join();
  }
  step();
  guarded([&] {
    writer_->close_chunk();
    writer_->add_metadata("foresight.end", remarks);
    writer_->finish();
  });
}

RecordingCounts RecordingFile::counts() const {
  const std::lock_guard lock(mutex_);
  return counts_;
}

std::string RecordingFile::trouble() const {
  const std::lock_guard lock(mutex_);
  return trouble_;
}

}  // namespace foresight::link
