#include "apps/replay_outputs.hpp"

#include <set>
#include <system_error>

#include "apps/output_files.hpp"
#include "common/error.hpp"
#include "common/plot_data.hpp"

namespace foresight {
namespace {

namespace fs = std::filesystem;

void check_folder(const fs::path& out, const RunFolder& run, const std::set<fs::path>& inputs) {
  const std::string where = "--out " + out.string();
  require_writable(where, fs::absolute(out) / "predicted", "");
  if (fs::is_directory(out / "contact_sheet.png"))
    throw InputError(where, "contact_sheet.png in it is a folder", "remove it or give another place");
  require_not_an_input(where, out / "contact_sheet.png", inputs);
  for (const RunFrame& frame : run.frames())
    require_not_an_input(where, out / "predicted" / (frame.left.stem + ".png"), inputs);
}

}  // namespace

void check_outputs(const ReplayOptions& options, const RunFolder& run) {
  const std::set<fs::path> inputs = input_files(run, options);
  if (options.out) check_folder(*options.out, run, inputs);
  if (options.report) check_output_file("--report", *options.report, inputs);
  if (options.html) check_output_file("--html", *options.html, inputs);
  if (const auto data = options.html ? plot_data_file(*options.html) : std::nullopt)
    check_output_file("--html", *data, inputs);
  std::error_code ignored;
  if (options.report && options.html &&
      fs::weakly_canonical(*options.report, ignored) == fs::weakly_canonical(*options.html, ignored))
    throw InputError("--html " + options.html->string(), "is the file of --report", "give each its own name");
}

}  // namespace foresight
