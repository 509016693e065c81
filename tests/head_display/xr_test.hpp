// A head display on the runtime of our own, in the runtime's time, with the validation layer looking on.
#pragma once

#include <deque>

#include "display/head/head_display.hpp"
#include "tests/openxr_runtime/runtime.hpp"
#include "tests/support/headless_test.hpp"

namespace foresight {

/// Paints each eye in a colour of its own, its upper half bright; remembers what it was told.
class PlainPainter final : public head::HeadPainter {
 public:
  void look(const head::HeadFrame& frame) override { frames.push_back(frame); }
  std::span<const head::Panel> panels() override { return all_panels; }
  void draw_eye(std::size_t eye, const head::EyeView& view, const ViewTarget& target) override;
  void draw_panel(std::size_t panel, const ViewTarget& target) override;

  std::deque<head::HeadFrame> frames;
  std::vector<head::Panel> all_panels;
  int eyes = 0, drawn_panels = 0;
};

class HeadDisplayTest : public HeadlessTest {
 protected:
  void SetUp() override;
  void TearDown() override;

  /// Rounds of the display; where it has nothing to do, time goes on all the same.
  void run(int rounds);
  testing::AssertionResult until(const std::function<bool()>& what, int rounds = 1000);
  /// Of the runtime, and of the validation layer; "" where all was well.
  std::string complaints() const;
  static bool has_validation();

  openxr_runtime::Settings settings_;
  SteppedClock clock_;
  std::shared_ptr<head::HeldControllers> held_ = std::make_shared<head::HeldControllers>();
  PlainPainter painter_;
  std::optional<head::HeadDisplay> display_;
  int idle_ = 0;  // rounds without a frame

 private:
  std::filesystem::path log_;
};

/// Uses a runtime's manifest from here on; "" none at all.
void use_runtime(const std::string& manifest);
std::string test_runtime();

}  // namespace foresight
