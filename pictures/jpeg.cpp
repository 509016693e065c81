// clang-format off
#include <cstdio>  // jpeglib.h uses what it declares
#include <jerror.h>
#include <jpeglib.h>
// clang-format on

#include <algorithm>
#include <csetjmp>
#include <cstdlib>
#include <memory>
#include <stdexcept>

#include "pictures/encode.hpp"
#include "pictures/formats.hpp"

namespace foresight {
namespace {

/// Warnings of pixels that libjpeg made up; others (an unknown revision, a profile) change none.
bool tells_of_damage(int code) {
  switch (code) {
    case JWRN_EXTRANEOUS_DATA:
    case JWRN_HIT_MARKER:
    case JWRN_HUFF_BAD_CODE:
    case JWRN_MUST_RESYNC:
    case JWRN_JPEG_EOF: return true;
    default: return false;
  }
}

/// What libjpeg does with errors and warnings: nothing is printed, the first word of damage is kept, an error jumps
/// back.
struct JpegHandler : jpeg_error_mgr {
  std::jmp_buf back;
  char damage[JMSG_LENGTH_MAX] = "";

  JpegHandler() {
    jpeg_std_error(this);
    error_exit = [](j_common_ptr about) { std::longjmp(static_cast<JpegHandler*>(about->err)->back, 1); };
    emit_message = [](j_common_ptr about, int level) {
      JpegHandler& handler = *static_cast<JpegHandler*>(about->err);
      if (level < 0 && !handler.damage[0] && tells_of_damage(handler.msg_code))
        handler.format_message(about, handler.damage);
    };
    output_message = [](j_common_ptr) {};
  }
};

/// Runs calls of libjpeg; false where one of them gave up, which leaves by a jump: `calls` may hold nothing that has a
/// destructor.
template <typename Calls>
bool complete(JpegHandler& handler, Calls&& calls) {
  if (setjmp(handler.back)) return false;
  calls();
  return true;
}

struct JpegReader : jpeg_decompress_struct {
  explicit JpegReader(JpegHandler& handler) : jpeg_decompress_struct{} {
    err = &handler;
    if (!complete(handler, [this] { jpeg_create_decompress(this); })) throw std::bad_alloc();
  }
  ~JpegReader() { jpeg_destroy_decompress(this); }
  JpegReader(const JpegReader&) = delete;
  JpegReader& operator=(const JpegReader&) = delete;
};

struct JpegWriter : jpeg_compress_struct {
  explicit JpegWriter(JpegHandler& handler) : jpeg_compress_struct{} {
    err = &handler;
    if (!complete(handler, [this] { jpeg_create_compress(this); })) throw std::bad_alloc();
  }
  ~JpegWriter() {
    jpeg_destroy_compress(this);
    std::free(bytes);
  }
  JpegWriter(const JpegWriter&) = delete;
  JpegWriter& operator=(const JpegWriter&) = delete;

  unsigned char* bytes = nullptr;  ///< libjpeg takes and grows it
  unsigned long size = 0;
};

}  // namespace

DecodedPicture decode_jpeg(std::string_view bytes, PictureColours colours) {
  JpegHandler handler;
  JpegReader reader(handler);
  const bool begun = complete(handler, [&] {
    jpeg_mem_src(&reader, reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size());
    jpeg_read_header(&reader, TRUE);
  });
  if (!begun || !bearable(reader.image_width, reader.image_height)) return {};
  const bool grey = colours == PictureColours::grey ||
                    (colours == PictureColours::as_stored && reader.jpeg_color_space == JCS_GRAYSCALE);
  reader.out_color_space = grey ? JCS_GRAYSCALE : JCS_EXT_BGR;
  DecodedPicture out{
      cv::Mat(static_cast<int>(reader.image_height), static_cast<int>(reader.image_width), grey ? CV_8UC1 : CV_8UC3),
      {}};
  const bool ended = complete(handler, [&] {
    jpeg_start_decompress(&reader);
    while (reader.output_scanline < reader.output_height) {
      JSAMPROW row = out.pixels.ptr(static_cast<int>(reader.output_scanline));
      jpeg_read_scanlines(&reader, &row, 1);
    }
    jpeg_finish_decompress(&reader);
  });
  if (!ended) return {};
  out.damage = handler.damage;
  return out;
}

std::vector<std::uint8_t> encode_jpeg(const cv::Mat& pixels, int quality) {
  if (pixels.empty() || (pixels.type() != CV_8UC1 && pixels.type() != CV_8UC3) ||
      std::max(pixels.cols, pixels.rows) > JPEG_MAX_DIMENSION)
    throw std::invalid_argument("a JPEG of other pixels than 8-bit grey or BGR");
  JpegHandler handler;
  JpegWriter writer(handler);
  const bool ended = complete(handler, [&] {
    jpeg_mem_dest(&writer, &writer.bytes, &writer.size);
    writer.image_width = static_cast<JDIMENSION>(pixels.cols);
    writer.image_height = static_cast<JDIMENSION>(pixels.rows);
    writer.input_components = pixels.channels();
    writer.in_color_space = pixels.channels() == 1 ? JCS_GRAYSCALE : JCS_EXT_BGR;
    jpeg_set_defaults(&writer);
    jpeg_set_quality(&writer, quality, TRUE);
    jpeg_start_compress(&writer, TRUE);
    while (writer.next_scanline < writer.image_height) {
      JSAMPROW row = const_cast<JSAMPROW>(pixels.ptr(static_cast<int>(writer.next_scanline)));
      jpeg_write_scanlines(&writer, &row, 1);
    }
    jpeg_finish_compress(&writer);
  });
  if (!ended) throw std::runtime_error("libjpeg wrote no JPEG");
  return {writer.bytes, writer.bytes + writer.size};
}

}  // namespace foresight
