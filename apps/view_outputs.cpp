#include "apps/view_outputs.hpp"

#include <system_error>

#include "apps/output_files.hpp"
#include "apps/replay_report/contact_sheet.hpp"
#include "apps/replay_report/html_report.hpp"
#include "common/error.hpp"
#include "common/plot_data.hpp"

namespace foresight {
namespace {

namespace fs = std::filesystem;

void check_folder(const fs::path& out, const std::set<fs::path>& inputs, std::span<const std::string> pictures) {
  const std::string where = "--out " + out.string();
  require_writable(where, fs::absolute(out) / "predicted", "");
  if (fs::is_directory(out / "contact_sheet.png"))
    throw InputError(where, "contact_sheet.png in it is a folder", "remove it or give another place");
  require_not_an_input(where, out / "contact_sheet.png", inputs);
  for (const std::string& name : pictures) require_not_an_input(where, out / "predicted" / (name + ".png"), inputs);
}

}  // namespace

void add_view_outputs(Command& command, ViewOutputs& outputs) {
  command.add_option("--out", outputs.out, "Folder for predicted/*.png and contact_sheet.png");
  command.add_option("--report", outputs.report, "JSON file with all measurements");
  command.add_option("--html", outputs.html, "HTML file with pictures and plots, self-contained");
}

void check_outputs(const ViewOutputs& outputs, const std::set<fs::path>& inputs,
                   std::span<const std::string> pictures) {
  if (outputs.out) check_folder(*outputs.out, inputs, pictures);
  if (outputs.report) check_output_file("--report", *outputs.report, inputs);
  if (outputs.html) check_output_file("--html", *outputs.html, inputs);
  if (const auto data = outputs.html ? plot_data_file(*outputs.html) : std::nullopt)
    check_output_file("--html", *data, inputs);
  std::error_code ignored;
  if (outputs.report && outputs.html &&
      fs::weakly_canonical(*outputs.report, ignored) == fs::weakly_canonical(*outputs.html, ignored))
    throw InputError("--html " + outputs.html->string(), "is the file of --report", "give each its own name");
}

void write_reports(const ViewOutputs& outputs, const RunRecord& record, std::span<const Instant> instants,
                   const std::string& title) {
  if (outputs.out && !instants.empty()) write_contact_sheet(title, instants, *outputs.out / "contact_sheet.png");
  if (outputs.report) {
    make_folder(fs::absolute(*outputs.report).parent_path());
    write_json_report(record, *outputs.report);
  }
  if (outputs.html) {
    make_folder(fs::absolute(*outputs.html).parent_path());
    write_html_report(record, instants, *outputs.html);
  }
}

}  // namespace foresight
