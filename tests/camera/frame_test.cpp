// Conversions against references that are written out here from the formats' definitions.
#include "drivers/camera/frame.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <random>

#include "common/error.hpp"

namespace foresight::frame_test {
namespace {

constexpr int kWidth = 16, kHeight = 12;

CameraFrame frame_of(PixelFormat format, std::span<const std::uint8_t> bytes, std::size_t stride) {
  CameraFrame frame;
  frame.format = format;
  frame.width = kWidth;
  frame.height = kHeight;
  frame.stride = stride;
  frame.bytes = bytes;
  return frame;
}

/// BT.601 with 16 .. 235, as ITU-R writes it.
cv::Vec3d bgr_of(double y, double u, double v) {
  const double l = 1.164 * (y - 16);
  const auto clamp = [](double x) { return std::clamp(x, 0.0, 255.0); };
  return {clamp(l + 2.018 * (u - 128)), clamp(l - 0.391 * (u - 128) - 0.813 * (v - 128)), clamp(l + 1.596 * (v - 128))};
}

/// Within 16 .. 235: outside of that, YUV has no meaning.
std::vector<std::uint8_t> noise(std::size_t n) {
  std::mt19937 random(3);
  std::vector<std::uint8_t> out(n);
  for (auto& b : out) b = static_cast<std::uint8_t>(16 + random() % 220);
  return out;
}

void expect_yuv(const cv::Mat& is, const auto& y_at, const auto& u_at, const auto& v_at) {
  ASSERT_EQ(is.size(), cv::Size(kWidth, kHeight));
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x) {
      const cv::Vec3d wanted = bgr_of(y_at(x, y), u_at(x, y), v_at(x, y));
      // 2 of 255: fixed-point coefficients and rounding.
      EXPECT_LE(cv::norm(cv::Vec3d(is.at<cv::Vec3b>(y, x)) - wanted, cv::NORM_INF), 2) << x << ' ' << y;
    }
}

TEST(Frame, YuyvWithPaddedRows) {
  constexpr std::size_t kStride = kWidth * 2 + 8;
  const auto bytes = noise(kStride * kHeight);
  cv::Mat out;
  ASSERT_EQ(to_bgr(frame_of(PixelFormat::yuyv, bytes, kStride), out), Conversion::ok);
  const auto at = [&](int x, int y) { return bytes[kStride * std::size_t(y) + std::size_t(x)]; };
  expect_yuv(
      out, [&](int x, int y) { return at(2 * x, y); }, [&](int x, int y) { return at(x / 2 * 4 + 1, y); },
      [&](int x, int y) { return at(x / 2 * 4 + 3, y); });
}

TEST(Frame, Nv12WithPaddedRows) {
  constexpr std::size_t kStride = kWidth + 16;
  const auto bytes = noise(kStride * kHeight * 3 / 2);
  cv::Mat out;
  ASSERT_EQ(to_bgr(frame_of(PixelFormat::nv12, bytes, kStride), out), Conversion::ok);
  const auto at = [&](int x, int y) { return bytes[kStride * std::size_t(y) + std::size_t(x)]; };
  expect_yuv(
      out, [&](int x, int y) { return at(x, y); }, [&](int x, int y) { return at(x / 2 * 2, kHeight + y / 2); },
      [&](int x, int y) { return at(x / 2 * 2 + 1, kHeight + y / 2); });
}

/// A Bayer picture of one flat colour: demosaicing of any kind must give that colour back, apart from the rim.
void expect_bayer(PixelFormat eight, PixelFormat ten, const std::string& order) {
  const std::map<char, int> colour = {{'b', 40}, {'g', 120}, {'r', 200}};
  std::vector<std::uint8_t> narrow, wide;
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x) {
      const int value = colour.at(order[static_cast<std::size_t>(y % 2 * 2 + x % 2)]);
      narrow.push_back(static_cast<std::uint8_t>(value));
      const int deep = value * 4 + 3;
      wide.push_back(static_cast<std::uint8_t>(deep));
      wide.push_back(static_cast<std::uint8_t>(deep >> 8));
    }
  for (const auto& frame : {frame_of(eight, narrow, kWidth), frame_of(ten, wide, kWidth * 2)}) {
    cv::Mat out;
    ASSERT_EQ(to_bgr(frame, out), Conversion::ok) << order;
    for (int y = 2; y < kHeight - 2; ++y)
      for (int x = 2; x < kWidth - 2; ++x)
        ASSERT_EQ(out.at<cv::Vec3b>(y, x), cv::Vec3b(40, 120, 200)) << to_string(frame.format);
  }
}

