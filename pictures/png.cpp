#include <png.h>
#include <zlib.h>

#include <algorithm>
#include <csetjmp>
#include <cstring>
#include <stdexcept>

#include "pictures/encode.hpp"
#include "pictures/formats.hpp"

namespace foresight {
namespace {

/// Runs calls of libpng; false where one of them gave up, which leaves by a jump: `calls` may hold nothing that has a
/// destructor.
template <typename Calls>
bool complete(png_structp png, Calls&& calls) {
  if (setjmp(png_jmpbuf(png))) return false;
  calls();
  return true;
}

[[noreturn]] void give_up(png_structp png, png_const_charp) {
  png_longjmp(png, 1);
}
void say_nothing(png_structp, png_const_charp) {}

struct PngReader {
  png_structp png = png_create_read_struct(PNG_LIBPNG_VER_STRING, nullptr, give_up, say_nothing);
  png_infop info = png ? png_create_info_struct(png) : nullptr;

  PngReader() = default;
  ~PngReader() { png_destroy_read_struct(&png, &info, nullptr); }
  PngReader(const PngReader&) = delete;
  PngReader& operator=(const PngReader&) = delete;
};

struct PngWriter {
  png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, give_up, say_nothing);
  png_infop info = png ? png_create_info_struct(png) : nullptr;

  PngWriter() = default;
  ~PngWriter() { png_destroy_write_struct(&png, &info); }
  PngWriter(const PngWriter&) = delete;
  PngWriter& operator=(const PngWriter&) = delete;
};

void take_bytes(png_structp png, png_bytep out, std::size_t size) {
  auto& rest = *static_cast<std::string_view*>(png_get_io_ptr(png));
  if (size > rest.size()) png_error(png, "truncated");
  std::memcpy(out, rest.data(), size);
  rest.remove_prefix(size);
}

void keep_bytes(png_structp png, png_bytep bytes, std::size_t size) {
  auto& out = *static_cast<std::vector<std::uint8_t>*>(png_get_io_ptr(png));
  bool fits = true;
  try {
    out.insert(out.end(), bytes, bytes + size);
  } catch (const std::bad_alloc&) {
    fits = false;
  }
  if (!fits) png_error(png, "no memory");  // jumps, which nothing may do out of a catch
}

std::vector<png_bytep> rows_of(const cv::Mat& pixels) {
  std::vector<png_bytep> rows(static_cast<std::size_t>(pixels.rows));
  for (int y = 0; y < pixels.rows; ++y) rows[static_cast<std::size_t>(y)] = const_cast<png_bytep>(pixels.ptr(y));
  return rows;
}

/// Asks libpng for what is wanted of any kind of PNG; the type of the pixels that it will then give.
int ask_for(png_structp png, png_infop info, PictureColours colours) {
  const bool palette = png_get_color_type(png, info) == PNG_COLOR_TYPE_PALETTE;
  const bool coloured = png_get_color_type(png, info) & PNG_COLOR_MASK_COLOR;
  const bool see_through =
      (png_get_color_type(png, info) & PNG_COLOR_MASK_ALPHA) || png_get_valid(png, info, PNG_INFO_tRNS);
  const bool as_stored = colours == PictureColours::as_stored, with_alpha = as_stored && see_through;
  const bool wide = as_stored && png_get_bit_depth(png, info) == 16;
  if (palette) png_set_palette_to_rgb(png);
  if (!coloured) png_set_expand_gray_1_2_4_to_8(png);
  wide ? png_set_swap(png) : png_set_strip_16(png);
  if (with_alpha)
    png_set_tRNS_to_alpha(png);
  else
    png_set_strip_alpha(png);
  const bool grey = colours == PictureColours::grey || (as_stored && !coloured && !with_alpha);
  if (!grey && !coloured) png_set_gray_to_rgb(png);
  if (!grey) png_set_bgr(png);
  if (grey && coloured) png_set_rgb_to_gray(png, PNG_ERROR_ACTION_NONE, 0.299, 0.587);  // as ITU-R BT.601 weighs
  return CV_MAKETYPE(wide ? CV_16U : CV_8U, grey ? 1 : with_alpha ? 4 : 3);
}

}  // namespace

DecodedPicture decode_png(std::string_view bytes, PictureColours colours) {
  PngReader reader;
  if (!reader.info) throw std::bad_alloc();
  png_set_read_fn(reader.png, &bytes, take_bytes);
  int type = 0, width = 0, height = 0;
  const bool begun = complete(reader.png, [&] {
    png_read_info(reader.png, reader.info);
    width = static_cast<int>(png_get_image_width(reader.png, reader.info));
    height = static_cast<int>(png_get_image_height(reader.png, reader.info));
    type = ask_for(reader.png, reader.info, colours);
    png_set_interlace_handling(reader.png);
    png_read_update_info(reader.png, reader.info);
  });
  if (!begun || !bearable(width, height)) return {};
  DecodedPicture out{cv::Mat(height, width, type), {}};
  if (png_get_rowbytes(reader.png, reader.info) != out.pixels.elemSize() * static_cast<std::size_t>(width)) return {};
  std::vector<png_bytep> rows = rows_of(out.pixels);
  const bool ended = complete(reader.png, [&] {
    png_read_image(reader.png, rows.data());
    png_read_end(reader.png, nullptr);
  });
  return ended ? out : DecodedPicture{};
}

std::vector<std::uint8_t> encode_png(const cv::Mat& pixels, std::optional<int> effort) {
  const int channels = pixels.channels();
  const bool wide = pixels.depth() == CV_16U;
  if (pixels.empty() || (!wide && pixels.depth() != CV_8U) || (channels != 1 && channels != 3 && channels != 4))
    throw std::invalid_argument("a PNG of other pixels than grey, BGR or BGRA, of 8 or 16 bits");
  PngWriter writer;
  if (!writer.info) throw std::bad_alloc();
  std::vector<std::uint8_t> out;
  out.reserve(pixels.total() * pixels.elemSize() / 2);
  std::vector<png_bytep> rows = rows_of(pixels);
  png_set_write_fn(writer.png, &out, keep_bytes, nullptr);
  const bool ended = complete(writer.png, [&] {
    if (effort) {
      png_set_compression_level(writer.png, *effort);
    } else {
      png_set_filter(writer.png, PNG_FILTER_TYPE_BASE, PNG_FILTER_SUB);
      png_set_compression_level(writer.png, Z_BEST_SPEED);
      png_set_compression_strategy(writer.png, Z_RLE);
    }
    const int kind = channels == 1   ? PNG_COLOR_TYPE_GRAY
                     : channels == 3 ? PNG_COLOR_TYPE_RGB
                                     : PNG_COLOR_TYPE_RGB_ALPHA;
    png_set_IHDR(writer.png, writer.info, static_cast<png_uint_32>(pixels.cols), static_cast<png_uint_32>(pixels.rows),
                 wide ? 16 : 8, kind, PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
    png_write_info(writer.png, writer.info);
    if (channels > 1) png_set_bgr(writer.png);
    if (wide) png_set_swap(writer.png);
    png_write_image(writer.png, rows.data());
    png_write_end(writer.png, nullptr);
  });
  if (!ended) throw std::runtime_error("libpng wrote no PNG");
  return out;
}

}  // namespace foresight
