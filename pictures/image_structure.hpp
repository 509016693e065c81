// What an image file says about itself, and whether all of it is there.
//
// Decoders are lenient: a JPEG that was cut off is delivered with grey in place of what is
// missing. A texture made from that would be wrong without a trace, so the structure is walked
// before the decoder sees the file. Sources: PNG 1.2 (W3C REC-PNG-20031110) 5.3 to 5.5;
// JPEG ITU-T T.81 Annex B.
#pragma once

#include <filesystem>
#include <string_view>

namespace foresight {

struct ImageForm {
  int width = 0;     ///< px
  int height = 0;    ///< px
  int bits = 0;      ///< per sample, as decoded
  int channels = 0;  ///< as decoded; a palette counts as 3
  bool has_alpha = false;
};

/// Walks a PNG from its signature to IEND, checking every CRC, or a JPEG from SOI to EOI. `file`
/// is for messages. Throws InputError: neither PNG nor JPEG, truncated, damaged. Damage inside
/// the entropy-coded data of a JPEG that keeps its markers cannot be seen here.
ImageForm read_image_form(std::string_view bytes, const std::filesystem::path& file);

}  // namespace foresight
