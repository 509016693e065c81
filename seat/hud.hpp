// The head-up display: what an operator has to know, over the picture. Dear ImGui draws it.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "display/view_target.hpp"
#include "seat/seat_words.hpp"

namespace foresight {

/// Words at a place of the picture.
struct HudLabel {
  double x = 0, y = 0;  ///< px from the target's top left
  std::string words;
  Urgency urgency = Urgency::fine;
};

/// px of a target from its top left.
struct HudArea {
  double left = 0, top = 0, width = 0, height = 0;
};

/// Rows of a target, px from its top.
struct HudRows {
  double top = 0, bottom = 0;
};

struct HudContent {
  std::string title;  ///< of the robot, and of the view that is shown
  SeatLine next;      ///< what is to be done first: large, below
  std::vector<SeatLine> lines;
  std::vector<std::pair<std::string, std::string>> keys;  ///< each, and what it does
  std::size_t first_key = 0;                              ///< that is shown; above 0, lines make way for what is left
  std::vector<HudLabel> labels;                           ///< the first matter most: others make way for them
  std::optional<HudArea> area;                            ///< where all but labels stands; nothing: the whole target
  /// Of pictures that are to be compared. Lines stand above them, in two panels where there is room for two, and keys
  /// below; only trouble and the first keys go over them. Nothing: panels go anywhere.
  std::optional<HudRows> clear;
};

/// Of `count` keys, which ones come when others are asked for: those that had no room (`next`, Hud::next_key()) after
/// those from `first` on; then none (nothing); then all from the begin.
std::optional<std::size_t> keys_after(std::optional<std::size_t> first, std::size_t next, std::size_t count);

/// Belongs to one context. Nothing is told by colour alone: what is urgent has a mark before it. Where there is little
/// room, letters are smaller, and most keys, lines that are not urgent, then the first keys are left out: no panel is
/// over another.
class Hud {
 public:
  /// `scale`: of all fonts; 1: 16 px.
  explicit Hud(double scale = 1);
  ~Hud();
  Hud(const Hud&) = delete;

  /// Over what is there. `target`: of a window, or of a texture whose first row is at the bottom, too.
  void draw(const HudContent& content, const ViewTarget& target);
  /// The first one of HudContent::keys that the last draw() had no room for; their number where all fitted.
  std::size_t next_key() const { return next_key_; }

 private:
  struct Work;
  std::unique_ptr<Work> work_;
  std::size_t next_key_ = 0;
};

}  // namespace foresight
