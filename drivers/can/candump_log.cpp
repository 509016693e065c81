#include "drivers/can/candump_log.hpp"

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cstring>

#include "common/atomic_file.hpp"
#include "common/empty_file.hpp"
#include "common/error.hpp"
#include "common/read_file.hpp"
#include "common/text.hpp"
#include "drivers/can/kernel_frame.hpp"

namespace foresight {
namespace {

int hex_value(char c) {
  if (c >= '0' && c <= '9') return c - '0';
  const char upper = static_cast<char>(c & ~0x20);
  return upper >= 'A' && upper <= 'F' ? upper - 'A' + 10 : -1;
}

std::optional<std::uint32_t> parse_hex(std::string_view text) {
  std::uint32_t out = 0;
  for (const char c : text) {
    const int digit = hex_value(c);
    if (digit < 0) return std::nullopt;
    out = out << 4 | static_cast<std::uint32_t>(digit);
  }
  return out;
}

/// Sets the identifier and what the flags in it say; returns what is wrong.
const char* parse_id(std::string_view text, CanFrame& out) {
  if (text.size() != 3 && text.size() != 8) return "an identifier of neither 3 nor 8 hex digits";
  const auto id = parse_hex(text);
  if (!id) return "an identifier with something else than hex digits";
  out.id = *id;
  out.extended = text.size() == 8;
  if (!out.extended && out.id > CAN_SFF_MASK) return "an 11-bit identifier above 7FF";
  if (out.extended && (out.id & CAN_ERR_FLAG) != 0) {
    out.error = true;
    out.extended = false;
    out.id &= ~CAN_ERR_FLAG;
  }
  return out.id > CAN_EFF_MASK ? "a 29-bit identifier above 1FFFFFFF" : "";
}

const char* parse_data(std::string_view text, CanFrame& out) {
  const std::size_t room = out.fd ? CANFD_MAX_DLEN : CAN_MAX_DLEN;
  while (!text.empty() && !(text[0] == '_' && !out.fd)) {
    if (text[0] == '.' && out.size > 0) text.remove_prefix(1);
    if (text.size() < 2) return "data that is no pairs of hex digits";
    const int high = hex_value(text[0]), low = hex_value(text[1]);
    if (high < 0 || low < 0) return "data that is no pairs of hex digits";
    if (out.size == room) return out.fd ? "more than 64 bytes" : "more than 8 bytes";
    out.data[out.size++] = static_cast<std::uint8_t>(high << 4 | low);
    text.remove_prefix(2);
  }
  if (text.empty()) return "";
  const bool raw_length = text.size() == 2 && hex_value(text[1]) > 8 && out.size == 8;
  return raw_length ? "" : "a raw length code that is not 9 to F after 8 bytes";
}

const char* parse_remote(std::string_view text, CanFrame& out) {
  if (out.error) return "an error frame that is remote";
  out.remote = true;
  if (text.empty()) return "";
  if (text[0] < '0' || text[0] > '8') return "a remote frame's length that is not 0 to 8";
  out.size = static_cast<std::uint8_t>(text[0] - '0');
  if (text.size() == 1) return "";
  const bool raw_length = text.size() == 3 && text[1] == '_' && hex_value(text[2]) > 8 && out.size == 8;
  return raw_length ? "" : "something after a remote frame's length";
}

const char* parse_fd(std::string_view text, CanFrame& out) {
  if (out.error) return "an error frame of CAN FD";
  out.fd = true;
  const int flags = text.empty() ? -1 : hex_value(text[0]);
  if (flags < 0) return "no hex digit of flags after ##";
  out.bit_rate_switch = (flags & CANFD_BRS) != 0;
  const char* problem = parse_data(text.substr(1), out);
  if (*problem != '\0') return problem;
  return is_sendable(out) ? "" : "a length that CAN FD does not have";
}

const char* parse_into(std::string_view text, CanFrame& out) {
  const std::size_t hash = text.find('#');
  if (hash == std::string_view::npos) return "no # between identifier and data";
  const char* problem = parse_id(text.substr(0, hash), out);
  if (*problem != '\0') return problem;
  const std::string_view rest = text.substr(hash + 1);
  if (rest.starts_with('#')) return parse_fd(rest.substr(1), out);
  if (rest.starts_with('R') || rest.starts_with('r')) return parse_remote(rest.substr(1), out);
  return parse_data(rest, out);
}

/// Takes the next word off the front of `line`.
std::string_view next_word(std::string_view& line) {
  constexpr std::string_view kBlank = " \t\r";
  line.remove_prefix(std::min(line.find_first_not_of(kBlank), line.size()));
  const std::string_view word = line.substr(0, line.find_first_of(kBlank));
  line.remove_prefix(word.size());
  return word;
}

constexpr const char* kForm = "write it as (1700000000.123456) can0 123#DEADBEEF";

char* put_hex(char* at, std::uint32_t value, int digits) {
  for (int i = digits - 1; i >= 0; --i) *at++ = "0123456789ABCDEF"[value >> (4 * i) & 15];
  return at;
}

char* put_padded(char* at, std::int64_t value, int digits) {
  for (int i = digits - 1; i >= 0; --i, value /= 10) at[i] = static_cast<char>('0' + value % 10);
  return at + digits;
}

char* put_time(char* at, Duration time) {
  const std::int64_t us = std::max<std::int64_t>(time.count(), 0) / 1000;
  *at++ = '(';
  const std::int64_t whole = us / 1'000'000;
  at = whole < 10'000'000'000 ? put_padded(at, whole, 10) : std::to_chars(at, at + 20, whole).ptr;
  *at++ = '.';
  at = put_padded(at, us % 1'000'000, 6);
  *at++ = ')';
  return at;
}

}  // namespace

ParsedFrame parse_can_frame(std::string_view text) noexcept {
  CanFrame frame;
  const char* problem = parse_into(text, frame);
  if (*problem != '\0') return {std::nullopt, problem};
  return {frame, ""};
}

std::size_t write_can_frame(const CanFrame& frame, std::span<char> out) noexcept {
  char* at = out.data();
  if (frame.error)
    at = put_hex(at, frame.id | CAN_ERR_FLAG, 8);
  else
    at = put_hex(at, frame.id, frame.extended ? 8 : 3);
  *at++ = '#';
  if (frame.fd) {
    *at++ = '#';
    at = put_hex(at, frame.bit_rate_switch ? CANFD_BRS : 0, 1);
  }
  if (frame.remote) {
    *at++ = 'R';
    if (frame.size > 0) at = put_hex(at, frame.size, 1);
  }
  for (const std::uint8_t byte : frame.payload()) at = put_hex(at, byte, 2);
  return static_cast<std::size_t>(at - out.data());
}

std::string to_text(const CanFrame& frame) {
  std::array<char, kLongestFrameText> text;
  return {text.data(), write_can_frame(frame, text)};
}

std::optional<CanLogEntry> parse_log_line(std::string_view line, const std::string& where) {
  CanLogEntry out;
  std::string_view word = next_word(line);
  if (word.empty() || word.starts_with('#')) return std::nullopt;
  if (word.starts_with('(')) {
    // candump pads short times with blanks inside of the parentheses.
    if (word == "(")
      word = next_word(line);
    else
      word.remove_prefix(1);
    const bool closed = word.ends_with(')');
    if (closed) word.remove_suffix(1);
    out.time = parse_seconds(word);
    if (!closed || !out.time) throw InputError(where, "a time that is no number of seconds: " + in_quotes(word), kForm);
    word = next_word(line);
  }
  out.interface = word;
  const std::string_view frame = next_word(line);
  if (frame.empty()) throw InputError(where, "no frame after " + in_quotes(word), kForm);
  const ParsedFrame parsed = parse_can_frame(frame);
  if (!parsed.frame) throw InputError(where, std::string(parsed.problem) + ": " + in_quotes(frame), kForm);
  out.frame = *parsed.frame;
  const std::string_view direction = next_word(line);
  if (direction == "T")
    out.sent = true;
  else if (direction == "R")
    out.sent = false;
  else if (!direction.empty() && !direction.starts_with('#'))
    throw InputError(where, "something after the frame: " + in_quotes(direction), "give R, T or a comment (#) there");
  return out;
}

CandumpReader::CandumpReader(const std::filesystem::path& file) : file_(file), in_(open_input(file)) {}

std::optional<CanLogEntry> CandumpReader::next() {
  std::array<char, 4096> line;  // what is longer is no log
  while (in_.getline(line.data(), line.size())) {
    ++line_;
    const auto length = static_cast<std::size_t>(in_.gcount()) - (in_.eof() ? 0 : 1);  // without the line's end
    if (auto entry = parse_log_line({line.data(), length}, at_line(file_, line_))) return entry;
  }
  if (in_.gcount() + 1 == static_cast<std::streamsize>(line.size()))
    throw InputError(at_line(file_, line_ + 1), "is longer than a line of a log",
                     "give a log as `candump -l` writes it");
  if (in_.bad()) throw InputError(at_line(file_, line_), "reading failed", "check the disk");
  return std::nullopt;
}

std::size_t write_log_line(Duration time, std::string_view interface, const CanFrame& frame, std::optional<bool> sent,
                           std::span<char> out) noexcept {
  char* at = put_time(out.data(), time);
  *at++ = ' ';
  at = std::copy_n(interface.data(), std::min<std::size_t>(interface.size(), 15), at);
  *at++ = ' ';
  at += write_can_frame(frame, {at, kLongestFrameText});
  if (sent) {
    *at++ = ' ';
    *at++ = *sent ? 'T' : 'R';
  }
  *at++ = '\n';
  return static_cast<std::size_t>(at - out.data());
}

CandumpWriter::CandumpWriter(const std::filesystem::path& file) : file_(file), out_(file, std::ios::binary) {
  if (!out_)
    throw RuntimeFailure(file.string() + ": cannot be made: " + std::strerror(errno),
                         "give a file that can be written");
}

CandumpWriter::~CandumpWriter() {
  out_.close();
  remove_empty(file_);
}

void CandumpWriter::write(Duration time, std::string_view interface, const CanFrame& frame, std::optional<bool> sent) {
  std::array<char, kLongestLogLine> line;
  out_.write(line.data(), static_cast<std::streamsize>(write_log_line(time, interface, frame, sent, line)));
  require_good();
}

void CandumpWriter::flush() {
  out_.flush();
  require_good();
}

void CandumpWriter::require_good() const {
  if (!out_)
    throw RuntimeFailure(file_.string() + ": writing failed: " + std::strerror(errno), cure_of_write_error(errno));
}

}  // namespace foresight
