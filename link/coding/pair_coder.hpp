// Coding of stereo pairs for a line that loses and delays: who encodes is told what the other side has.
//
// Predicted pairs form lanes. Each pair builds on the one before it in its lane, so that a pair can be decoded exactly
// if and only if that one was:
//
//   lane 0    1 <-- 2 <-- 3 <------------- 6          3 lost a piece: 4 and 5 build on pairs that have arrived, and
//   lane 1    4 (from none) <-- 5                     are shown; 3 is sent again, and lane 0 goes on
//
// A picture that would show anything but what was encoded is refused, never shown.
#pragma once

#include <memory>

#include "link/coding/coded_pair.hpp"

namespace foresight {

/// What the next pair is to be like.
struct PairWish {
  std::uint32_t number = 1;        ///< above all earlier ones
  std::size_t bytes = 50'000;      ///< about how many it may take
  bool only_what_arrived = false;  ///< predict from pairs that the receiver has decoded, not from ones on the way
};

/// Who is told what becomes of pairs.
class PairFates {
 public:
  virtual ~PairFates() = default;

  /// The receiver has decoded this pair.
  virtual void arrived(std::uint32_t number) = 0;
  /// The receiver will never have this pair; what builds on it is lost too.
  virtual void gone(std::uint32_t number) = 0;
};

/// One thread.
class PairEncoder : public PairFates {
 public:
  /// Throws InputError for pictures of other kinds than StereoPicture says, RuntimeFailure where a library fails.
  virtual CodedPair encode(const StereoPicture& picture, const PairWish& wish) = 0;
  /// No pair from now on builds on one from before: for who has not seen those.
  virtual void begin_anew() {}
};

/// One thread.
class PairDecoder {
 public:
  virtual ~PairDecoder() = default;

  /// Whether `pair` could be decoded now: it builds on nothing, or on the newest of its lane.
  virtual bool ready(const CodedPair& pair) const = 0;
  /// The picture exactly as the encoder has it; nothing where that is not possible: `pair` was not ready, or is
  /// damaged.
  virtual std::optional<StereoPicture> decode(const CodedPair& pair) = 0;
};

std::unique_ptr<PairEncoder> make_pair_encoder(Coding coding);
/// Takes pairs of all codings.
std::unique_ptr<PairDecoder> make_pair_decoder();

/// Throws InputError: no picture, another type, eyes of different sizes, larger than kLargestPictureSide.
void check(const StereoPicture& picture);

}  // namespace foresight
