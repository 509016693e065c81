// Messages as bytes: OMG's Common Data Representation (CORBA 3.0, chapter 15.3; RTPS 2.2, chapter 10), plain, version
// 1, as ROS 2 writes it.
//
//   00 01 00 00 | fields one after the other, each number aligned to its own size, counted from behind these four bytes
//   CDR, little-endian (00 00: big-endian); a string has its length, its text and a 0; a sequence its count
//
// These bytes are what goes over DDS, what a simulated line carries and what a recording holds.
#pragma once

#include <bit>
#include <concepts>
#include <cstring>
#include <optional>
#include <span>
#include <variant>

#include "common/time.hpp"
#include "link/messages/foresight_messages.hpp"

namespace foresight::link {

using Bytes = std::vector<std::uint8_t>;

namespace detail {

struct AnyVisitor {
  AnyVisitor& operator()(const char*, auto&) { return *this; }
};
template <typename T>
concept NamesFields = requires(T& message, AnyVisitor visitor) {
  T::visit(message, visitor);
};
template <typename T>
concept HasFieldsNamed = requires(T& message, AnyVisitor visitor) {
  visit_fields(message, visitor);
};
/// Its fields are named by itself, or by a function beside it.
template <typename T>
concept Message = NamesFields<T> || HasFieldsNamed<T>;

template <typename T, typename V>
void visit(T& message, V& visitor) {
  if constexpr (NamesFields<std::remove_const_t<T>>)
    T::visit(message, visitor);
  else
    visit_fields(message, visitor);
}
template <typename T>
concept Number = std::is_arithmetic_v<T>;

template <typename T>
T swapped(T value) {
  auto bytes = std::bit_cast<std::array<std::uint8_t, sizeof(T)>>(value);
  for (std::size_t i = 0; i < sizeof(T) / 2; ++i) std::swap(bytes[i], bytes[sizeof(T) - 1 - i]);
  return std::bit_cast<T>(bytes);
}

}  // namespace detail

/// Fills `out`, whose memory is used again.
class CdrWriter {
 public:
  explicit CdrWriter(Bytes& out) : out_(out) {
    static_assert(std::endian::native == std::endian::little);
    out_.assign({0, 1, 0, 0});
  }

  template <typename T>
  CdrWriter& operator()(const char*, const T& value) {
    put(value);
    return *this;
  }

 private:
  static constexpr std::size_t kHead = 4;

  template <detail::Number T>
  void put(T value) {
    out_.resize(kHead + (out_.size() - kHead + sizeof(T) - 1) / sizeof(T) * sizeof(T));
    append(&value, sizeof(T));
  }
  void put(const std::string& text) {
    put(static_cast<std::uint32_t>(text.size() + 1));
    append(text.c_str(), text.size() + 1);
  }
  template <typename T, std::size_t N>
  void put(const std::array<T, N>& values) {
    for (const T& value : values) put(value);
  }
  template <typename T>
  void put(const std::vector<T>& values) {
    put(static_cast<std::uint32_t>(values.size()));
    if constexpr (sizeof(T) == 1 && detail::Number<T>)
      append(values.data(), values.size());
    else
      for (const T& value : values) put(value);
  }
  template <detail::Message T>
  void put(const T& message) {
    detail::visit(message, *this);
  }
  // As numbers: of an enumeration its value, of instants and durations nanoseconds.
  template <typename E>
  requires std::is_enum_v<E>
  void put(E value) { put(static_cast<std::underlying_type_t<E>>(value)); }
  void put(Duration duration) { put(std::int64_t{duration.count()}); }
  template <typename Clock>
  void put(Time<Clock> time) {
    put(time.ns);
  }
  // IDL's union: which one, then that one.
  template <typename... T>
  void put(const std::variant<T...>& one) {
    put(static_cast<std::int32_t>(one.index()));
    std::visit([this](const auto& of) { put(of); }, one);
  }
  void append(const void* data, std::size_t size) {
    const auto* const bytes = static_cast<const std::uint8_t*>(data);
    out_.insert(out_.end(), bytes, bytes + size);
  }

  Bytes& out_;
};

/// Reads bytes that anybody may have sent: never beyond their end, and never makes room for more than they could hold.
/// Once something is wrong, ok() is false and everything that follows is left as it was.
class CdrReader {
 public:
  explicit CdrReader(std::span<const std::uint8_t> cdr) : bytes_(cdr) {
    ok_ = cdr.size() >= kHead && cdr[0] == 0 && cdr[1] <= 1;
    if (!ok_) return;
    swap_ = cdr[1] == 0;
    bytes_ = cdr.subspan(kHead);
  }

