#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

/// Many fences in the bytes of one command `fence`. Each has the length of its arguments (4 bytes, little-endian), the
/// arguments as JSON, the length of its shape, and the shape.
namespace collided::wire_contract {

/// A fence in such bytes, which must outlive this view.
struct PackedFence {
  std::string_view arguments;
  std::span<const std::byte> shape;
};

/// Appends a fence.
inline void pack_fence(std::vector<std::uint8_t>& bytes, std::string_view arguments,
                       std::span<const std::uint8_t> shape) {
  const auto append = [&](std::span<const std::uint8_t> item) {
    for (int shift = 0; shift < 32; shift += 8) bytes.push_back(static_cast<std::uint8_t>(item.size() >> shift));
    bytes.insert(bytes.end(), item.begin(), item.end());
  };
  append({reinterpret_cast<const std::uint8_t*>(arguments.data()), arguments.size()});
  append(shape);
}

/// Reads fences from bytes of unknown origin; nothing if the bytes end within one.
inline std::optional<std::vector<PackedFence>> unpack_fences(std::span<const std::byte> bytes) {
  constexpr std::size_t kLengthBytes = 4;
  std::vector<PackedFence> fences;
  bool is_whole = true;
  const auto take = [&]() -> std::span<const std::byte> {
    is_whole = is_whole && bytes.size() >= kLengthBytes;
    std::size_t size = 0;
    for (std::size_t i = 0; is_whole && i < kLengthBytes; ++i)
      size |= std::to_integer<std::size_t>(bytes[i]) << (8 * i);
    is_whole = is_whole && bytes.size() - kLengthBytes >= size;
    if (!is_whole) return {};
    const std::span<const std::byte> taken = bytes.subspan(kLengthBytes, size);
    bytes = bytes.subspan(kLengthBytes + size);
    return taken;
  };
  while (!bytes.empty()) {
    const std::span<const std::byte> arguments = take();
    const std::span<const std::byte> shape = take();
    if (!is_whole) return std::nullopt;
    fences.push_back({{reinterpret_cast<const char*>(arguments.data()), arguments.size()}, shape});
  }
  return fences;
}

}  // namespace collided::wire_contract
