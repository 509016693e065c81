#include "apps/calibrate/outputs.hpp"

#include "common/numbers_file.hpp"

namespace foresight {

void add_outputs(Command& command, CalibrateOutputs& outputs, OutputsOf out) {
  command.add_option("--json", outputs.json, "File for all numbers")->writes(numbers_form());
  command.add_option("--out", outputs.out, "Result file, YAML; a better one in its place is kept")
      ->writes(out ? std::move(out) : [](const std::filesystem::path& file) -> std::vector<Output> {
        return {{file, Output::Kind::file, result_form()}};
      });
  command.add_option("--report", outputs.report, "Report, one HTML page")->writes(page_outputs);
  command.add_flag("--force", outputs.force, "Replace a better result, or one of another kind");
}

void write_json(const std::optional<std::filesystem::path>& file, const nlohmann::ordered_json& numbers) {
  write_numbers(file, numbers.dump(2));
}

}  // namespace foresight
