// `foresight calibrate ...` in this process.
#pragma once

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "apps/calibrate/calibrate_command.hpp"
#include "common/error.hpp"
#include "tests/scene/test_run.hpp"

namespace foresight {

/// The exit code, or the message of the error that main() would print.
inline std::string run_calibrate(std::vector<std::string> arguments) {
  CLI::App app;
  std::function<int()> action;
  add_calibrate_command(app, action);
  arguments.insert(arguments.begin(), "calibrate");
  std::reverse(arguments.begin(), arguments.end());  // as CLI11 takes them
  testing::internal::CaptureStdout();
  testing::internal::CaptureStderr();
  std::string out;
  try {
    app.parse(arguments);
    out = std::to_string(action());
  } catch (const CLI::ParseError& error) {
    out = error.what();
  } catch (const std::exception& error) {
    out = error.what();
  }
  testing::internal::GetCapturedStdout();
  testing::internal::GetCapturedStderr();
  return out;
}

inline nlohmann::json json_of(const TempFolder& folder, const std::string& name) {
  return nlohmann::json::parse(folder.read(name));
}

}  // namespace foresight