  template <typename T>
  CdrReader& operator()(const char*, T& value) {
    take(value);
    return *this;
  }

  bool ok() const { return ok_; }
  /// All was read, but for what pads to four bytes.
  bool at_end() const { return ok_ && bytes_.size() - at_ < kHead; }

 private:
  static constexpr std::size_t kHead = 4;

  void fail() { ok_ = false; }
  std::size_t left() const { return bytes_.size() - at_; }

  template <detail::Number T>
  void take(T& value) {
    const std::size_t begin = (at_ + sizeof(T) - 1) / sizeof(T) * sizeof(T);
    if (!ok_ || begin > bytes_.size() || bytes_.size() - begin < sizeof(T)) return fail();
    at_ = begin + sizeof(T);
    if constexpr (std::same_as<T, bool>) {
      if (bytes_[begin] > 1) return fail();
      value = bytes_[begin] == 1;
    } else {
      std::memcpy(&value, bytes_.data() + begin, sizeof(T));
      if (swap_) value = detail::swapped(value);
    }
  }
  void take(std::string& text) {
    std::uint32_t size = 0;
    take(size);
    if (!ok_ || size > left()) return fail();
    const auto* const begin = reinterpret_cast<const char*>(bytes_.data() + at_);
    at_ += size;
    if (size == 0) return text.clear();  // some write an empty one without its 0
    if (std::memchr(begin, 0, size) != begin + size - 1) return fail();
    text.assign(begin, size - 1);
  }
  template <typename T, std::size_t N>
  void take(std::array<T, N>& values) {
    for (T& value : values) take(value);
  }
  template <typename T>
  void take(std::vector<T>& values) {
    std::uint32_t count = 0;
    take(count);
    if (!ok_ || count > left() / least_size<T>()) return fail();
    if constexpr (sizeof(T) == 1 && detail::Number<T>) {
      values.assign(bytes_.begin() + static_cast<std::ptrdiff_t>(at_),
                    bytes_.begin() + static_cast<std::ptrdiff_t>(at_ + count));
      at_ += count;
    } else {
      values.clear();
      if constexpr (detail::Number<T>) values.reserve(count);
      // One after the other: a count that lies makes no room for what is not there.
      for (; ok_ && count > 0; --count) take(values.emplace_back());
    }
  }
  template <detail::Message T>
  void take(T& message) {
    detail::visit(message, *this);
  }
  template <typename E>
  requires std::is_enum_v<E>
  void take(E& value) {  // it may be none of its names: whoever uses it looks
    std::underlying_type_t<E> number{};
    take(number);
    value = static_cast<E>(number);
  }
  void take(Duration& duration) {
    std::int64_t ns = 0;
    take(ns);
    duration = Duration{ns};
  }
  template <typename Clock>
  void take(Time<Clock>& time) {
    take(time.ns);
  }
  template <typename... T>
  void take(std::variant<T...>& one) {
    std::int32_t index = 0;
    take(index);
    take_one<0>(index, one);
  }
  template <std::size_t I, typename... T>
  void take_one(std::int32_t index, std::variant<T...>& one) {
    if constexpr (I < sizeof...(T)) {
      if (index == static_cast<std::int32_t>(I)) return take(one.template emplace<I>());
      take_one<I + 1>(index, one);
    } else {
      fail();
    }
  }

  // Bytes that one of a sequence has at least.
  template <typename T>
  static constexpr std::size_t least_size() {
    if constexpr (detail::Number<T>) return sizeof(T);
    return 4;  // a string's or sequence's count; messages have more
  }

  std::span<const std::uint8_t> bytes_;
  std::size_t at_ = 0;
  bool swap_ = false, ok_ = true;
};

template <detail::Message T>
void to_cdr(const T& message, Bytes& out) {
  CdrWriter writer(out);
  detail::visit(message, writer);
}
template <detail::Message T>
Bytes to_cdr(const T& message) {
  Bytes out;
  to_cdr(message, out);
  return out;
}

/// Nothing where the bytes are not one whole message of that type.
template <detail::Message T>
std::optional<T> from_cdr(std::span<const std::uint8_t> cdr) {
  std::optional<T> out(std::in_place);
  CdrReader reader(cdr);
  detail::visit(*out, reader);
  if (!reader.at_end()) out.reset();
  return out;
}

}  // namespace foresight::link
