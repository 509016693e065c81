#include "sim/drives/sdo_server.hpp"

#include <algorithm>

#include "sim/drives/object_dictionary.hpp"

namespace foresight::sim {
namespace {

constexpr Duration kPatience = std::chrono::seconds(1);
constexpr std::size_t kLargestValue = 4096;

std::uint32_t key_of(std::span<const std::uint8_t> request) {
  return object_key(static_cast<unsigned>(request[1] | request[2] << 8), request[3]);
}

std::array<std::uint8_t, 8> headed(std::uint8_t command, std::uint32_t key) {
  return {command, static_cast<std::uint8_t>(key >> 8), static_cast<std::uint8_t>(key >> 16),
          static_cast<std::uint8_t>(key)};
}

}  // namespace

SdoServer::Answer SdoServer::abort(std::uint32_t key, SdoAbort code) {
  phase_ = Phase::idle;
  Answer out = headed(0x80, key);
  encode_integer(static_cast<std::int64_t>(code), std::span(out).subspan(4));
  return out;
}

SdoServer::Answer SdoServer::initiate_download(std::span<const std::uint8_t> request) {
  const bool expedited = request[0] & 2, sized = request[0] & 1;
  key_ = key_of(request);
  if (expedited) {
    const std::size_t size = sized ? 4u - (request[0] >> 2 & 3u) : 4u;
    const Bytes value(request.begin() + 4, request.begin() + 4 + static_cast<std::ptrdiff_t>(size));
    phase_ = Phase::idle;
    const SdoAbort code = access_.write(key_, value, sized);
    return code == SdoAbort::none ? headed(0x60, key_) : abort(key_, code);
  }
  announced_ = sized ? static_cast<std::size_t>(decode_integer(request.subspan(4, 4), false)) : 0;
  if (announced_ > kLargestValue) return abort(key_, SdoAbort::out_of_memory);
  phase_ = Phase::download;
  value_.clear();
  toggle_ = false;
  return headed(0x60, key_);
}

SdoServer::Answer SdoServer::download_segment(std::span<const std::uint8_t> request) {
  if (phase_ != Phase::download) return abort(0, SdoAbort::unknown_command);
  if (((request[0] & 0x10) != 0) != toggle_) return abort(key_, SdoAbort::toggle_bit);
  const std::size_t size = 7u - (request[0] >> 1 & 7u);
  value_.insert(value_.end(), request.begin() + 1, request.begin() + 1 + static_cast<std::ptrdiff_t>(size));
  if (value_.size() > kLargestValue) return abort(key_, SdoAbort::out_of_memory);
  Answer out{static_cast<std::uint8_t>(0x20 | (toggle_ ? 0x10 : 0))};
  toggle_ = !toggle_;
  if ((request[0] & 1) == 0) return out;
  phase_ = Phase::idle;
  if (announced_ != 0 && announced_ != value_.size()) return abort(key_, SdoAbort::wrong_length);
  const SdoAbort code = access_.write(key_, value_, true);
  return code == SdoAbort::none ? out : abort(key_, code);
}

SdoServer::Answer SdoServer::initiate_upload(std::span<const std::uint8_t> request) {
  key_ = key_of(request);
  phase_ = Phase::idle;
  value_.clear();
  if (const SdoAbort code = access_.read(key_, value_); code != SdoAbort::none) return abort(key_, code);
  if (!value_.empty() && value_.size() <= 4) {
    Answer out = headed(static_cast<std::uint8_t>(0x43 | (4 - value_.size()) << 2), key_);
    std::copy(value_.begin(), value_.end(), out.begin() + 4);
    return out;
  }
  phase_ = Phase::upload;
  sent_ = 0;
  toggle_ = false;
  Answer out = headed(0x41, key_);
  encode_integer(static_cast<std::int64_t>(value_.size()), std::span(out).subspan(4));
  return out;
}

SdoServer::Answer SdoServer::upload_segment(std::span<const std::uint8_t> request) {
  if (phase_ != Phase::upload) return abort(0, SdoAbort::unknown_command);
  if (((request[0] & 0x10) != 0) != toggle_) return abort(key_, SdoAbort::toggle_bit);
  const std::size_t size = std::min<std::size_t>(7, value_.size() - sent_);
  const bool last = sent_ + size == value_.size();
  Answer out{static_cast<std::uint8_t>((toggle_ ? 0x10 : 0) | (7 - size) << 1 | (last ? 1 : 0))};
  std::copy_n(value_.begin() + static_cast<std::ptrdiff_t>(sent_), size, out.begin() + 1);
  sent_ += size;
  toggle_ = !toggle_;
  if (last) phase_ = Phase::idle;
  return out;
}

std::optional<std::array<std::uint8_t, 8>> SdoServer::answer(std::span<const std::uint8_t> request, RobotTime now) {
  if (request.size() != 8) return std::nullopt;
  last_ = now;
  switch (request[0] >> 5) {
    case 0: return download_segment(request);
    case 1: return initiate_download(request);
    case 2: return initiate_upload(request);
    case 3: return upload_segment(request);
    case 4: phase_ = Phase::idle; return std::nullopt;
    default: return abort(key_of(request), SdoAbort::unknown_command);
  }
}

std::optional<std::array<std::uint8_t, 8>> SdoServer::expire(RobotTime now) {
  if (phase_ == Phase::idle || now - last_ < kPatience) return std::nullopt;
  return abort(key_, SdoAbort::timed_out);
}

}  // namespace foresight::sim
