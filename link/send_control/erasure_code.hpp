// Pieces beyond a pair's own, of which any stands in for any piece that was lost on the way.
//
// A systematic Reed-Solomon code over GF(256) with a Cauchy matrix: of n pieces and any number of others, each n
// different ones have all bytes (Bloemer et al. 1995, An XOR-Based Erasure-Resilient Coding Scheme). Intel's ISA-L does
// the sums. The others of a pair are numbered on from its own; the last of its own counts as filled up with zeros.
#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <vector>

namespace foresight {

/// A pair's own pieces and the others together.
inline constexpr std::size_t kMostCodedPieces = 255;

/// Bytes of each other piece of a pair of `pair_bytes`: as many as of its longest own one.
std::size_t spare_piece_bytes(std::size_t pair_bytes);

/// `spares` other pieces of `pair`, one behind the other. Its own ones and they: kMostCodedPieces at most.
std::vector<std::uint8_t> spare_pieces(std::span<const std::uint8_t> pair, std::size_t spares);

/// Writes what `pair` lacks of its own pieces. Those at `missing`, each of them once; and at least as many others, by
/// index, each of spare_piece_bytes.
void restore_pieces(std::span<std::uint8_t> pair, std::span<const std::uint16_t> missing,
                    const std::map<std::uint16_t, std::vector<std::uint8_t>>& spares);

}  // namespace foresight
