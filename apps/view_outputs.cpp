#include "apps/view_outputs.hpp"

#include <algorithm>

#include "apps/command_line/output_lock.hpp"
#include "apps/replay_report/contact_sheet.hpp"
#include "apps/replay_report/html_report.hpp"
#include "common/error.hpp"
#include "common/partial_path.hpp"

namespace foresight {
namespace {

namespace fs = std::filesystem;

bool is_of_a_view(const fs::directory_entry& entry, const std::vector<std::string>& folders) {
  const fs::path name = entry.path().filename();
  const fs::file_status status = entry.symlink_status();
  const auto is_picture = [](const fs::directory_entry& file) {
    return fs::is_regular_file(file.symlink_status()) && (file.path().extension() == ".png" || is_partial(file.path()));
  };
  if (is_lock(name) || is_partial(name)) return true;  // of a view that was killed
  if (std::ranges::find(folders, name.string()) != folders.end())
    return fs::is_directory(status) && std::ranges::all_of(fs::directory_iterator(entry.path()), is_picture);
  if (name == "contact_sheet.png") return fs::is_regular_file(status);
  // Reports of this command line or an earlier one: no picture takes their place.
  return fs::is_regular_file(status) && (name.extension() == ".html" || name.extension() == ".json");
}

std::vector<Output> picture_outputs(const fs::path& out, const std::vector<std::string>& folders) {
  const auto refuse_foreign = [folders](const std::string& where, const fs::path& folder) {
    for (const fs::directory_entry& entry : fs::directory_iterator(folder))
      if (!is_of_a_view(entry, folders))
        throw InputError(where, "holds " + entry.path().filename().string() + ", which is not of an earlier view",
                         "give a new folder or an empty one");
  };
  std::vector<Output> all{{out, Output::Kind::folder, {}, refuse_foreign},
                          {out / "contact_sheet.png", Output::Kind::file, png_form()}};
  for (const std::string& name : folders) all.push_back({out / name, Output::Kind::replaced_folder});
  return all;
}

}  // namespace

void add_view_outputs(Command& command, ViewOutputs& outputs, const std::vector<std::string>& folders) {
  std::string pictures;
  for (const std::string& name : folders) pictures += name + "/*.png, ";
  command.add_option("--out", outputs.out, "Folder for " + pictures + "contact_sheet.png")
      ->writes([folders](const fs::path& out) { return picture_outputs(out, folders); });
  command.add_option("--report", outputs.report, "JSON file with all measurements")->writes(numbers_form());
  command.add_option("--html", outputs.html, "HTML file with pictures and plots, self-contained")->writes(page_outputs);
}

void make_folder(const fs::path& folder) {
  std::error_code error;
  fs::create_directories(folder, error);
  if (error)
    throw RuntimeFailure("cannot make the folder " + folder.string() + ": " + error.message(), "check the disk");
}

void write_reports(const ViewOutputs& outputs, const RunRecord& record, std::span<const Instant> instants,
                   const std::string& title) {
  if (outputs.out && !instants.empty()) write_contact_sheet(title, instants, *outputs.out / "contact_sheet.png");
  if (outputs.report) write_json_report(record, *outputs.report);
  if (outputs.html) write_html_report(record, instants, *outputs.html);
}

}  // namespace foresight
