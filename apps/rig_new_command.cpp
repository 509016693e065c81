#include "apps/rig_new_command.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <memory>
#include <optional>

#include "common/error.hpp"
#include "common/removed_when_stopped.hpp"
#include "common/text.hpp"
#include "common/unique_fd.hpp"
#include "rig/bus_plan.hpp"
#include "rig/rig_draft.hpp"

namespace foresight {
namespace {

namespace fs = std::filesystem;

struct RigNewArguments {
  std::string urdf, out, protocol = "cia402", eds, dcf, mesh_root;
};

RigDraftOptions options_of(const RigNewArguments& arguments) {
  RigDraftOptions out;
  out.urdf = arguments.urdf;
  if (!arguments.mesh_root.empty() && !fs::is_directory(arguments.mesh_root))
    throw InputError("--mesh-root " + arguments.mesh_root, "is no folder", "name the folder that holds the meshes");
  if (!arguments.mesh_root.empty()) out.mesh_root = arguments.mesh_root;
  out.protocol = arguments.protocol == "cia402" ? DriveProtocol::cia402 : DriveProtocol::powercube;
  const std::string& sheet = arguments.eds.empty() ? arguments.dcf : arguments.eds;
  if (sheet.empty()) return out;
  if (out.protocol != DriveProtocol::cia402)
    throw InputError(arguments.eds.empty() ? "--dcf" : "--eds", "describes a CiA 402 drive",
                     "leave it out: PowerCube modules have none");
  out.sheet = read_drive_sheet(sheet);
  return out;
}

/// Never over a file that is there, not even one that came a moment ago.
UniqueFd make_new_file(const fs::path& file) {
  UniqueFd fd(::open(file.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0644));
  if (fd) return fd;
  if (errno == EEXIST)
    throw InputError("--out " + file.string(), "is there already", "give another name, or remove it first");
  throw InputError("--out " + file.string(), std::string("cannot be made (") + std::strerror(errno) + ")",
                   "give a file in a folder that can be written");
}

void write_whole(const UniqueFd& fd, const fs::path& file, const std::string& text) {
  for (std::string_view rest = text; !rest.empty();) {
    const ssize_t written = ::write(fd.get(), rest.data(), rest.size());
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) {
      const std::string why = std::strerror(errno);
      ::unlink(file.c_str());
      throw RuntimeFailure("cannot write " + file.string() + " (" + why + ")", "free some disk space");
    }
    rest.remove_prefix(static_cast<std::size_t>(written));
  }
}

/// As one word of a shell's command line.
std::string shell_word(const std::string& text) {
  const auto plain = [](char c) { return std::isalnum(static_cast<unsigned char>(c)) || std::strchr("./_-+,:@%", c); };
  if (!text.empty() && std::ranges::all_of(text, plain)) return text;
  std::string out = "'";
  for (const char c : text) out += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return out + "'";
}

void tell(const RigDraft& draft, const std::string& file) {
  const Rig& rig = draft.rig;
  std::printf("%s: %s with %zu joints\n", file.c_str(), rig.name.c_str(), rig.joints.size());
  for (std::size_t i = 0; i < rig.buses.size(); ++i) {
    std::string nodes;
    for (const RigJoint& joint : rig.joints)
      if (joint.bus == i) nodes += (nodes.empty() ? "" : ", ") + std::to_string(joint.drive.node);
    std::printf("  %s: nodes %s; %.0f %% of %d kbit/s\n", rig.buses[i].name.c_str(), nodes.c_str(),
                100 * planned_bus_load(rig, i), rig.buses[i].bit_rate / 1000);
  }
  for (const std::string& warning : draft.warnings) std::printf("  warning: %s\n", warning.c_str());
  for (const std::string& note : draft.notes) std::printf("  note: %s\n", note.c_str());
  const std::string word = shell_word(file);
  std::printf("try it: foresight doctor %s; foresight robot %s\n", word.c_str(), word.c_str());
}

int run(const RigNewArguments& arguments) {
  if (arguments.out.empty()) throw InputError("--out", "is empty", "name the rig file to be written");
  const fs::path file = arguments.out;
  std::error_code error;
  if (fs::exists(fs::symlink_status(file, error)))
    throw InputError("--out " + file.string(), "is there already", "give another name, or remove it first");
  const RigDraftOptions options = options_of(arguments);
  const RigDraft draft = draft_rig(options);
  if (file.has_parent_path()) fs::create_directories(file.parent_path(), error);
  const std::string text = rig_text(draft, options, file);
  std::optional<RemovedWhenStopped> until_checked;
  UniqueFd fd;
  {
    const StopSignalsHeld held;
    fd = make_new_file(file);
    until_checked.emplace(file);
  }
  write_whole(fd, file, text);
  try {
    read_rig(file);  // what is written is what works
  } catch (...) {
    fs::remove(file, error);
    throw;
  }
  until_checked.reset();
  tell(draft, file.string());
  return 0;
}

}  // namespace

void add_rig_new_command(Command& rig, std::function<int()>& action) {
  Command* const command =
      rig.add_subcommand("new", "Makes the first rig file of your own robot, for mock drives and mock cameras");
  const auto arguments = std::make_shared<RigNewArguments>();
  command->add_option("--urdf", arguments->urdf, "The robot")->reads()->required();
  command->add_option("--out", arguments->out, "The rig file; never one that is there already")
      ->writes([](const std::filesystem::path& file) { return std::vector{new_output(file, Output::Kind::file)}; })
      ->required();
  command->add_option("--protocol", arguments->protocol, "What its drives speak: cia402 or powercube")
      ->check(one_of({"cia402", "powercube"}))
      ->capture_default_str();
  const Option* const eds =
      command
          ->add_option("--eds", arguments->eds,
                       "Electronic data sheet of its CiA 402 drives: scaling, identity, homing methods")
          ->reads();
  command->add_option("--dcf", arguments->dcf, "The same with a drive's configured values")->reads()->excludes(eds);
  command
      ->add_option("--mesh-root", arguments->mesh_root,
                   "Folder of the URDF's meshes, where they are not found from the URDF (robot.mesh_root)")
      ->reads();
  command->footer(
      "One joint for each that moves on its own, with the URDF's limits and slow first speeds; the file says why each\n"
      "number is what it is. `interface: can0` in place of `mock` is all that remains for real drives that are wired "
      "and\n"
      "scaled so: docs/own-robot.md goes there step by step.\n\n"
      "Exit codes: 0 done, 1 the file cannot be written, 2 wrong input.\n\n"
      "Example: foresight rig new --urdf arm.urdf --eds drive.eds --out rig.yaml");
  command->callback([arguments, &action] { action = [arguments] { return run(*arguments); }; });
}

}  // namespace foresight
