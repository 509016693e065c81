// A session of a robot as a page: what it did and why, and all joints over time.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "apps/robot/session_record.hpp"

namespace foresight {

/// Facts about a session beside its record, one row each.
struct SessionFact {
  std::string name, value;
};

/// Writes the page, and the series of its plots as JSON beside it (common/plot_data.hpp). `verdict`: the first
/// sentence. Throws RuntimeFailure where that cannot be.
void write_session_report(const std::filesystem::path& file, const Rig& rig, const SessionRecord& record,
                          const std::string& verdict, const std::vector<SessionFact>& facts);

}  // namespace foresight
