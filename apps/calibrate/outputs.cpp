#include "apps/calibrate/outputs.hpp"

#include <iostream>
#include <nlohmann/json.hpp>

#include "common/counted.hpp"
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

void tell_seen(std::size_t seen, std::size_t all) {
  std::cout << seen << " of " << counted(all, "view") << (seen == 1 ? " is" : " are")
            << " among those that the result was solved from, and " << (seen == 1 ? "does" : "do") << " not count\n";
}

int tell_verified(const Verdict& verdict, std::size_t views, nlohmann::ordered_json& numbers,
                  const std::optional<std::filesystem::path>& json) {
  numbers["pass"] = verdict.usable();
  numbers["failed_because"] = nlohmann::ordered_json::array();
  std::cout << (verdict.usable() ? "pass on " : "FAIL on ") << counted(views, "view") << "\n";
  for (const Objection& objection : verdict.against) {
    numbers["failed_because"].push_back(objection.text());
    std::cout << "FAIL: " << objection.text() << "\n";
  }
  std::cout.flush();
  write_json(json, numbers);
  return verdict.usable() ? 0 : 1;
}

int deliver(const Deliverable& found, nlohmann::ordered_json& numbers, const CalibrateOutputs& outputs) {
  const bool usable = found.verdict.usable();
  numbers["usable"] = usable;
  numbers["not_usable"] = nlohmann::ordered_json::array();
  for (const Objection& objection : found.verdict.against) numbers["not_usable"].push_back(objection.text());
  std::cout << found.verdict.text() << "\n";
  write_json(outputs.json, numbers);
  if (outputs.report && found.report) {
    HtmlReport report = found.report();
    report.verdict(found.verdict);
    report.write(*outputs.report);
  }
  if (!usable) {
    if (outputs.out) std::cout << outputs.out->string() << " is not written\n";
    return 1;
  }
  if (!outputs.out) return 0;
  ResultHeader header = found.header;
  header.date = utc_now();
  header.judged = true;
  write_result(*outputs.out, header, found.payload, outputs.force);
  return 0;
}

}  // namespace foresight
