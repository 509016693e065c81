#include "seat/view_trust.hpp"

#include <fmt/core.h>

#include <utility>

namespace foresight {
namespace {

constexpr double kWorthNaming = 0.1;  // share of a tile that is wrong
constexpr int kFramePx = 2;

}  // namespace

const char* to_string(TrustMarks marks) {
  switch (marks) {
    case TrustMarks::none: return "no marks";
    case TrustMarks::hatch: return "striped where it is not exact";
    case TrustMarks::tiles: return "striped where it is not exact, framed where it was wrong";
  }
  return "";
}

ViewTrust::ViewTrust(ViewSession& session, const ViewSetup& setup, const Clock& clock, ViewTrustOptions options)
    : session_(session),
      clock_(clock),
      options_(options),
      middles_(node_middles(*setup.scene)),
      pass_(session.make_trust_pass()),
      shown_(options.fidelity),
      switch_(options.fall_back) {}

void ViewTrust::collect() {
  while (auto picture = readback_.take(options_.wait)) {
    if (options_.wait) doubt_ = picture->doubt;
    if (predicted_) shown_.shown(std::move(*picture));
  }
}

// Nothing of OpenGL: images are heard in between pictures, whatever context is current.
void ViewTrust::heard(const link::LineImage& image, const PosedFrame* posed, bool surprised) {
  shown_.told(image.loss_shares);
  auto fidelity = shown_.arrived(image.captured, image.bgr, image.lost, surprised);
  if (!fidelity) return;
  if (fidelity->psnr_db) switch_.compared(now(), *fidelity->psnr_db);
  fidelity_ = std::move(fidelity);
  if (!posed || fidelity_->comparison.empty()) return;
  compared_ = posed->left;
  compared_->pixels.release();
}

void ViewTrust::saw(const PosedFrame& frame) {
  pass_.saw(frame.left);
}

// While shadows lie where they were seen, all that they pass over is wrong, of whatever kind it is; once they lie where
// they fall, that tells nothing any more.
void ViewTrust::heed_light(RobotTime instant) {
  const TextureLease textures = session_.textures();
  const bool lit = textures && textures->light && textures->light->told_by_what_moves;
  if (std::exchange(lit_, lit) == lit) return;
  shown_.begin_anew(instant);
  compared_.reset();
  pass_.forget_patches();
}

void ViewTrust::drew(const PredictedSource& source, const ViewPlace& place, TrustMarks marks) {
  collect();
  predicted_ = source.why_invalid().empty();
  const RobotTime instant = source.instant().time;
  const bool is_due = (predicted_ || options_.wait) &&
                      (!remembered_ || instant < *remembered_ || instant - *remembered_ >= options_.remember_every);
  const std::optional<ViewPlace> before = std::exchange(drawn_at_, place);
  if (!is_due && marks == TrustMarks::none) return;
  heed_light(instant);
  const auto px = node_doubt_px(source.places(), source.robot(), session_.view().lens(), middles_, before);
  if (compared_) pass_.compared(*compared_, fidelity_->comparison);
  compared_.reset();
  pass_(session_.view(), place.T_world_camera, place.scene, px, exact());
  if (is_due && readback_.start(session_.picture(), pass_.doubt(), instant)) remembered_ = instant;
  if (options_.wait) collect();
  if (marks == TrustMarks::tiles) frame_tiles();
}

void ViewTrust::frame_tiles() const {
  if (!fidelity_) return;
  const gl::Texture& picture = pass_.marked();  // another one whenever the view's size has changed
  const TextureTarget target(picture.name(), picture.width(), picture.height());
  for (std::size_t i = 0; i < fidelity_->wrong.size(); ++i) {
    if (fidelity_->wrong[i] <= kWorthNaming) continue;
    const cv::Rect tile = tile_of(i, {picture.width(), picture.height()});
    const auto bar = [&](int x, int y, int width, int height) {
      ViewTarget side = target.whole();
      side.x = tile.x + x;
      side.y = tile.y + y;
      side.width = width;
      side.height = height;
      fill(side, 1, 0.85f, 0.2f);
    };
    bar(1, 1, tile.width - 2, kFramePx);
    bar(1, tile.height - 1 - kFramePx, tile.width - 2, kFramePx);
    bar(1, 1, kFramePx, tile.height - 2);
    bar(tile.width - 1 - kFramePx, 1, kFramePx, tile.height - 2);
  }
}

SeatLine fidelity_line(const ViewTrust& trust, const std::string& fault) {
  if (trust.falls_back() && !fault.empty())
    return {"fidelity", "not known without images that can be used", "", Urgency::note};
  if (trust.falls_back())
    return {"fidelity", trust.why(), "the newest image counts until it is better", Urgency::trouble};
  if (!trust.fidelity() || !trust.fidelity()->psnr_db) return {"fidelity", "nothing to compare with yet", ""};
  const Fidelity& of = *trust.fidelity();
  SeatLine out{"fidelity", fmt::format("{:.0f} dB", *of.psnr_db), ""};
  if (of.ssim) out.words += fmt::format(", SSIM {:.2f}", *of.ssim);
  out.words += fmt::format("; {:.0f} % exact", 1e2 * of.exact_share);
  if (of.wrong[of.worst] > kWorthNaming) out.words += "; worst: " + place_of(of.worst);
  return out;
}

}  // namespace foresight
