#include "apps/recording_outputs.hpp"

#include "session/robot_cameras.hpp"

namespace foresight {

namespace fs = std::filesystem;

std::vector<Output> recording_outputs(const fs::path& out) {
  const auto refuse_foreign = [](const std::string& where, const fs::path& folder) {
    require_replaceable(where, folder, RunRecorder::form());
  };
  return {{out, Output::Kind::replaced_folder, {}, refuse_foreign},
          {joint_log_beside(out), Output::Kind::file, joint_log_form()}};
}

std::vector<Output> robot_recording_outputs(const fs::path& out) {
  std::vector<Output> all = recording_outputs(out);
  for (Output& log : can_log_outputs(can_log_beside(out))) all.push_back(std::move(log));
  return all;
}

std::vector<Output> can_log_outputs(const fs::path& file) {
  std::vector<Output> all{{file, Output::Kind::file, can_log_form()}};
  const std::string stem = file.stem().string() + "-";
  std::error_code ignored;
  const fs::path folder = file.has_parent_path() ? file.parent_path() : fs::path(".");
  for (fs::directory_iterator at(folder, ignored), end; at != end; at.increment(ignored)) {
    const fs::path name = at->path().filename();
    if (name.extension() == file.extension() && name.string().starts_with(stem) && name != file.filename())
      all.push_back({at->path(), Output::Kind::file, can_log_form()});
  }
  return all;
}

}  // namespace foresight
