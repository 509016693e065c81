#include "apps/calibrate/outputs.hpp"

#include "common/atomic_file.hpp"

namespace foresight {

void add_outputs(Command& command, CalibrateOutputs& outputs) {
  command.add_option("--json", outputs.json, "File for all numbers");
  command.add_option("--out", outputs.out, "Result file, YAML; a better one in its place is kept");
  command.add_option("--report", outputs.report, "Report, one HTML page");
  command.add_flag("--force", outputs.force, "Replace a better result, or one of another kind");
}

void write_json(const std::optional<std::filesystem::path>& file, const nlohmann::ordered_json& numbers) {
  if (!file) return;
  write_file_atomically(*file, numbers.dump(2) + "\n");
}

}  // namespace foresight
