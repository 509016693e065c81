#include "link/messages/pair_notes.hpp"

#include <zlib.h>

#include "common/error.hpp"

namespace foresight::link {
namespace {

/// As they were before they told of contrasts.
struct NotesOfSteps {
  StereoFrame frame;
  std::vector<std::uint8_t> left_lost;
  template <typename Self, typename V>
  static void visit(Self& m, V&& v) {
    v("frame", m.frame)("left_lost", m.left_lost);
  }
};

}  // namespace

Bytes to_notes(const PairNotes& notes) {
  const Bytes cdr = to_cdr(notes);
  uLongf size = compressBound(cdr.size());
  Bytes out(size);
  if (cdr.size() > kMostNotesInflated || compress2(out.data(), &size, cdr.data(), cdr.size(), Z_BEST_SPEED) != Z_OK)
    throw RuntimeFailure("a pair has more notes than fit", "give the rig fewer joints, or shorter names");
  out.resize(size);
  return out;
}

std::optional<PairNotes> from_notes(std::span<const std::uint8_t> notes) {
  Bytes cdr(kMostNotesInflated);
  uLongf size = cdr.size();
  if (uncompress(cdr.data(), &size, notes.data(), notes.size()) != Z_OK) return std::nullopt;
  const auto whole = std::span<const std::uint8_t>(cdr).first(size);
  if (auto out = from_cdr<PairNotes>(whole)) return out;
  if (auto older = from_cdr<NotesOfSteps>(whole))
    return PairNotes{std::move(older->frame), std::move(older->left_lost), {}};
  auto oldest = from_cdr<StereoFrame>(whole);
  return oldest ? std::optional(PairNotes{std::move(*oldest), {}, {}}) : std::nullopt;
}

}  // namespace foresight::link
