#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <vector>

#include <flatbuffers/flatbuffers.h>

// The first look at a FlatBuffers buffer from anyone: whether it can be read at all.
namespace collided::engine {

/// FlatBuffers cannot address more: its offsets have 31 bits.
inline constexpr std::uint64_t kMaxBufferBytes = (std::uint64_t{1} << 31) - 1;

/// Bytes at an address aligned for doubles: the given ones if they are, else a copy.
class AlignedBytes {
 public:
  explicit AlignedBytes(std::span<const std::byte> bytes) : data_(reinterpret_cast<const std::uint8_t*>(bytes.data())) {
    if (reinterpret_cast<std::uintptr_t>(bytes.data()) % alignof(double) != 0) {
      copy_.resize(bytes.size() / sizeof(std::uint64_t) + 1);
      std::memcpy(copy_.data(), bytes.data(), bytes.size());
      data_ = reinterpret_cast<const std::uint8_t*>(copy_.data());
    }
  }
  const std::uint8_t* data() const { return data_; }

 private:
  std::vector<std::uint64_t> copy_;
  const std::uint8_t* data_;
};

/// The root table of a buffer if its structure is valid, else null. Nothing is said of what its numbers mean.
///
/// identifier  four letters that the buffer must have; null: none
template <class Table>
const Table* verified(const std::uint8_t* data, std::size_t byte_count, const char* identifier) {
  constexpr std::uint32_t kMostDepth = 5;  // a proper buffer has scene, object, shape, mesh
  if (byte_count > kMaxBufferBytes) return nullptr;
  // A table takes at least 8 bytes, so more tables than that must share bytes, and verifying them could take for ever.
  flatbuffers::Verifier verifier(data, byte_count, kMostDepth, static_cast<std::uint32_t>(byte_count / 8 + 1));
  return verifier.VerifyBuffer<Table>(identifier) ? flatbuffers::GetRoot<Table>(data) : nullptr;
}

}  // namespace collided::engine
