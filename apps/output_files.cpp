#include "apps/output_files.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <system_error>
#include <vector>

#include "common/error.hpp"

namespace foresight {
namespace {

namespace fs = std::filesystem;

/// Folders that exist only as long as this does, unless they were there before.
class TrialFolder {
 public:
  explicit TrialFolder(const fs::path& folder) {
    std::error_code ignored;
    for (fs::path at = folder; at.has_relative_path() && !fs::exists(at, ignored); at = at.parent_path())
      made_.push_back(at);
    fs::create_directories(folder, error_);
    if (!error_ && !fs::is_directory(folder, ignored)) error_ = std::make_error_code(std::errc::not_a_directory);
  }
  ~TrialFolder() {
    for (const fs::path& folder : made_) ::rmdir(folder.c_str());  // the innermost first; only empty ones go
  }
  TrialFolder(const TrialFolder&) = delete;
  TrialFolder& operator=(const TrialFolder&) = delete;

  std::error_code error() const { return error_; }

 private:
  std::vector<fs::path> made_;
  std::error_code error_;
};

std::error_code try_file(const fs::path& file) {
  const int fd = ::open(file.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0600);
  if (fd < 0) return {errno, std::generic_category()};
  ::close(fd);
  ::unlink(file.c_str());
  return {};
}

}  // namespace

void require_writable(const std::string& where, const fs::path& folder, const std::string& name) {
  const TrialFolder trial(folder);
  std::error_code error = trial.error();
  if (!error) error = try_file(folder / (name + ".part" + std::to_string(::getpid())));
  if (error)
    throw InputError(where, folder.string() + " cannot be written to (" + error.message() + ")",
                     "give another place, or change its rights");
}

void require_not_an_input(const std::string& where, const fs::path& file, const std::set<fs::path>& inputs) {
  std::error_code ignored;
  if (inputs.count(fs::weakly_canonical(file, ignored)))
    throw InputError(where, "would overwrite " + file.string() + " of the run", "give another place");
}

std::set<fs::path> input_files(const RunFolder& run, const RunOptions& options) {
  std::set<fs::path> files;
  std::error_code ignored;
  const auto add = [&](const fs::path& file) { files.insert(fs::weakly_canonical(file, ignored)); };
  for (const char* name : {"camera.yaml", "camera_right.yaml", "rgb.txt", "rgb_right.txt", "trajectory.txt",
                           "nodes.txt", "scene.ply", "scene.yaml", "registration.txt", "tags.txt"})
    add(run.root() / name);
  for (const RunFrame& frame : run.frames()) {
    add(frame.left.file);
    if (frame.right) add(frame.right->file);
  }
  if (options.scene) add(*options.scene);
  return files;
}

void check_output_file(const std::string& option, const fs::path& file, const std::set<fs::path>& inputs) {
  const std::string where = option + " " + file.string();
  std::error_code ignored;
  const fs::file_status status = fs::status(file, ignored);
  if (fs::is_directory(status) || !file.has_filename()) throw InputError(where, "this is a folder", "give a file name");
  require_not_an_input(where, file, inputs);
  if (!fs::exists(status) || fs::is_regular_file(status))
    require_writable(where, fs::absolute(file).parent_path(), file.filename().string());
  else if (::access(file.c_str(), W_OK) != 0)  // a pipe or a device
    throw InputError(where, "cannot be written to", "give another place, or change its rights");
}

void make_folder(const fs::path& folder) {
  std::error_code error;
  fs::create_directories(folder, error);
  if (error)
    throw RuntimeFailure("cannot make the folder " + folder.string() + ": " + error.message(), "check the disk");
}

}  // namespace foresight