TEST(Frame, BayerInAllOrders) {
  expect_bayer(PixelFormat::bayer_rggb8, PixelFormat::bayer_rggb10, "rggb");
  expect_bayer(PixelFormat::bayer_bggr8, PixelFormat::bayer_bggr10, "bggr");
  expect_bayer(PixelFormat::bayer_gbrg8, PixelFormat::bayer_gbrg10, "gbrg");
  expect_bayer(PixelFormat::bayer_grbg8, PixelFormat::bayer_grbg10, "grbg");
}

TEST(Frame, GreyAndBgr) {
  const auto bytes = noise(kWidth * kHeight * 3);
  cv::Mat out;
  ASSERT_EQ(to_bgr(frame_of(PixelFormat::bgr, bytes, kWidth * 3), out), Conversion::ok);
  EXPECT_EQ(out.at<cv::Vec3b>(0, 1), cv::Vec3b(bytes[3], bytes[4], bytes[5]));
  EXPECT_NE(out.data, bytes.data()) << "a copy";
  ASSERT_EQ(to_bgr(frame_of(PixelFormat::grey, bytes, kWidth), out), Conversion::ok);
  EXPECT_EQ(out.at<cv::Vec3b>(1, 0), cv::Vec3b::all(bytes[kWidth]));
}

std::vector<std::uint8_t> jpeg() {
  cv::Mat picture(kHeight, kWidth, CV_8UC3, cv::Scalar(40, 120, 200));
  std::vector<std::uint8_t> out;
  cv::imencode(".jpg", picture, out, {cv::IMWRITE_JPEG_QUALITY, 95});
  return out;
}

TEST(Frame, Mjpeg) {
  auto bytes = jpeg();
  bytes.resize(bytes.size() + 100);  // cameras pad
  cv::Mat out;
  ASSERT_EQ(to_bgr(frame_of(PixelFormat::mjpeg, bytes, 0), out), Conversion::ok);
  EXPECT_LE(cv::norm(out, cv::Mat(kHeight, kWidth, CV_8UC3, cv::Scalar(40, 120, 200)), cv::NORM_INF), 4);
}

TEST(Frame, TruncatedIsAnErrorForAllLengths) {
  const auto bytes = jpeg();
  cv::Mat out;
  for (std::size_t n = 0; n < bytes.size(); ++n) {
    const auto part = std::span(bytes).first(n);
    EXPECT_NE(to_bgr(frame_of(PixelFormat::mjpeg, part, 0), out), Conversion::ok) << n;
  }
  const auto raw = noise(kWidth * kHeight * 2 - 1);
  EXPECT_EQ(to_bgr(frame_of(PixelFormat::yuyv, raw, kWidth * 2), out), Conversion::truncated);
}

TEST(Frame, DamagedIsAnErrorOrAPictureNeverACrash) {
  const auto good = jpeg();
  std::mt19937 random(5);
  cv::Mat out;
  for (int i = 0; i < 2000; ++i) {
    auto bytes = good;
    for (int k = 0; k < 3; ++k) bytes[random() % bytes.size()] = static_cast<std::uint8_t>(random());
    if (to_bgr(frame_of(PixelFormat::mjpeg, bytes, 0), out) == Conversion::ok) {
      EXPECT_EQ(out.size(), cv::Size(kWidth, kHeight));
    }
  }
  CameraFrame other = frame_of(PixelFormat::mjpeg, good, 0);
  other.width = 2 * kWidth;
  EXPECT_EQ(to_bgr(other, out), Conversion::damaged) << "another size";
}

TEST(Frame, KeepsWhatOthersHold) {
  const auto bytes = noise(kWidth * kHeight * 3);
  cv::Mat out;
  to_bgr(frame_of(PixelFormat::bgr, bytes, kWidth * 3), out);
  const uchar* first = out.data;
  to_bgr(frame_of(PixelFormat::bgr, bytes, kWidth * 3), out);
  EXPECT_EQ(out.data, first) << "reuses its own";
  const cv::Mat held = out;
  to_bgr(frame_of(PixelFormat::bgr, bytes, kWidth * 3), out);
  EXPECT_NE(out.data, held.data);
}

TEST(Frame, FormatsByName) {
  EXPECT_EQ(parse_pixel_format("bayer_rggb10", "rig.yaml"), PixelFormat::bayer_rggb10);
  try {
    parse_pixel_format("mjpg", "rig.yaml");
    FAIL();
  } catch (const InputError& e) {
    EXPECT_THAT(e.what(), testing::AllOf(testing::HasSubstr("'mjpg'"), testing::HasSubstr("'mjpeg'")));
  }
}

}  // namespace
}  // namespace foresight::frame_test
