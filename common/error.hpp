// Errors of set-up and input. Loops never throw these: they return a status.
#pragma once

#include <filesystem>
#include <stdexcept>
#include <string>

namespace foresight {

/// Something from outside (a file, an option, a device) is wrong. The text says what is
/// wrong, where, and what to do about it; the program ends with exit code 2.
class InputError : public std::runtime_error {
 public:
  /// `where`: a file, "file:line", a field or an option. `cure`: an imperative clause.
  InputError(const std::string& where, const std::string& what, const std::string& cure);
};

/// The machine cannot do what is asked (no OpenGL 4.5, disk full, out of texture memory,
/// context lost). The program ends with exit code 1.
class RuntimeFailure : public std::runtime_error {
 public:
  RuntimeFailure(const std::string& what, const std::string& cure);
};

/// Throws InputError unless `ok`.
void require(bool ok, const std::string& where, const std::string& what, const std::string& cure);

/// "file:line", the form that editors and terminals can jump to.
std::string at_line(const std::filesystem::path& file, int line);

}  // namespace foresight
