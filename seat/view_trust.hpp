// What is known of how good the view is: pixel by pixel, of the last that could be compared, and whether it is shown.
//
//   images that come --> ShownFidelity (as it was shown) --> fidelity, kinds that are exact --> TrustSwitch --> falls
//   back
//                             ^ PictureReadback <-- views that are drawn
//   frames that are handed out --> TrustPass (what was seen when) ----> doubt, marked view
#pragma once

#include <memory>
#include <optional>

#include "common/clock.hpp"
#include "display/picture_readback.hpp"
#include "display/trust_pass.hpp"
#include "display/view_session.hpp"
#include "seat/place_doubt.hpp"
#include "seat/predicted_source.hpp"
#include "seat/seat_words.hpp"
#include "seat/shown_fidelity.hpp"
#include "seat/trust_switch.hpp"

namespace foresight {

struct ViewTrustOptions {
  FidelityOptions fidelity;
  TrustSwitchOptions fall_back;
  Duration remember_every = std::chrono::milliseconds(80);  ///< pictures that wait for their image are so far apart
  bool wait = false;  ///< for each picture's way to the CPU: in stepped time, so that runs repeat
};

/// What is drawn over the view.
enum class TrustMarks : std::uint8_t {
  none,
  hatch,  ///< stripes on what is not exact
  tiles,  ///< and frames around the parts of the view that were wrong when last an image could be compared
};
const char* to_string(TrustMarks marks);

/// Belongs to the session's context. Never makes the display wait, unless asked to.
class ViewTrust {
 public:
  /// `session` and `clock` must outlive this; not with the thesis' pipeline.
  ViewTrust(ViewSession& session, const ViewSetup& setup, const Clock& clock, ViewTrustOptions options = {});

  /// A left image came, whether or not its frame is ever handed out: what was shown for its instant is compared.
  /// `posed`: where its camera and all nodes were, if that is known. `surprised`: ShownFidelity::arrived().
  void heard(const link::LineImage& image, const PosedFrame* posed, bool surprised = false);
  /// A frame is handed out, before it becomes textures.
  void saw(const PosedFrame& frame);
  /// The session has drawn the source's instant at `place`. Without marks, marked() may stay as it is.
  void drew(const PredictedSource& source, const ViewPlace& place, TrustMarks marks);
  /// `fault`: why the prediction is invalid, "" where it is not; at each picture.
  void judge(const std::string& fault) { switch_.judged(now(), fault); }

  bool falls_back() const { return switch_.falls_back(); }
  std::string why() const { return switch_.why(); }
  const std::optional<Fidelity>& fidelity() const { return fidelity_; }
  /// Nothing is, where the newest image stands in for the view.
  ExactKinds exact() const { return falls_back() ? ExactKinds() : shown_.exact(); }
  /// ShownFidelity::risks()
  const KindRisks& risks() const { return shown_.risks(); }
  /// The view that was drawn last, marked.
  const gl::Texture& marked() const { return pass_.marked(); }
  const gl::Texture& doubt_picture() const { return pass_.doubt(); }
  /// Of the last picture, CV_8UC1; only where it waits for it.
  const cv::Mat& doubt() const { return doubt_; }

 private:
  OperatorTime now() const { return {clock_.now().ns}; }
  void collect();
  void heed_light(RobotTime instant);
  void frame_tiles() const;

  const ViewSession& session_;
  const Clock& clock_;
  ViewTrustOptions options_;
  std::vector<Eigen::Vector3d> middles_;
  TrustPass pass_;
  PictureReadback readback_;
  ShownFidelity shown_;
  TrustSwitch switch_;
  std::optional<Fidelity> fidelity_;
  std::optional<PosedImage> compared_;  // without pixels: the pass was not told of its patches yet
  std::optional<RobotTime> remembered_;
  std::optional<ViewPlace> drawn_at_;
  bool lit_ = false;        // what was drawn last has the shadows of what moves where they are to fall
  bool predicted_ = false;  // what was drawn last: else nobody was shown it, and no image of its instant may ever come
  cv::Mat doubt_;
};

/// For the head-up display: fidelity, and where it is worst. `fault`: why no images come, which another line tells.
SeatLine fidelity_line(const ViewTrust& trust, const std::string& fault);

}  // namespace foresight
