// What a user may choose about texture extraction.
#pragma once

#include <cstdint>
#include <optional>

namespace foresight {

struct TextureOptions {
  /// Most texels per metre of surface (thesis, d in eqs. 4.28/4.29); 0: no limit. Below it each
  /// chart gets one texel per pixel of the closest view so far: more would hold nothing more.
  /// Range 0, 1 .. 1e6.
  double texels_per_metre = 0;
  /// Most texels along a side of a flat polygon, or of a chart where that is longer (thesis, r_max in
  /// eqs. 4.28/4.29); 0: only memory limits.
  int max_texture = 0;
  /// All that the atlas may hold, both generations counted. It is reserved as pages are seen, half as much again each
  /// time; while a generation made before is still shown, what was reserved then is held beside it. Where the GPU has
  /// no more, the atlas makes do with what it has.
  std::uint64_t memory_bytes = std::uint64_t{1024} << 20;
  /// Images that views look up beside the textures: 0: none; 1: the newest one (and the one before, as far as
  /// textures lack it); more: up to so many in all, of which the older ones are chosen for how differently they see,
  /// and the newest one of the right camera. Fewer where they would take more than a quarter of memory_bytes, which
  /// they take besides. Range 0 .. 16.
  int images = 1;
  /// Pixels on the far side of a depth discontinuity that are not trusted, besides the outermost one
  /// on its near side; follows the registration's uncertainty. 0: all are trusted. Range 0 .. 32.
  double margin_px = 1.5;
  /// Surfaces nearer to each other than this count as one, metres: the model's accuracy. Smaller,
  /// errors of the model tear holes into textures; larger, thin parts leave their picture on what
  /// they lie on. Range 1e-4 .. 1.
  double depth_tolerance = 0.02;
  /// A new colour seen at less than this share of the old one's resolution does not replace it.
  double worse = 0.3;
  /// Estimate each image's gain and the lens's vignetting and even them out.
  bool even_exposure = true;
  /// Where views look the newest image up directly, textures need not hold what it shows: of each image is extracted
  /// what has no colours yet, and what the next one shows no more, or less well. False: all of each image.
  bool only_what_is_needed = true;
  /// Then, from 1: a tile that was just written with nothing that had not been seen of it before is not written again
  /// for fewer images than that. Beside silhouettes, which move along with the camera, it would be with nearly every
  /// one.
  int images_to_rewrite = 8;
  /// Find the main lamp by the shadows of what moves; then take these out of images, and let the display draw them
  /// where they fall at the instant that it shows.
  bool shadows = true;
  /// The search for it takes some tenths of a second, more where other programs want the processors. An image waits for
  /// the one that is to count from it on, so that the same images give the same textures. False: it counts once it is
  /// there.
  bool awaits_lamp = true;
  /// Where views look the newest image up directly: as a mean over those before it, as far as these agree. Nothing: on
  /// a GPU, and on a software renderer images of up to 320 x 240 px, of which it takes as much time as of a view.
  std::optional<bool> accumulate = false;
};

}  // namespace foresight
