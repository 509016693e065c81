// One H.264 stream in either direction (ITU-T H.264, Main profile), by OpenH264: every picture is predicted from the
// one before it or from none, nothing is reordered, each picture comes out as soon as its bytes are in.
#pragma once

#include <memory>
#include <optional>
#include <span>

#include "link/coding/planes.hpp"

namespace foresight {

/// One thread.
class H264Encoder {
 public:
  /// For pictures of this size. Throws RuntimeFailure where the library refuses.
  explicit H264Encoder(cv::Size size);
  ~H264Encoder();
  H264Encoder(H264Encoder&&) noexcept;
  H264Encoder& operator=(H264Encoder&&) noexcept;

  /// One picture in about `bytes`: within a fifth of it mostly, but for what is too hard or too easy for it. `intra`:
  /// predicted from none; the first always is. Throws RuntimeFailure where the library fails.
  std::vector<std::uint8_t> encode(const Planes& planes, std::size_t bytes, bool intra);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// One thread.
class H264Decoder {
 public:
  /// Throws RuntimeFailure where the library refuses.
  H264Decoder();
  ~H264Decoder();
  H264Decoder(H264Decoder&&) noexcept;
  H264Decoder& operator=(H264Decoder&&) noexcept;

  /// The picture of `bytes`, which were the next of the stream or begin one. Nothing where they are damaged or the
  /// picture has not `size`; the stream has to begin anew then.
  std::optional<Planes> decode(std::span<const std::uint8_t> bytes, cv::Size size);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace foresight
