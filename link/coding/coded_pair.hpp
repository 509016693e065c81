// One stereo pair as it crosses the line.
#pragma once

#include <cstdint>
#include <opencv2/core.hpp>
#include <optional>
#include <span>
#include <vector>

#include "common/time.hpp"

namespace foresight {

/// The pictures of both eyes, of one capture instant. A camera without a partner has an empty `right`.
struct StereoPicture {
  cv::Mat left{}, right{};  ///< CV_8UC1, or CV_8UC3 (BGR); both of the same size and type
  RobotTime captured{};     ///< mid-exposure of the centre row
};

enum class Coding : std::uint8_t { jpeg = 1, h264 = 2 };

inline constexpr std::size_t kMostLanes = 6;
inline constexpr std::size_t kLargestCodedPair = 16U << 20;  ///< bytes
inline constexpr int kLargestPictureSide = 4096;             ///< px

/// All that is needed to decode it is in it, but for the picture that it is predicted from.
struct CodedPair {
  std::uint32_t number = 0;  ///< counts the coded pairs of one sender, from 1
  RobotTime captured{};
  Coding coding = Coding::jpeg;
  std::uint8_t lane = 0;        ///< below kMostLanes; predicted pairs of a lane build on each other
  std::uint32_t reference = 0;  ///< the pair of the same lane that this one is predicted from; 0: from none
  int width = 0, height = 0;    ///< px, of one eye
  bool colour = false;
  bool stereo = false;
  bool halved = false;           ///< H.264: coded at half of width and height, rounded up
  std::uint32_t left_bytes = 0;  ///< JPEG: where the right picture begins
  std::vector<std::uint8_t> data{};
  std::vector<std::uint8_t> notes{};  ///< what else is to be known with the picture, as whoever sends it has agreed
};

/// A header of kCodedPairHeader bytes (little endian, with a checksum of everything), then the notes and the data.
std::vector<std::uint8_t> to_bytes(const CodedPair& pair);
inline constexpr std::size_t kCodedPairHeader = 40;

/// The pair in `bytes`, which may be anything: nothing unless they are a whole one, bit for bit. Never throws but for
/// want of memory.
std::optional<CodedPair> parse_coded_pair(std::span<const std::uint8_t> bytes);

}  // namespace foresight
