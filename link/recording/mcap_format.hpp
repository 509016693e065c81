// What MCAP's writer and reader have in common (https://mcap.dev/spec, version 0). Private to link/recording.
//
//   magic | Header | attachments, metadata, chunks with their indices ... | DataEnd | summary | Footer | magic
//
// Each record: one byte says what it is, eight how long it is. All numbers are little-endian.
#pragma once

#include <array>
#include <cstdint>

namespace foresight::link::mcap {

inline constexpr std::array<std::uint8_t, 8> kMagic{0x89, 'M', 'C', 'A', 'P', '0', '\r', '\n'};
inline constexpr std::size_t kRecordHead = 9;  ///< bytes before a record's content

enum Opcode : std::uint8_t {
  kHeader = 0x01,
  kFooter = 0x02,
  kSchema = 0x03,
  kChannel = 0x04,
  kMessage = 0x05,
  kChunk = 0x06,
  kMessageIndex = 0x07,
  kChunkIndex = 0x08,
  kAttachment = 0x09,
  kAttachmentIndex = 0x0A,
  kStatistics = 0x0B,
  kMetadata = 0x0C,
  kMetadataIndex = 0x0D,
  kSummaryOffset = 0x0E,
  kDataEnd = 0x0F,
};

}  // namespace foresight::link::mcap
