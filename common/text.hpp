// Small helpers for text that comes from outside: exact numbers, and words for error messages.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "common/time.hpp"

namespace foresight {

/// The whole of `text` as a decimal number ("1", "-.5", "+2e-3", "nan"), independent of the
/// locale; nothing where it is anything else or too large for a double.
std::optional<double> parse_number(std::string_view text);

/// The whole of `text` as a decimal integer; nothing where it is anything else or too large.
std::optional<long long> parse_integer(std::string_view text);

/// Seconds as text ("1305031102.175304", "1.3e9") to nanoseconds without passing through a
/// double, which has only about 240 ns left at today's unix times. Rounds half away from zero at
/// the tenth decimal. Nothing where `text` is no number or exceeds kLargestSeconds.
std::optional<Duration> parse_seconds(std::string_view text);
inline constexpr long long kLargestSeconds = 4'000'000'000;  ///< unix time of the year 2096

/// `text` in single quotes for a message: cut to 60 bytes, control characters as '?'.
std::string in_quotes(std::string_view text);

/// The candidate with the smallest edit distance to `word`, or that contains it (the first of
/// equals); empty only where there is no candidate.
std::string nearest_word(std::string_view word, std::span<const std::string> candidates);

/// "did you mean 'elbow'?" where nearest_word() holds `word`, or has at least half of its letters; else empty.
std::string question_of_near(std::string_view word, std::span<const std::string> candidates);

/// The cure for a word that is none of the candidates: question_of_near(); which there are, where none is near;
/// `otherwise` where there are none.
std::string did_you_mean(std::string_view word, std::span<const std::string> candidates,
                         const std::string& otherwise = "correct it");

/// "left, right".
std::string joined(std::span<const std::string> words);

/// With a to z in place of A to Z.
std::string lower(std::string_view text);

/// Without the blanks at its ends.
std::string_view trimmed(std::string_view text, std::string_view blanks = " \t\r");

/// "18.4 dB", "-" where nothing was measured: `digits` after the point.
std::string readable(double value, int digits, const std::string& unit = "");
std::string readable(const std::optional<double>& value, int digits, const std::string& unit = "");

}  // namespace foresight
