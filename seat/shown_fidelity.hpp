// What was shown, beside the image of the same instant once it has come: how alike they are, where they are not, and
// of what kind the pixels are that are nearly always right.
//
//   shown for t1  t2  t3 ...                  image of t2 comes
//         '---'---'---> kept -----------------> fidelity of t2, worst part of the view, kinds that are exact
#pragma once

#include <array>
#include <deque>
#include <opencv2/core.hpp>
#include <optional>
#include <string>
#include <vector>

#include "display/doubt_kinds.hpp"
#include "display/picture_readback.hpp"

namespace foresight {

struct FidelityOptions {
  Duration same_instant = std::chrono::milliseconds(20);  ///< by which picture and image may be apart, > 0
  std::size_t kept = 48;                                  ///< pictures that wait for their image, > 0
  double wrong_levels = kWrongLevels;                     ///< grey levels beyond which a pixel is wrong
  double wrong_share = kRarelyWrong;                      ///< of the pixels that count as exact, that may be wrong
  double wrong_of_kind = kOftenWrong;                     ///< of the pixels of each kind, likewise
};

/// How alike what was shown for an instant and the image of it are, over pixels that images have coloured.
struct Fidelity {
  static constexpr std::size_t kColumns = 6, kRows = 4;  ///< tiles of the view
  RobotTime instant;
  std::optional<double> psnr_db, ssim;         ///< nothing where no pixel has a colour
  std::array<double, kColumns * kRows> wrong;  ///< share of each tile's pixels, row by row
  std::size_t worst = 0;                       ///< tile
  double exact_share = 0;                      ///< of the coloured pixels
  double exact_wrong = 0;                      ///< of the exact ones
  /// CV_8UC1, as doubt_kinds.hpp says. In and around patches that were shown wrong something moves that is not
  /// foretold.
  cv::Mat comparison = {};  ///< empty where it tells nothing of what is shown now (begin_anew)
};
/// "top left", "middle", ...
std::string place_of(std::size_t tile);
/// The pixels of a tile in a picture of that size.
cv::Rect tile_of(std::size_t tile, cv::Size size);

/// Pixels that count as exact: coloured by an image, of kinds that do. CV_8UC1, 255 or 0.
cv::Mat exact_mask(const cv::Mat& picture, const cv::Mat& doubt, const ExactKinds& exact);

/// One thread.
class ShownFidelity {
 public:
  explicit ShownFidelity(FidelityOptions options = {});

  /// What the newest images that came have lost where coding took something away, as told with them.
  void told(const LossShares& lost);
  /// Was shown; later than what was shown before, else all that is kept goes.
  void shown(RememberedView picture);
  /// What is shown from this instant on is drawn another way: what was wrong in patches before had a reason that is no
  /// more, and tells nothing of other pixels of the same kinds.
  void begin_anew(RobotTime from);
  /// The image of an instant came, in the order of their instants: nothing where no picture was shown for it, or one of
  /// other proportions. One of another size is compared as it looks at the image's. `image`: CV_8UC3; where coding took
  /// something away from it (`lost`, PosedImage::lost), nothing is compared, and elsewhere such an image is taken to be
  /// a little smoother than the truth. `surprised`: the robot did something else then than was expected; how right
  /// pixels of each kind are where it does as expected, that does not tell.
  std::optional<Fidelity> arrived(RobotTime instant, const cv::Mat& image, const cv::Mat& lost = {},
                                  bool surprised = false);
  /// Which kinds of pixels count as exact: those that were wrong most rarely, as many as it takes until
  /// FidelityOptions::wrong_share of all such pixels have to be expected to be wrong, in what was shown last and in a
  /// usual picture of late together: good pictures make up for bad ones. Never a kind of which more than wrong_of_kind
  /// have to be: however good all else is, it says nothing of a ball that rolls through it.
  const ExactKinds& exact() const { return exact_; }
  /// By which they are chosen: as learnt, or as assumed of a kind that was not compared yet.
  const KindRisks& risks() const { return risks_; }

 private:
  struct Counts {
    double all = 0, wrong = 0;
  };
  using ByKind = std::array<Counts, kKindsEnd>;
  static ByKind count(const cv::Mat& seen, const cv::Mat& doubt, const cv::Mat& wrong);
  static void add(const ByKind& counts, ByKind& to);
  void learn();
  void learn_coded_away();
  void choose(const ByKind& pixels);

  FidelityOptions options_;
  std::deque<RememberedView> kept_;
  RobotTime begin_;                      // what was shown before tells nothing
  ByKind of_late_{}, beside_patches_{};  // all of late, and what lay in no patch that was wrong
  double assumed_ = 1;                   // pixels of each kind that are taken to have been as assumed
  KindRisks risks_{};                    // of a pixel of each kind to be wrong
  LossShares lost_ = even_loss_shares();
  double smoothed_ = 0;  // share of pixels that agree with a coded image, and not with the truth
  ExactKinds exact_;
};

}  // namespace foresight
