// How far a long command is: one line that is redrawn on a terminal, else a line now and then.
#pragma once

#include <chrono>
#include <cstddef>
#include <string>

namespace foresight {

/// Pure logic: takes the time, returns what to print to stderr. Not for use by several threads.
class ProgressBar {
 public:
  using Instant = std::chrono::steady_clock::time_point;

  struct Options {
    bool terminal = false;                        ///< redraw one line, else append lines
    int columns = 80;                             ///< width of the terminal
    std::chrono::milliseconds redraw_every{100};  ///< on a terminal
    std::chrono::milliseconds line_every{5000};   ///< elsewhere
  };

  /// Options for stderr as it is now.
  static Options for_stderr();

  /// `label`: what is done, such as "replay"; `unit`: what is counted, such as "images";
  /// `total`: 0 where unknown. The rate counts from `start`.
  ProgressBar(std::string label, std::string unit, std::size_t total, Instant start, const Options& options);

  /// Text to print after `done` of the total, empty where it is too soon to print again.
  std::string update(std::size_t done, Instant now);

  /// The last line, with the time that it took; always ends the line.
  std::string finish(std::size_t done, Instant now);

 private:
  std::string line(std::size_t done, Instant now) const;

  std::string label_, unit_;
  std::size_t total_;
  Instant start_, last_;
  bool printed_ = false;
  Options options_;
};

/// "8 s", "2 min 05 s", "1 h 02 min".
std::string readable_duration(std::chrono::duration<double> duration);

}  // namespace foresight
