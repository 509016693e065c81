#include "tests/hostile/victim.hpp"

#include <sys/stat.h>

#include <algorithm>
#include <sstream>
#include <stdexcept>

namespace foresight {
namespace {

namespace fs = std::filesystem;

// A command without a row here fails the suite.
const std::map<std::string, CommandWords>& table() {
  static const std::map<std::string, CommandWords> rows = {
      {"replay", {{"RUN", {"@run"}}}},
      {"record", {{"OUT", {"@new/record"}}, {"--mock", {}}}},
      {"export", {{"RUN", {"@run"}}, {"--out", {"@new/model.glb"}}}},
      {"stereogram", {{"INPUT", {"@run"}}, {"--out", {"@new/dots.png"}}}},
      {"synth", {{"OUT", {"@new/synth"}}, {"--frames", {"1"}}, {"--size", {"32x24"}}}},
      {"can scan", {}},
      {"can dump", {{"IF", {"nocan0"}}}},
      {"can send", {{"IF", {"nocan0"}}, {"FRAME", {"123#00"}}}},
      {"can replay", {{"FILE", {"@session.log"}}, {"IF", {"nocan0"}}}},
      {"can explain", {{"FILE", {"@session.log"}}, {"--protocol", {"cia402"}}}},
      {"sim drives", {{"--can", {"nocan0"}}}},
      {"bench figures", {{"RUN", {"@run"}}, {"--out", {"@new/figures"}}}},
      {"bench extraction", {{"RUN", {"@run"}}}},
      {"bench margin", {{"RUN", {"@run"}}}},
      {"bench shadow", {{"RUN", {"@run"}}, {"--delay-ms", {"100"}}}},
      {"bench view", {{"RUN", {"@run"}}, {"--rounds", {"1"}}}},
      {"bench can", {}},
      {"bench robot", {{"RIG", {"@rig.yaml"}}}},
      {"bench calibration", {{"CORNERS", {"@corners.vnl"}}, {"--board", {"chessboard:3x3:0.1"}}}},
      {"bench line", {{"--size", {"32x32"}}, {"--seconds", {"1"}}, {"--pictures", {"2"}}}},
      {"bench registration", {}},
      {"bench camera", {}},
      {"bench head",
       {{"RUN", {"@run"}},
        {"--path", {"@poses.txt"}},
        {"--views", {"1"}},
        {"--seconds", {"0"}},
        {"--building", {"200"}},
        {"--building-views", {"2"}},
        {"--head-frames", {"2"}},
        {"--openxr-frames", {"0"}},
        {"--width", {"64"}},
        {"--height", {"48"}}}},
      {"bench seat", {{"RIG", {"@rig.yaml"}}, {"--seconds", {"1"}}, {"--delay-ms", {"20"}}}},
      {"bench display", {{"--size", {"32x24"}}, {"--seconds", {"0.2"}}, {"--rate", {"25"}}}},
      {"bench prediction ik",
       {{"--urdf", {"@arm.urdf"}}, {"--tip", {"arm_7"}}, {"--poses", {"20"}}, {"--paths", {"1"}}}},
      {"bench prediction contact",
       {{"--urdf", {"@arm.urdf"}}, {"--triangles", {"0"}}, {"--poses", {"3"}}, {"--peer-poses", {"1"}}}},
      {"bench prediction head", {{"RECORDING", {"@poses.txt"}}}},
      {"bench prediction hand", {{"RECORDING", {"@poses.txt"}}}},
      {"bench prediction response", {{"--commands", {"@poses.txt"}}, {"--states", {"@points.txt"}}}},
      {"bench prediction robot", {{"--rig", {"@rig.yaml"}}, {"--seconds", {"1"}}, {"--delay-ms", {"20"}}}},
      {"bench prediction grasp", {{"--rig", {"@rig.yaml"}}, {"--runs", {"1"}}, {"--delay-ms", {"20"}}}},
      {"bench prediction operators", {{"--rig", {"@rig.yaml"}}, {"--runs", {"1"}}, {"--delay-ms", {"20"}}}},
      {"bench link", {{"--seconds", {"1"}}}},
      {"link status", {{"--seconds", {"0.5"}}}},
      {"link listen", {{"TOPIC", {"joint_states"}}, {"--seconds", {"0.1"}}}},
      {"link rate", {{"TOPIC", {"joint_states"}}, {"--seconds", {"0.5"}}}},
      {"play", {{"FILE", {"@line.mcap"}}, {"--domain", {"9"}}}},
      {"export-run", {{"FILE", {"@line.mcap"}}, {"--out", {"@new/exported"}}}},
      {"link keys", {{"DIR", {"@new/keys"}}}},
      {"robot", {{"RIG", {"@rig.yaml"}}, {"--stepped", {}}}},
      {"input list", {}},
      {"input show", {{"DEVICE", {"@tip.csv"}}}},
      {"operator", {{"RIG", {"@rig.yaml"}}, {"--scripted", {"tour"}}, {"--seconds", {"1"}}, {"--no-zero-delay", {}}}},
      {"doctor", {{"RIG", {"@rig.yaml"}}}},
      {"rig new", {{"--urdf", {"@arm.urdf"}}, {"--out", {"@new/rig.yaml"}}}},
      {"rig view", {{"RIG", {"@rig.yaml"}}, {"--out", {"@new/rig.png"}}}},
      {"calibrate target",
       {{"--board", {"chessboard:9x6:0.02"}}, {"--out", {"@new/board.pdf"}}, {"--measured", {"100,100"}}}},
      {"calibrate capture",
       {{"--board", {"chessboard:9x6:0.025"}}, {"--out", {"@new/set"}}, {"--mock", {}}, {"--no-window", {}}}},
      {"calibrate intrinsics", {{"--corners", {"@corners.vnl"}}, {"--board", {"chessboard:3x3:0.1"}}}},
      {"calibrate stereo", {{"--corners", {"@corners.vnl"}}, {"--board", {"chessboard:3x3:0.1"}}}},
      {"calibrate photometric", {{"--flat", {"@run/rgb"}}}},
      {"calibrate pan-tilt", {{"--poses", {"@poses.txt"}}, {"--angles", {"@poses.txt"}}}},
      {"calibrate arm",
       {{"--corners", {"@corners.vnl"}}, {"--board", {"chessboard:3x3:0.1"}}, {"--poses", {"@poses.txt"}}}},
      {"calibrate time", {{"--camera-poses", {"@poses.txt"}}, {"--poses", {"@poses.txt"}}}},
      {"calibrate scene", {{"--points", {"@points.txt"}}}},
      {"calibrate display", {{"--pattern", {"1440x1600:9x8:120"}}}},
      {"calibrate verify", {{"--result", {"@result.yaml"}}}},
      {"calibrate export", {{"INPUT", {"@result.yaml"}}, {"--to", {"kalibr"}}, {"--out", {"@new/chain.yaml"}}}},
  };
  return rows;
}

std::string text_of(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

/// Without its cameras: no lab need be lit.
std::string rig_text() {
  std::string text = text_of(source_folder() / "configs/cia402.yaml");
  const auto from = text.find("\ncameras:"), to = text.find("\njoints:");
  if (from != text.npos && from < to) text.erase(from, to - from);
  return text;
}

}  // namespace

Victim::Victim() {
  const TestRun run;
  fs::copy(run.path(), *this / "run", fs::copy_options::recursive);
  write("rig.yaml", rig_text());
  fs::copy_file(source_folder() / "configs/arm.urdf", *this / "arm.urdf");
  write("motion.csv", "time_s,elbow\n0,0.2\n1,0.6\n");
  write("tip.csv", "time_s,x,y,z,qx,qy,qz,qw,gripper\n0,0,0,0,0,0,0,1,100\n1,0,0,0.1,0,0,0,1,50\n");
  write("session.log", "(1700000000.000000) can0 080#\n(1700000000.010000) can0 701#05\n");
  write("corners.vnl", "# filename x y level\na.png 10 10 0\nb.png - - -\n");
  write("poses.txt", "0 0 0 0 0 0 0 1\n1 1 0 0 0 0 0 1\n");
  write("points.txt", "0 0 0 1 0 0\n1 0 0 2 0 0\n0 1 0 1 1 0\n0 0 1 1 0 1\n");
  write("result.yaml",
        "kind: intrinsics\ndate: 2026-01-01T00:00:00Z\nscore: {name: loo_px, value: 0.2}\nresult:\n  left:\n"
        "    model: radtan4\n    width: 640\n    height: 480\n");
  write("line.mcap", "\x89MCAP0\r\n");
  write("notes.txt", "precious\n");
  write("mine/notes.txt", "precious too\n");
  ::mkfifo((*this / "fifo").c_str(), 0600);
}

std::map<std::string, std::string> Victim::snapshot() const {
  std::map<std::string, std::string> out;
  for (const auto& entry : fs::recursive_directory_iterator(path())) {
    const std::string name = entry.path().lexically_relative(path()).string();
    const fs::file_status status = entry.symlink_status();
    out[name] =
        std::to_string(static_cast<int>(status.type())) + (fs::is_regular_file(status) ? text_of(entry.path()) : "");
  }
  return out;
}

std::vector<std::string> Victim::changes(const std::map<std::string, std::string>& before) const {
  const auto now = snapshot();
  std::vector<std::string> out;
  for (const auto& [name, content] : before)
    if (const auto found = now.find(name); found == now.end() || found->second != content) out.push_back(name);
  for (const auto& [name, content] : now)
    if (!before.contains(name)) out.push_back(name);
  return out;
}

const CommandWords* Victim::row(const std::string& command) {
  const auto found = table().find(command);
  return found == table().end() ? nullptr : &found->second;
}

std::vector<std::string> Victim::rows() {
  std::vector<std::string> out;
  for (const auto& [name, words] : table()) out.push_back(name);
  return out;
}

std::vector<std::string> Victim::line(const std::string& command, const CommandWords& more) const {
  const CommandWords* const words = row(command);
  if (!words) throw std::logic_error("no row for " + command);
  CommandWords all = *words;
  for (const auto& option : more) {
    const auto same = std::ranges::find(all, option.first, &CommandWords::value_type::first);
    if (same == all.end())
      all.push_back(option);
    else
      same->second = option.second;
  }
  std::vector<std::string> out;
  std::istringstream names(command);
  for (std::string name; names >> name;) out.push_back(name);
  for (const auto& [option, values] : all) {
    if (option.starts_with('-')) out.push_back(option);
    for (const std::string& value : values)
      out.push_back(value.starts_with('@') ? (*this / value.substr(1)).string() : value);
  }
  return out;
}

std::vector<std::string> Victim::line(const HelpedCommand& command, const CommandWords& more) const {
  return line(command.name(), more);
}

}  // namespace foresight
