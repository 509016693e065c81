// Whether a calibration may be used, in the one form that all solvers give it.
#pragma once

#include <string>
#include <vector>

namespace foresight {

/// What speaks against a result, and what its user does about it. Both are halves of a sentence without a full stop.
struct Objection {
  std::string what;
  std::string cure;

  std::string text() const { return what + "; " + cure; }
};

/// Usable as long as nothing speaks against it.
struct Verdict {
  std::vector<Objection> against;

  bool usable() const { return against.empty(); }
  void object(std::string what, std::string cure);
  void add(const Verdict& other);

  /// "usable", or a line "NOT USABLE: what; cure" for each objection. No line break at the end.
  std::string text() const;
};

}  // namespace foresight
