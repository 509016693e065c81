#include "apps/doctor_command.hpp"

#include <algorithm>
#include <cstdio>

#include "apps/doctor/findings.hpp"

namespace foresight {
namespace {

using namespace doctor;

const char* mark(Verdict verdict) {
  switch (verdict) {
    case Verdict::good: return "ok  ";
    case Verdict::absent: return "-   ";
    case Verdict::poor: return "poor";
    case Verdict::bad: return "BAD ";
  }
  return "?";
}

int run(const std::string& rig_file) {
  Findings all;
  const auto add = [&](Findings more) {
    all.insert(all.end(), std::make_move_iterator(more.begin()), std::make_move_iterator(more.end()));
  };
  if (!rig_file.empty()) {
    const Rig rig = read_rig(rig_file);
    std::printf("rig %s: %zu joints on %zu buses\n", rig.name.c_str(), rig.joints.size(), rig.buses.size());
    add(check_buses(rig));
    add(check_drives(rig));
    add(check_groups(rig));
    add(check_home(rig));
    if (rig.cameras) add(check_rig_cameras(*rig.cameras));
    add(check_link(rig));
  }
  add(check_can());
  add(check_cameras());
  add(check_real_time());
  add(check_graphics());
  add(check_network());
  for (const Finding& finding : all) {
    std::printf("%s  %-18s %s\n", mark(finding.verdict), finding.subject.c_str(), finding.what.c_str());
    if (!finding.cure.empty()) std::printf("      %-18s > %s\n", "", finding.cure.c_str());
  }
  const auto bad = std::count_if(all.begin(), all.end(), [](const Finding& f) { return f.verdict == Verdict::bad; });
  if (bad > 0) std::printf("%ld of %zu checks failed\n", static_cast<long>(bad), all.size());
  return bad > 0 ? 1 : 0;
}

}  // namespace

void add_doctor_command(Command& app, std::function<int()>& action) {
  auto* command =
      app.add_subcommand("doctor", "Checks devices and permissions, and says what to type where something is missing");
  auto rig = std::make_shared<std::string>();
  command->add_option("RIG", *rig, "Rig file whose devices and line to check (docs/rig-files.md); moves nothing")
      ->reads();
  command->footer(
      "ok: fine; -: not there and not needed; poor: works, but badly; BAD: does not work.\n\n"
      "Exit codes: 0 nothing is BAD, 1 something is, 2 wrong input.\n\n"
      "Example: foresight doctor configs/minerva.yaml");
  command->callback([rig, &action] { action = [rig] { return run(*rig); }; });
}

}  // namespace foresight
