#include "link/robot_side/coded_stream.hpp"

#include "link/messages/pair_notes.hpp"

namespace foresight::link {

void CodedStream::begin(std::uint64_t reader, RobotTime now) {
  stream_.emplace(Stream{.number = ++streams_, .reader = reader, .heard = now, .sender = PairSender(options_)});
}

void CodedStream::take(const StereoReport& report) {
  const RobotTime now = clock_.now();
  if (!stream_ || (stream_->reader != report.reader && now - stream_->heard > kYields)) {
    begin(report.reader, now);
  } else if (stream_->reader != report.reader) {
    ++counts_.refused;
    return;
  }
  stream_->heard = now;
  if (report.session == session_ && report.stream == stream_->number)
    stream_->sender.take(report.acknowledgement, now, *stream_->encoder);
}

void CodedStream::offer(StereoFrame frame, StereoPicture picture) {
  if (!stream_) return;
  if (waiting_) ++counts_.replaced;
  waiting_ = Waiting{std::move(frame), std::move(picture)};
}

/// The pair that waits, into the line.
void CodedStream::code(Stream& stream) {
  Waiting pair = std::move(*waiting_);
  waiting_.reset();
  const RobotTime begin = clock_.now();
  pair.frame.coding = kH264Coding;
  pair.frame.stamps.taken_ns = begin.ns;
  PairWish wish = stream.sender.wish(begin);
  // Notes are of the pair's share. When it was coded is not known yet: it takes the same number of bytes.
  const std::size_t notes = to_notes(pair.frame).size();
  wish.bytes -= std::min(notes, wish.bytes / 2);
  CodedPair coded = stream.encoder->encode(pair.picture, wish);
  const RobotTime end = clock_.now();
  pair.frame.stamps.coded_ns = end.ns;
  coded.notes = to_notes(pair.frame);
  stream.sender.hand_over(coded, end);
  ++counts_.coded;
}

void CodedStream::take_packets(Stream& stream, std::vector<StereoPiece>& out) {
  for (Packet& packet : stream.sender.packets(clock_.now(), *stream.encoder)) {
    counts_.bytes += packet.size();
    out.push_back({session_, stream.reader, stream.number, std::move(packet)});
  }
}

std::vector<StereoPiece> CodedStream::step() {
  if (stream_ && clock_.now() - stream_->heard > kForgets) stream_.reset();
  std::vector<StereoPiece> out;
  if (!stream_) {
    waiting_.reset();
    return out;
  }
  // What was lost goes first: its packets count as on the way when the next pair is judged.
  take_packets(*stream_, out);
  if (waiting_ && stream_->sender.wants_pair(clock_.now())) {
    code(*stream_);
    take_packets(*stream_, out);
  }
  return out;
}

std::optional<RobotTime> CodedStream::due() const {
  return stream_ ? stream_->sender.due() : std::nullopt;
}

CodedStream::Counts CodedStream::counts() const {
  Counts out = counts_;
  if (!stream_) return out;
  out.bytes_per_s = stream_->sender.bytes_per_s(clock_.now());
  out.loss = stream_->sender.transmissions().loss();
  return out;
}

}  // namespace foresight::link
