#include "link/recording/recorded_stream.hpp"

#include "link/messages/checks.hpp"
#include "link/messages/pair_notes.hpp"

namespace foresight::link {

std::optional<RecordedStream::Pair> RecordedStream::take(const StereoPiece& piece, RobotTime now) {
  const Source source{piece.session, piece.reader, piece.stream};
  if (!receiver_ || source != source_) {
    receiver_.emplace(make_pair_decoder());
    source_ = source;
  }
  std::optional<Pair> out;
  for (foresight::ReceivedPair& pair : receiver_->take(piece.data, now)) {
    if (!pair.newest) continue;
    std::optional<PairNotes> notes = from_notes(pair.notes);
    if (!notes) continue;
    out = Pair{std::move(notes->frame), std::move(pair.picture)};
  }
  return out;
}

}  // namespace foresight::link
