// Pixels out of files and into them, judged by OpenCV's imgcodecs, another reader and writer of all these formats.
#include <gtest/gtest.h>
#include <zlib.h>

#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "pictures/decode.hpp"
#include "pictures/encode.hpp"
#include "pictures/picture_file.hpp"
#include "tests/scene/test_run.hpp"

namespace foresight::pictures_test {
namespace {

/// Smooth enough for a JPEG, with all channels differing; of an odd size.
cv::Mat picture(int type, cv::Size size = {37, 23}) {
  cv::Mat out(size, type);
  cv::RNG random(7);
  random.fill(out, cv::RNG::UNIFORM, 0, out.depth() == CV_16U ? 65536 : 256);
  cv::blur(out, out, {5, 5});
  return out;
}

constexpr cv::ImreadModes kColour = cv::IMREAD_COLOR, kGrey = cv::IMREAD_GRAYSCALE, kStored = cv::IMREAD_UNCHANGED;

cv::Mat peers(const std::string& bytes, int mode) {
  return cv::imdecode(std::vector<uchar>(bytes.begin(), bytes.end()),
                      mode == kStored ? mode : mode | cv::IMREAD_IGNORE_ORIENTATION);
}

/// In each of the ways that a caller may ask for, the pixels are those of OpenCV, up to `most` of 255.
void expect_peers_pixels(const std::string& bytes, double most = 0) {
  for (const auto& [ours, theirs] : {std::pair{PictureColours::as_stored, kStored},
                                     {PictureColours::grey, kGrey},
                                     {PictureColours::colour, kColour}}) {
    SCOPED_TRACE(theirs);
    const DecodedPicture found = decode_picture(bytes, ours);
    const cv::Mat expected = peers(bytes, theirs);
    ASSERT_FALSE(expected.empty());
    ASSERT_EQ(found.pixels.type(), expected.type());
    ASSERT_EQ(found.pixels.size(), expected.size());
    EXPECT_LE(cv::norm(found.pixels, expected, cv::NORM_INF), most);
    EXPECT_EQ(found.damage, "");
  }
}

TEST(Pictures, AreReadAsOpenCvReadsThem) {
  for (const int type : {CV_8UC1, CV_8UC3, CV_8UC4, CV_16UC1, CV_16UC3, CV_16UC4}) {
    SCOPED_TRACE(type);
    expect_peers_pixels(encoded(".png", picture(type)));
  }
  expect_peers_pixels(encoded(".pgm", picture(CV_16UC1)), 1);
  expect_peers_pixels("P6 # made by hand\n2 1\n255\n" + std::string("\1\2\3\xff\xfe\xfd"));
  for (const int type : {CV_8UC1, CV_8UC3}) {
    SCOPED_TRACE(type);
    for (const char* format : {".jpg", ".bmp", ".tif", ".pgm", ".ppm"}) {
      SCOPED_TRACE(format);
      if ((format == std::string(".pgm")) != (type == CV_8UC1) && format[1] == 'p') continue;
      expect_peers_pixels(encoded(format, picture(type)), format == std::string(".tif") ? 1 : 0);  // sums are rounded
    }
  }
}

std::string big_endian(std::size_t value) {
  std::string out;
  for (const int shift : {24, 16, 8, 0}) out += static_cast<char>(value >> shift);
  return out;
}

std::string chunk(const std::string& content) {
  const auto crc = crc32_z(0, reinterpret_cast<const Bytef*>(content.data()), content.size());
  return big_endian(content.size() - 4) + content + big_endian(crc);
}

/// A PNG of 2 x 2 pixels. `rows`: each with a zero before it.
std::string small_png(int bits, int kind, const std::string& before, const std::string& rows) {
  std::string data(100, '\0');
  uLongf size = data.size();
  compress(reinterpret_cast<Bytef*>(data.data()), &size, reinterpret_cast<const Bytef*>(rows.data()), rows.size());
  const std::string how{static_cast<char>(bits), static_cast<char>(kind), '\0', '\0', '\0'};
  return "\x89PNG\r\n\x1a\n" + chunk("IHDR" + big_endian(2) + big_endian(2) + how) + before +
         chunk("IDAT" + data.substr(0, size)) + chunk("IEND");
}

// What OpenCV reads and does not write.
TEST(Pictures, OfPalettesOfFewBitsAndWithAlphaBesideGrey) {
  const std::string four = chunk(std::string("PLTE\xff\0\0\0\xff\0\0\0\xff\xff\xc8\x64", 16));
  const std::string rows("\0\0\1\0\2\3", 6);
  expect_peers_pixels(small_png(8, 3, four, rows));
  expect_peers_pixels(small_png(8, 3, four + chunk("tRNS\xff\x80"), rows));
  for (const int bits : {1, 2, 4}) expect_peers_pixels(small_png(bits, 0, "", std::string("\0\x50\0\xa0", 4)));
  expect_peers_pixels(small_png(8, 4, "", std::string("\0\x50\xff\x10\xff\0\x20\xff\xee\x80", 10)));
}

TEST(Pictures, AreWrittenSoThatOpenCvReadsThem) {
  for (const int type : {CV_8UC1, CV_8UC3, CV_8UC4, CV_16UC1, CV_16UC3, CV_16UC4})
    for (const auto& effort : {std::optional<int>(), std::optional(0), std::optional(9)}) {
      const cv::Mat all = picture(type);
      for (const cv::Mat& pixels : {all, all(cv::Rect(3, 2, 20, 11))}) {  // a part of another picture, too
        const auto bytes = encode_png(pixels, effort);
        EXPECT_EQ(cv::norm(cv::imdecode(bytes, kStored), pixels, cv::NORM_INF), 0) << type;
      }
    }
  for (const int type : {CV_8UC1, CV_8UC3})
    for (const int quality : {20, 88, 100}) {
      std::vector<uchar> theirs;
      cv::imencode(".jpg", picture(type), theirs, {cv::IMWRITE_JPEG_QUALITY, quality});
      EXPECT_EQ(encode_jpeg(picture(type), quality), theirs);
    }
  EXPECT_EQ(encode_for(".png", picture(CV_8UC3), 50), encode_png(picture(CV_8UC3)));
  EXPECT_EQ(encode_for(".jpg", picture(CV_8UC3), 50), encode_jpeg(picture(CV_8UC3), 50));
}

TEST(Pictures, ThatCannotBeWrittenAreOurFault) {
  EXPECT_THROW(encode_png({}), std::invalid_argument);
  EXPECT_THROW(encode_png(picture(CV_8UC2)), std::invalid_argument);
  EXPECT_THROW(encode_png(cv::Mat(2, 2, CV_32FC1, cv::Scalar(0))), std::invalid_argument);
  EXPECT_THROW(encode_jpeg({}, 80), std::invalid_argument);
  EXPECT_THROW(encode_jpeg(picture(CV_8UC4), 80), std::invalid_argument);
  EXPECT_THROW(encode_jpeg(cv::Mat(1, 65501, CV_8UC1, cv::Scalar(0)), 80), std::invalid_argument);
}

TEST(Pictures, ThatAreNoneOrTooLargeAreNotDecoded) {
  for (const std::string bytes : {"", "text", "\x89PNG", "\xff\xd8", "II*", "BM", "P5 1 1 255\n", "P5 1 -1 255\n1"})
    EXPECT_TRUE(decode_picture(bytes, PictureColours::colour).pixels.empty()) << bytes;
  EXPECT_TRUE(decode_picture("P5 20000 20000 255\n" + std::string(64, 'x'), PictureColours::grey).pixels.empty());
  std::string jpeg = encoded(".jpg", picture(CV_8UC1));
  const std::size_t frame = jpeg.find("\xFF\xC0");
  for (std::size_t i = 5; i < 9; ++i) jpeg[frame + i] = '\xFE';
  EXPECT_TRUE(decode_picture(jpeg, PictureColours::grey).pixels.empty());
}

// PNG and JPEG have their own test of that (tests/scene/image_test.cpp).
TEST(Pictures, ThatAreCutOffAreNone) {
  for (const char* format : {".bmp", ".tif", ".ppm", ".pgm"}) {
    const std::string whole = encoded(format, picture(format[2] == 'g' && format[1] == 'p' ? CV_8UC1 : CV_8UC3));
    EXPECT_FALSE(decode_picture(whole, PictureColours::colour).pixels.empty()) << format;
    EXPECT_TRUE(decode_picture(whole.substr(0, whole.size() - 4), PictureColours::colour).pixels.empty()) << format;
  }
}

// No byte that is cut off or turned makes a decoder fall, whatever it then gives.
TEST(Pictures, AnyBytesAreBorne) {
  for (const char* format : {".png", ".jpg", ".bmp", ".tif", ".ppm"}) {
    const std::string whole = encoded(format, picture(CV_8UC3, {9, 7}));
    for (std::size_t i = 0; i < whole.size(); ++i) {
      std::string other = whole;
      other[i] = static_cast<char>(other[i] ^ (1 << i % 8));
      decode_picture(other, PictureColours::as_stored);
      decode_picture(whole.substr(0, i), PictureColours::colour);
    }
  }
}

TEST(Pictures, WhatADecoderMadeUpIsTold) {
  const std::string whole = encoded(".jpg", picture(CV_8UC3, {64, 48}));
  const std::string half = whole.substr(0, whole.size() / 2) + "\xFF\xD9";
  const DecodedPicture found = decode_picture(half, PictureColours::colour);
  EXPECT_EQ(found.pixels.size(), cv::Size(64, 48));
  EXPECT_NE(found.damage, "");
  const TempFolder folder;
  EXPECT_THAT(input_error([&] { read_picture(folder.write("half.jpg", half), PictureColours::colour); }),
              says("half.jpg", "damaged", "copy it again"));
  EXPECT_THAT(input_error([&] { read_picture(folder.write("none.png", "text"), PictureColours::colour); }),
              says("none.png", "no image that can be read", "copy it again"));
  EXPECT_EQ(read_picture(folder.write("whole.jpg", whole), PictureColours::grey).type(), CV_8UC1);
}

}  // namespace
}  // namespace foresight::pictures_test
