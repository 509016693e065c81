// `foresight calibrate ...` in this process.
#pragma once

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "apps/calibrate/calibrate_command.hpp"
#include "apps/command_line/output_guard.hpp"
#include "common/error.hpp"
#include "tests/scene/test_run.hpp"

namespace foresight {

/// The exit code, or the message of the error that main() would print.
inline std::string run_calibrate(std::vector<std::string> arguments) {
  std::function<int()> action;
  arguments.insert(arguments.begin(), {"foresight", "calibrate"});
  std::vector<char*> words;
  for (std::string& argument : arguments) words.push_back(argument.data());
  testing::internal::CaptureStdout();
  testing::internal::CaptureStderr();
  std::string out;
  try {
    const CommandLine line = read_command_line(static_cast<int>(words.size()), words.data(), "", "",
                                               [&action](Command& app) { add_calibrate_command(app, action); });
    if (!line.ended) {
      const OutputGuard guard(line.paths);
      out = std::to_string(action());
    }
  } catch (const std::exception& error) {
    out = error.what();
  }
  testing::internal::GetCapturedStdout();
  const std::string told = testing::internal::GetCapturedStderr();
  if (out.empty()) out = told;
  return out;
}

inline nlohmann::json json_of(const TempFolder& folder, const std::string& name) {
  return nlohmann::json::parse(folder.read(name));
}

}  // namespace foresight
