// Decoders of each format; private to this module.
#pragma once

#include "pictures/decode.hpp"

namespace foresight {

DecodedPicture decode_png(std::string_view bytes, PictureColours colours);
DecodedPicture decode_jpeg(std::string_view bytes, PictureColours colours);
DecodedPicture decode_tiff(std::string_view bytes, PictureColours colours);
DecodedPicture decode_bmp(std::string_view bytes, PictureColours colours);
/// PGM and PPM with binary samples.
DecodedPicture decode_pnm(std::string_view bytes, PictureColours colours);

/// Whether memory is taken for a picture of that size.
inline bool bearable(std::int64_t width, std::int64_t height) {
  return width > 0 && height > 0 && width <= kMostPixels / height;
}

}  // namespace foresight
