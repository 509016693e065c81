#include "link/send_control/erasure_code.hpp"

#include <isa-l/erasure_code.h>

#include <algorithm>
#include <stdexcept>

#include "link/send_control/packets.hpp"

namespace foresight {
namespace {

using Bytes = std::vector<std::uint8_t>;

constexpr std::size_t kTable = 32;  // bytes for each coefficient, as ISA-L wants them

/// The pair's own pieces in memory, all of the same length.
struct OwnPieces {
  explicit OwnPieces(std::span<const std::uint8_t> pair)
      : length(spare_piece_bytes(pair.size())), count((pair.size() + length - 1) / length), bytes(count * length) {
    std::copy(pair.begin(), pair.end(), bytes.begin());
  }
  std::uint8_t* at(std::size_t index) { return bytes.data() + index * length; }

  std::size_t length, count;
  Bytes bytes;
};

/// Row by row, what each of the first `rows` pieces is made of; the first `count` ones are the pair's own.
Bytes code_matrix(std::size_t rows, std::size_t count) {
  Bytes out(rows * count);
  gf_gen_cauchy1_matrix(out.data(), static_cast<int>(rows), static_cast<int>(count));
  return out;
}

/// Each sum of `from` by a row of `coefficients` into the piece of the same place of `to`.
void sum(std::size_t length, Bytes coefficients, std::vector<std::uint8_t*> from, std::vector<std::uint8_t*> to) {
  Bytes tables(kTable * from.size() * to.size());
  const int columns = static_cast<int>(from.size()), rows = static_cast<int>(to.size());
  ec_init_tables(columns, rows, coefficients.data(), tables.data());
  ec_encode_data(static_cast<int>(length), columns, rows, tables.data(), from.data(), to.data());
}

}  // namespace

std::size_t spare_piece_bytes(std::size_t pair_bytes) {
  return std::min(pair_bytes, kPieceBytes);
}

std::vector<std::uint8_t> spare_pieces(std::span<const std::uint8_t> pair, std::size_t spares) {
  if (pair.empty() || spares == 0) return {};
  OwnPieces own(pair);
  if (own.count + spares > kMostCodedPieces) throw std::invalid_argument("spare_pieces: more pieces than can be coded");
  const Bytes matrix = code_matrix(own.count + spares, own.count);
  Bytes out(spares * own.length);
  std::vector<std::uint8_t*> from, to;
  for (std::size_t i = 0; i < own.count; ++i) from.push_back(own.at(i));
  for (std::size_t i = 0; i < spares; ++i) to.push_back(out.data() + i * own.length);
  sum(own.length, {matrix.begin() + static_cast<std::ptrdiff_t>(own.count * own.count), matrix.end()}, from, to);
  return out;
}

void restore_pieces(std::span<std::uint8_t> pair, std::span<const std::uint16_t> missing,
                    const std::map<std::uint16_t, std::vector<std::uint8_t>>& spares) {
  if (missing.empty()) return;
  OwnPieces own(pair);
  if (spares.size() < missing.size() || own.count > kMostCodedPieces || spares.rbegin()->first >= kMostCodedPieces)
    throw std::invalid_argument("restore_pieces: too few pieces, or too many");
  // As many pieces as the pair has, in the order of its own: in place of each missing one another. What these are made
  // of, inverted, is what its own are made of.
  const Bytes matrix = code_matrix(kMostCodedPieces, own.count);
  Bytes here = code_matrix(own.count, own.count), inverse(here.size());
  std::vector<std::uint8_t*> from, to;
  for (std::size_t i = 0; i < own.count; ++i) from.push_back(own.at(i));
  std::vector<Bytes> kept;
  kept.reserve(missing.size());
  auto spare = spares.begin();
  for (const std::uint16_t index : missing) {
    const auto row = matrix.begin() + static_cast<std::ptrdiff_t>(spare->first * own.count);
    std::copy_n(row, own.count, here.begin() + static_cast<std::ptrdiff_t>(index * own.count));
    kept.push_back(spare->second);
    kept.back().resize(own.length);
    from[index] = kept.back().data();
    ++spare;
  }
  if (gf_invert_matrix(here.data(), inverse.data(), static_cast<int>(own.count)) != 0)
    throw std::logic_error("restore_pieces: a Cauchy matrix that cannot be inverted");
  Bytes rows;
  for (const std::uint16_t index : missing) {
    const auto row = inverse.begin() + static_cast<std::ptrdiff_t>(index * own.count);
    rows.insert(rows.end(), row, row + static_cast<std::ptrdiff_t>(own.count));
    to.push_back(own.at(index));
  }
  sum(own.length, rows, from, to);
  std::copy_n(own.bytes.begin(), pair.size(), pair.begin());
}

}  // namespace foresight
