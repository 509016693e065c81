#include "link/dds/raw_type.hpp"

#include <dds/ddsi/q_radmin.h>

#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <memory>

namespace foresight::link {
namespace {

constexpr std::size_t kHead = 4;  // of a sample: how it is encoded

struct RawSample : ddsi_serdata {
  RawSample(const ddsi_sertype* of, ddsi_serdata_kind kind_of, std::vector<std::uint8_t> cdr)
      : ddsi_serdata{}, bytes(std::move(cdr)), size(bytes.size()) {
    ddsi_serdata_init(this, of, kind_of);
    hash = of->serdata_basehash;                        // without keys, all samples are of one instance
    bytes.resize((std::max(size, kHead) + 3) / 4 * 4);  // Cyclone reads whole words
    size = std::max(size, kHead);
  }
  std::vector<std::uint8_t> bytes;
  std::size_t size;  // without what pads to a word
};

const RawSample& raw(const ddsi_serdata* sample) {
  return *static_cast<const RawSample*>(sample);
}

ddsi_serdata* new_key(const ddsi_sertype* type) {
  return new RawSample(type, SDK_KEY, {0, 1, 0, 0});
}

/// Puts fragments together, which may overlap; nothing where one is missing.
ddsi_serdata* from_fragments(const ddsi_sertype* type, ddsi_serdata_kind kind, const nn_rdata* fragment,
                             std::size_t size) {
  std::vector<std::uint8_t> bytes;
  bytes.reserve(size);
  for (; fragment && bytes.size() < size; fragment = fragment->nextfrag) {
    const std::size_t at = bytes.size();
    if (fragment->min > at) return nullptr;
    if (fragment->maxp1 <= at) continue;
    const unsigned char* const payload = NN_RMSG_PAYLOADOFF(fragment->rmsg, NN_RDATA_PAYLOAD_OFF(fragment));
    const std::size_t end = std::min<std::size_t>(fragment->maxp1, size);
    bytes.insert(bytes.end(), payload + (at - fragment->min), payload + (end - fragment->min));
  }
  return bytes.size() == size ? new RawSample(type, kind, std::move(bytes)) : nullptr;
}

ddsi_serdata* from_parts(const ddsi_sertype* type, ddsi_serdata_kind kind, ddsrt_msg_iovlen_t count,
                         const ddsrt_iovec_t* parts, std::size_t size) {
  std::vector<std::uint8_t> bytes;
  for (std::size_t i = 0; i < static_cast<std::size_t>(count) && bytes.size() < size; ++i) {
    const auto* const begin = static_cast<const std::uint8_t*>(parts[i].iov_base);
    bytes.insert(bytes.end(), begin, begin + std::min<std::size_t>(parts[i].iov_len, size - bytes.size()));
  }
  return bytes.size() == size ? new RawSample(type, kind, std::move(bytes)) : nullptr;
}

const ddsi_serdata_ops& sample_operations() {
  static const ddsi_serdata_ops operations = [] {
    ddsi_serdata_ops ops{};
    ops.eqkey = [](const ddsi_serdata*, const ddsi_serdata*) { return true; };
    ops.get_size = [](const ddsi_serdata* d) { return static_cast<std::uint32_t>(raw(d).size); };
    ops.from_ser = from_fragments;
    ops.from_ser_iov = from_parts;
    ops.from_keyhash = [](const ddsi_sertype* type, const ddsi_keyhash*) { return new_key(type); };
    // Only samples that are bytes already are written; a key, of which there is none, goes with a writer that ends.
    ops.from_sample = [](const ddsi_sertype* type, ddsi_serdata_kind kind, const void*) -> ddsi_serdata* {
      return kind == SDK_KEY ? new_key(type) : nullptr;
    };
    ops.to_ser = [](const ddsi_serdata* d, std::size_t at, std::size_t size, void* out) {
      std::memcpy(out, raw(d).bytes.data() + at, size);
    };
    ops.to_ser_ref = [](const ddsi_serdata* d, std::size_t at, std::size_t size, ddsrt_iovec_t* out) {
      out->iov_base = const_cast<std::uint8_t*>(raw(d).bytes.data()) + at;
      out->iov_len = static_cast<ddsrt_iov_len_t>(size);
      return ddsi_serdata_ref(d);
    };
    ops.to_ser_unref = [](ddsi_serdata* d, const ddsrt_iovec_t*) { ddsi_serdata_unref(d); };
    ops.to_sample = [](const ddsi_serdata*, void*, void**, void*) { return false; };
    ops.to_untyped = [](const ddsi_serdata* d) {
      ddsi_serdata* const key = new_key(d->type);
      key->type = nullptr;
      return key;
    };
    ops.untyped_to_sample = [](const ddsi_sertype*, const ddsi_serdata*, void*, void**, void*) { return true; };
    ops.free = [](ddsi_serdata* d) { delete static_cast<RawSample*>(d); };
    ops.print = [](const ddsi_sertype*, const ddsi_serdata*, char* out, std::size_t) -> std::size_t {
      out[0] = 0;
      return 0;
    };
    ops.get_keyhash = [](const ddsi_serdata*, ddsi_keyhash* out, bool) { std::memset(out, 0, sizeof *out); };
    return ops;
  }();
  return operations;
}

const ddsi_sertype_ops& type_operations() {
  static const ddsi_sertype_ops operations = [] {
    ddsi_sertype_ops ops{};
    ops.version = ddsi_sertype_v0;
    ops.free = [](ddsi_sertype* type) {
      ddsi_sertype_fini(type);
      delete type;
    };
    // Nobody reads C structs of such a type: there are none to be made, cleared or given back.
    ops.zero_samples = [](const ddsi_sertype*, void*, std::size_t) {};
    ops.realloc_samples = [](void** out, const ddsi_sertype*, void*, std::size_t, std::size_t count) {
      std::fill_n(out, count, nullptr);
    };
    ops.free_samples = [](const ddsi_sertype*, void**, std::size_t, dds_free_op_t) {};
    ops.equal = [](const ddsi_sertype*, const ddsi_sertype*) { return true; };  // beside their names
    ops.hash = [](const ddsi_sertype*) { return std::uint32_t{0}; };
    return ops;
  }();
  return operations;
}

}  // namespace

ddsi_sertype* new_raw_type(const std::string& type_name) {
  auto type = std::make_unique<ddsi_sertype>();
  ddsi_sertype_init(type.get(), type_name.c_str(), &type_operations(), &sample_operations(), /*topickind_no_key=*/true);
  return type.release();
}

ddsi_serdata* new_raw_sample(const ddsi_sertype* type, std::vector<std::uint8_t> cdr) {
  return new RawSample(type, SDK_DATA, std::move(cdr));
}

std::span<const std::uint8_t> raw_bytes(const ddsi_serdata* sample) {
  return std::span(raw(sample).bytes).first(raw(sample).size);
}

}  // namespace foresight::link
