#include "tests/head_display/xr_test.hpp"

#include <fmt/core.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>

namespace foresight {

using namespace std::chrono_literals;

namespace {
constexpr const char* kLayers = "/usr/share/openxr/1/api_layers/explicit.d";
}

void PlainPainter::draw_eye(std::size_t eye, const head::EyeView& /*view*/, const ViewTarget& target) {
  ++eyes;
  const float red = eye == 0 ? 1.0f : 0.0f;
  fill(target, 0.2f * red, 0.2f, 0);
  ViewTarget upper = target;  // its first row is at the bottom
  upper.height /= 2;
  upper.y += target.height - upper.height;
  fill(upper, red, 1 - red, 0);
}

void PlainPainter::draw_panel(std::size_t panel, const ViewTarget& target) {
  ++drawn_panels;
  fill(target, 0, 0, panel == 0 ? 1.0f : 0.5f);
}

void use_runtime(const std::string& manifest) {
  setenv("XR_RUNTIME_JSON", manifest.c_str(), 1);
}
std::string test_runtime() {
  return FORESIGHT_TEST_RUNTIME;
}

bool HeadDisplayTest::has_validation() {
  return std::filesystem::exists(std::filesystem::path(kLayers) / "XrApiLayer_core_validation.x86_64-linux-gnu.json");
}

void HeadDisplayTest::SetUp() {
  HeadlessTest::SetUp();
  if (IsSkipped()) return;
  use_runtime(test_runtime());
  log_ = std::filesystem::temp_directory_path() / fmt::format("foresight-xr-{}.txt", getpid());
  std::filesystem::remove(log_);
  const std::filesystem::path own_layers = std::filesystem::path(test_runtime()).parent_path() / "layers";
  setenv("XR_API_LAYER_PATH", (own_layers.string() + ":" + kLayers).c_str(), 1);
  if (has_validation())
    setenv("XR_ENABLE_API_LAYERS", "XR_APILAYER_FORESIGHT_test_egl:XR_APILAYER_LUNARG_core_validation", 1);
  setenv("XR_CORE_VALIDATION_EXPORT_TYPE", "text", 1);
  setenv("XR_CORE_VALIDATION_FILE_NAME", log_.c_str(), 1);
  settings_.tick = [this](std::int64_t now) { clock_.sleep_until(RobotTime{now}); };
  openxr_runtime::runtime().reset(settings_);
  clock_.sleep_until(RobotTime{1'000'000'000});
  display_.emplace(head::HeadDisplayOptions{}, clock_, held_);
}

void HeadDisplayTest::TearDown() {
  display_.reset();
  std::filesystem::remove(log_);
  HeadlessTest::TearDown();
}

void HeadDisplayTest::run(int rounds) {
  for (int i = 0; i < rounds; ++i) {
    if (display_->step(painter_)) continue;
    ++idle_;
    clock_.sleep_until(clock_.now() + 20ms);
  }
}

testing::AssertionResult HeadDisplayTest::until(const std::function<bool()>& what, int rounds) {
  for (int i = 0; i < rounds && !what(); ++i) run(1);
  if (what()) return testing::AssertionSuccess();
  return testing::AssertionFailure() << "in " << rounds << " rounds; \"" << display_->status().trouble << "\", session "
                                     << openxr_runtime::runtime().state() << "\n"
                                     << complaints();
}

std::string HeadDisplayTest::complaints() const {
  std::string out;
  for (const std::string& one : openxr_runtime::runtime().complaints()) out += "runtime: " + one + "\n";
  std::ostringstream log;
  if (std::ifstream file(log_); file) log << file.rdbuf();
  return out + log.str();
}

}  // namespace foresight
