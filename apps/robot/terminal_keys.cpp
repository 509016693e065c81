#include "apps/robot/terminal_keys.hpp"

namespace foresight {
namespace {

constexpr char kEscape = '\x1b';

char arrow(char final) {
  switch (final) {
    case 'A':
    case 'C': return '+';
    case 'B':
    case 'D': return '-';
    default: return 0;
  }
}

}  // namespace

std::string TerminalKeys::of(std::string_view bytes) {
  if (bytes.empty() && within_ == Within::escape) within_ = Within::nothing;
  std::string out;
  for (const char byte : bytes)
    if (const char key = take(byte)) out += key;
  return out;
}

char TerminalKeys::take(char byte) {
  if (byte == kEscape || byte == ' ') {
    within_ = byte == ' ' ? Within::nothing : Within::escape;
    return byte == ' ' ? byte : char{0};
  }
  switch (within_) {
    case Within::nothing: return byte;
    case Within::escape:
      within_ = byte == '[' ? Within::control_sequence : byte == 'O' ? Within::single_shift : Within::nothing;
      has_parameters_ = false;
      return 0;
    case Within::single_shift: within_ = Within::nothing; return arrow(byte);
    case Within::control_sequence:
      if (byte < '@' || byte == '[') {  // Linux' own console sends F1 as ESC [ [ A
        has_parameters_ = true;
        return 0;
      }
      within_ = Within::nothing;
      return has_parameters_ ? char{0} : arrow(byte);
  }
  return 0;
}

}  // namespace foresight
