// The log form of can-utils: `candump -l` writes it, canplayer and many other programs read it.
//
//   (1700000000.123456) can0 123#DEADBEEF       11-bit identifier: 3 hex digits
//   (1700000000.123556) can0 1F334455#R8 T      29-bit: 8; remote frame for 8 bytes; sent by us (T), received (R)
//   (1700000000.123656) can0 123##1001122       FD: a hex digit of flags (1: bit rate switch), then the data
//   (1700000000.123756) can0 20000040#00...     error frame: 20000000 plus the classes of linux/can/error.h
#pragma once

#include <filesystem>
#include <fstream>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "drivers/can/can_frame.hpp"

namespace foresight {

/// A frame, or why the text is none: static text such as "data that is no pairs of hex digits".
struct ParsedFrame {
  std::optional<CanFrame> frame;
  const char* problem = "";
};
/// "123#DEADBEEF" and the other forms above. Takes what cansend takes: lower case, dots between bytes, `_` with a raw
/// length code (which is dropped), and no length for remote frames of none. Does not allocate.
ParsedFrame parse_can_frame(std::string_view text) noexcept;

/// Longest text of a frame: 29-bit identifier, "##", flags, 64 bytes.
inline constexpr std::size_t kLongestFrameText = 8 + 2 + 1 + 128;
/// Writes the form above and returns its length; `out` must hold kLongestFrameText. Does not allocate.
std::size_t write_can_frame(const CanFrame& frame, std::span<char> out) noexcept;
std::string to_text(const CanFrame& frame);

/// One line of a log.
struct CanLogEntry {
  std::optional<Duration> time;  ///< since the log's own epoch, mostly unix time; absent in logs without times
  std::string interface;
  CanFrame frame;            ///< its `time` is 0
  std::optional<bool> sent;  ///< by who wrote the log; absent where it does not say
};

/// Reads a log line by line. Takes files without times, with comments (`#`), empty lines and any line ends.
class CandumpReader {
 public:
  /// Throws InputError like open_input().
  explicit CandumpReader(const std::filesystem::path& file);
  /// The next frame; nothing at the end. Throws InputError naming file and line.
  std::optional<CanLogEntry> next();
  int line() const { return line_; }  ///< of the last frame, from 1

 private:
  std::filesystem::path file_;
  std::ifstream in_;
  int line_ = 0;
};

/// One line without its end; nothing for comments and empty ones. Throws InputError whose place is `where`.
std::optional<CanLogEntry> parse_log_line(std::string_view line, const std::string& where);

/// Longest line: a time, an interface (15 characters), a frame, a direction, the line's end.
inline constexpr std::size_t kLongestLogLine = 28 + 16 + kLongestFrameText + 3;
/// Writes a line with its end and returns its length; an interface longer than 15 characters is cut. A negative time is
/// written as 0. Does not allocate.
std::size_t write_log_line(Duration time, std::string_view interface, const CanFrame& frame, std::optional<bool> sent,
                           std::span<char> out) noexcept;

/// Writes a log. One thread.
class CandumpWriter {
 public:
  /// Throws RuntimeFailure where the file cannot be made.
  explicit CandumpWriter(const std::filesystem::path& file);
  /// A file that nothing came to, or that nothing could be written to, goes.
  ~CandumpWriter();
  CandumpWriter(const CandumpWriter&) = delete;
  CandumpWriter& operator=(const CandumpWriter&) = delete;

  /// Throws RuntimeFailure where the disk is full or the like.
  void write(Duration time, std::string_view interface, const CanFrame& frame, std::optional<bool> sent = {});
  void flush();  ///< throws as write() does

 private:
  void require_good() const;

  std::filesystem::path file_;
  std::ofstream out_;
};

}  // namespace foresight
