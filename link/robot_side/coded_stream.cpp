#include "link/robot_side/coded_stream.hpp"

#include <algorithm>
#include <utility>

#include "link/messages/pair_notes.hpp"

namespace foresight::link {

void CodedStream::Fates::tell(Fate fate) {
  // Whoever reports may say anything: of what came, the newest lanes matter alone. What is given up is bounded by
  // what was pending.
  constexpr std::size_t kMostKept = 1024;
  if (!busy)
    fate.arrived ? coder->encoder->arrived(fate.pair) : coder->encoder->gone(fate.pair);
  else if (!fate.arrived || kept.size() < kMostKept)
    kept.push_back(fate);
}

void CodedStream::Fates::coder_is_done() {
  busy = false;
  for (const Fate& fate : std::exchange(kept, {})) tell(fate);
}

void PairToCode::code(const Clock& clock) {
  frame_.coding = kH264Coding;
  frame_.stamps.taken_ns = clock.now().ns;
  // Notes are of the pair's share. When it was coded is not known yet: it takes the same number of bytes; and what is
  // lost, about as many as of the last pair.
  PairNotes notes{std::move(frame_), coder_->left_lost, coder_->loss_shares};
  const std::size_t noted = to_notes(notes).size();
  wish_.bytes -= std::min(noted, wish_.bytes / 2);
  CodedPair coded = coder_->encoder->encode(picture_, wish_);
  notes.left_lost.clear();
  notes.loss_shares.clear();
  if (const auto come = coder_->decoder->decode(coded)) {
    const cv::Mat lost = coding_loss(picture_.left, come->left);
    notes.left_lost.assign(lost.begin<std::uint8_t>(), lost.end<std::uint8_t>());
    coder_->lost.add(picture_.left, come->left, lost);
    notes.loss_shares = to_bytes(coder_->lost.shares());
  }
  coder_->left_lost = notes.left_lost;
  coder_->loss_shares = notes.loss_shares;
  notes.frame.stamps.coded_ns = clock.now().ns;
  coded.notes = to_notes(notes);
  coded_ = std::move(coded);
}

void CodedStream::begin_stream(std::uint64_t reader, RobotTime now) {
  stream_.emplace(Stream{.number = ++streams_, .reader = reader, .heard = now, .sender = PairSender(options_)});
  if (readers_ > 1) stream_->anew_due = now + kAnewEvery;
}

void CodedStream::take(const StereoReport& report) {
  const RobotTime now = clock_.now();
  if (!stream_ || (stream_->reader != report.reader && now - stream_->heard > kYields)) {
    begin_stream(report.reader, now);
  } else if (stream_->reader != report.reader) {
    ++counts_.refused;
    return;
  }
  stream_->heard = now;
  if (report.session == session_ && report.stream == stream_->number)
    stream_->sender.take(report.acknowledgement, now, stream_->fates);
}

void CodedStream::offer(StereoFrame frame, StereoPicture picture) {
  if (!stream_) return;
  if (waiting_) ++counts_.replaced;
  waiting_ = Waiting{std::move(frame), std::move(picture)};
}

void CodedStream::watched_by(std::size_t readers) {
  const bool came = readers > readers_;
  readers_ = readers;
  if (!stream_) return;
  if (readers <= 1) {
    stream_->anew_due.reset();
  } else if (came) {
    const RobotTime now = clock_.now();
    stream_->anew_due = stream_->last_anew ? std::max(now, *stream_->last_anew + kAgain) : now;
    stream_->again = true;
  }
}

void CodedStream::begin_anew_if_due(Stream& stream, RobotTime now) const {
  if (!stream.anew_due || now < *stream.anew_due) return;
  stream.fates.coder->encoder->begin_anew();
  stream.last_anew = now;
  stream.anew_due = now + (std::exchange(stream.again, false) ? kAgain : kAnewEvery);
}

std::optional<PairToCode> CodedStream::begin() {
  const RobotTime now = clock_.now();
  if (!waiting_ || !stream_ || stream_->fates.busy || !stream_->sender.wants_pair(now)) return std::nullopt;
  begin_anew_if_due(*stream_, now);
  PairToCode out;
  out.stream_ = stream_->number;
  out.coder_ = stream_->fates.coder;
  out.wish_ = stream_->sender.wish(now);
  out.frame_ = std::move(waiting_->frame);
  out.picture_ = std::move(waiting_->picture);
  waiting_.reset();
  stream_->fates.busy = true;
  return out;
}

void CodedStream::finish(PairToCode pair) {
  if (!stream_ || stream_->number != pair.stream_) return;  // its reader has gone meanwhile
  stream_->fates.coder_is_done();
  if (!pair.coded_) return;
  stream_->sender.hand_over(*pair.coded_, clock_.now());
  ++counts_.coded;
}

std::vector<StereoPiece> CodedStream::packets() {
  if (stream_ && clock_.now() - stream_->heard > kForgets) stream_.reset();
  std::vector<StereoPiece> out;
  if (!stream_) {
    waiting_.reset();
    return out;
  }
  for (Packet& packet : stream_->sender.packets(clock_.now(), stream_->fates)) {
    counts_.bytes += packet.size();
    out.push_back({session_, stream_->reader, stream_->number, std::move(packet)});
  }
  return out;
}

std::optional<RobotTime> CodedStream::due() const {
  return stream_ ? stream_->sender.due() : std::nullopt;
}

CodedStream::Counts CodedStream::counts() const {
  Counts out = counts_;
  if (!stream_) return out;
  out.bytes_per_s = stream_->sender.known_bytes_per_s(clock_.now()).value_or(0);
  out.loss = stream_->sender.transmissions().loss();
  return out;
}

}  // namespace foresight::link
