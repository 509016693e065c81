#include "apps/operator/seat_head.hpp"

#include <fmt/core.h>

namespace foresight {
namespace {

constexpr int kWordsWidth = 800, kWordsHeight = 480;  // px: 16 of them are 0.8 degrees high
constexpr Duration kWordsEvery = std::chrono::milliseconds(100);

}  // namespace

SeatHead::SeatHead(gl::Context& context, ViewSession& session, const ViewSetup& setup, PredictedSource& source,
                   SeatWindow& window, std::shared_ptr<head::HeldControllers> controllers, head::SecondEyeFrom second,
                   Clock& clock)
    : clock_(clock),
      source_(source),
      window_(window),
      hud_texture_(GL_RGBA8, kWordsWidth, kWordsHeight, 0, 1, "words"),
      hud_target_(hud_texture_.name(), kWordsWidth, kWordsHeight, -1, false),
      words_(kWordsWidth, kWordsHeight, "words in the head display"),
      image_(setup.left.width(), setup.left.height(), "newest image in the head display"),
      newest_("newest image"),
      drawer_(session, clock, {.others = setup.gate}),
      painter_(drawer_, *controllers, clock, &words_, &image_, second),
      drawing_(context.create_shared(), drawer_, clock),
      thread_(std::make_unique<head::HeadThread>(context.create_shared(), head::HeadDisplayOptions{}, clock,
                                                 controllers, painter_, [this] { painter_.release(); })) {}

SeatHead::~SeatHead() = default;

void SeatHead::stepped(const ViewStep& step, FrameSource& /*source*/, ViewSession& /*session*/) {
  if (step.drawn) painter_.show({source_.place(), window_.trusted()});
  renew();
}

void SeatHead::waiting(FrameSource& /*source*/, ViewSession& /*session*/) {
  // What was shown last may not be trusted any more.
  if (!window_.trusted()) painter_.show({{}, false});
  renew();
}

void SeatHead::renew() {
  if (const auto& newest = source_.newest(); newest && newest != uploaded_) {
    newest_.upload(newest->image[0].bgr);
    uploaded_ = newest;
    image_.write([this](const ViewTarget& target) { copy_(newest_.texture(), target); });
  }
  const OperatorTime now{clock_.now().ns};
  if (said_ && now - *said_ < kWordsEvery) return;
  said_ = now;
  constexpr float kNothing[4] = {0, 0, 0, 0};
  glClearNamedFramebufferfv(hud_target_.whole().framebuffer, GL_COLOR, 0, kNothing);
  HudContent content = window_.words();
  content.keys.clear();  // there is no keyboard to be seen
  hud_.draw(content, hud_target_.whole());
  words_.write([this](const ViewTarget& target) {
    ViewTarget turned = target;  // words are drawn as into a window: their first row is at the bottom
    turned.first_row_at_top = false;
    copy_(hud_texture_, turned);
  });
}

bool SeatHead::shows() const {
  const head::HeadStatus status = thread_->status();
  return status.shown && !head::stands_still(status, {clock_.now().ns});
}

std::vector<SeatLine> SeatHead::lines() const {
  if (const std::string failure = drawing_.failure(); !failure.empty())
    return {{"headset", failure, "start again", Urgency::trouble}};
  const head::HeadStatus status = thread_->status();
  if (head::stands_still(status, {clock_.now().ns}))
    return {{"headset", "shows nothing new", "start its runtime again", Urgency::trouble}};
  if (!status.trouble.empty()) return {{"headset", status.trouble, status.cure, Urgency::note}};
  if (!status.focused)
    return {{"headset", "shows a menu: its controllers are not followed", "close it", Urgency::note}};
  return {{"headset", fmt::format("{}, {:.0f} Hz", status.headset, status.rate_hz), "", Urgency::fine}};
}

}  // namespace foresight
