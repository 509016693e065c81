#include "common/text.hpp"

#include <algorithm>
#include <charconv>
#include <numeric>
#include <utility>
#include <vector>

#include "common/edit_distance.hpp"

namespace foresight {
namespace {

constexpr bool is_digit(char c) {
  return c >= '0' && c <= '9';
}

template <typename Number>
std::optional<Number> parse_whole(std::string_view text) {
  // std::from_chars takes no plus sign.
  if (text.size() > 1 && text[0] == '+' && text[1] != '-' && text[1] != '+') text.remove_prefix(1);
  Number value{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (text.empty() || error != std::errc{} || end != text.data() + text.size()) return std::nullopt;
  return value;
}

struct Decimal {
  bool negative = false;
  std::string digits;      // without point and leading zeros
  long long exponent = 0;  // of ten, for the point in front of digits[0]
};

std::optional<Decimal> parse_decimal(std::string_view text) {
  Decimal out;
  if (!text.empty() && (text[0] == '-' || text[0] == '+')) {
    out.negative = text[0] == '-';
    text.remove_prefix(1);
  }
  bool point = false, any = false;
  std::size_t i = 0;
  for (; i < text.size() && (is_digit(text[i]) || (text[i] == '.' && !point)); ++i) {
    if (text[i] == '.') {
      point = true;
      continue;
    }
    any = true;
    if (text[i] != '0' || !out.digits.empty()) {
      out.digits += text[i];
      if (!point) ++out.exponent;
    } else if (point) {
      --out.exponent;
    }
  }
  if (!any) return std::nullopt;
  if (i < text.size()) {
    if (text[i] != 'e' && text[i] != 'E') return std::nullopt;
    const auto exponent = parse_integer(text.substr(i + 1));
    if (!exponent || std::abs(*exponent) > 1'000'000) return std::nullopt;
    out.exponent += *exponent;
  }
  return out;
}

}  // namespace

std::optional<double> parse_number(std::string_view text) {
  return parse_whole<double>(text);
}

std::optional<long long> parse_integer(std::string_view text) {
  return parse_whole<long long>(text);
}

std::optional<Duration> parse_seconds(std::string_view text) {
  const auto decimal = parse_decimal(text);
  if (!decimal) return std::nullopt;
  const long long wanted = decimal->exponent + 9;  // digits in front of the point of the ns value
  if (decimal->digits.empty() || wanted < 0) return Duration{0};
  if (wanted > 19) return std::nullopt;
  const auto digit = [&](long long i) {
    return i < static_cast<long long>(decimal->digits.size()) ? decimal->digits[static_cast<std::size_t>(i)] - '0' : 0;
  };
  std::uint64_t ns = 0;
  for (long long i = 0; i < wanted; ++i) ns = ns * 10 + static_cast<std::uint64_t>(digit(i));
  if (digit(wanted) >= 5) ++ns;
  if (ns > static_cast<std::uint64_t>(kLargestSeconds) * 1'000'000'000u) return std::nullopt;
  const auto value = static_cast<std::int64_t>(ns);
  return Duration{decimal->negative ? -value : value};
}

std::string in_quotes(std::string_view text) {
  constexpr std::size_t kLongest = 60;
  std::string out = "'";
  for (char c : text.substr(0, kLongest)) out += (c >= 0 && c < 32) || c == 127 ? '?' : c;
  return out + (text.size() > kLongest ? "...'" : "'");
}

std::size_t edit_distance(std::string_view word, std::string_view other) {
  const std::string_view a = word.substr(0, 64);  // no key is longer; bounds the work on garbage
  std::vector<std::size_t> row(other.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 0; i < a.size(); ++i) {
    std::size_t diagonal = std::exchange(row[0], i + 1);
    for (std::size_t j = 0; j < other.size(); ++j) {
      const std::size_t replaced = diagonal + (a[i] == other[j] ? 0 : 1);
      diagonal = row[j + 1];
      row[j + 1] = std::min({replaced, diagonal + 1, row[j] + 1});
    }
  }
  return row.back();
}

std::string nearest_word(std::string_view word, std::span<const std::string> candidates) {
  std::string best;
  std::size_t best_distance = SIZE_MAX;
  for (const std::string& b : candidates) {
    std::size_t distance = edit_distance(word, b);
    // A word that was cut ("height" for "image_height") is nearer than its missing letters say.
    if (word.size() >= 3 && b.find(word) != std::string::npos) distance = std::min(distance, std::size_t{1});
    if (distance < best_distance) {
      best_distance = distance;
      best = b;
    }
  }
  return best;
}

std::string question_of_near(std::string_view word, std::span<const std::string> candidates) {
  const std::string best = nearest_word(word, candidates);
  const bool holds_it = word.size() >= 3 && best.find(word) != std::string::npos;
  const bool near = 2 * edit_distance(lower(word), lower(best)) <= std::max(word.size(), best.size()) + 1;
  return !best.empty() && (holds_it || near) ? "did you mean " + in_quotes(best) + "?" : "";
}

std::string did_you_mean(std::string_view word, std::span<const std::string> candidates, const std::string& otherwise) {
  constexpr std::size_t kMost = 12;  // of many, some show at least what such a word looks like
  if (candidates.empty()) return otherwise;
  if (std::string question = question_of_near(word, candidates); !question.empty()) return question;
  if (candidates.size() <= kMost) return "known are " + joined(candidates);
  return "known are " + joined(candidates.first(kMost)) + " and " + std::to_string(candidates.size() - kMost) + " more";
}

std::string joined(std::span<const std::string> words) {
  std::string out;
  for (const std::string& word : words) out += (out.empty() ? "" : ", ") + word;
  return out;
}

std::string lower(std::string_view text) {
  std::string out(text);
  for (char& c : out)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  return out;
}

std::string_view trimmed(std::string_view text, std::string_view blanks) {
  text.remove_prefix(std::min(text.find_first_not_of(blanks), text.size()));
  text.remove_suffix(text.size() - std::min(text.find_last_not_of(blanks) + 1, text.size()));
  return text;
}

std::string readable(double value, int digits, const std::string& unit) {
  if (!std::isfinite(value)) return "-";
  char text[64];  // not printf: its decimal point depends on the locale
  auto end = std::to_chars(text, text + sizeof text, value, std::chars_format::fixed, digits);
  if (end.ec != std::errc()) end = std::to_chars(text, text + sizeof text, value);  // 1e+300
  return std::string(text, end.ptr) + unit;
}

std::string readable(const std::optional<double>& value, int digits, const std::string& unit) {
  return readable(value.value_or(NAN), digits, unit);
}

}  // namespace foresight
