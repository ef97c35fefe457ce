#pragma once

#include <cstdint>
#include <cstring>
#include <span>
#include <string>

#include "idl/cdr.hpp"

/// Several samples in one input: a byte that says of what kind, two for the length, then the CDR bytes.
namespace collided::fuzz {

/// Calls see(kind, bytes) with each; one that breaks off is cut.
template <class See>
void for_each_frame(std::span<const std::byte> input, See&& see) {
  while (input.size() >= 3) {
    std::uint16_t length = 0;
    std::memcpy(&length, input.data() + 1, sizeof length);
    const std::span<const std::byte> bytes = input.subspan(3).first(std::min<std::size_t>(length, input.size() - 3));
    see(static_cast<std::uint8_t>(input[0]), bytes);
    input = input.subspan(3 + bytes.size());
  }
}

template <class T>
void append_frame(std::string& input, std::uint8_t kind, const T& sample) {
  const std::size_t size = wire::cdr_size(sample);
  const auto length = static_cast<std::uint16_t>(size);
  input += static_cast<char>(kind);
  input.append(reinterpret_cast<const char*>(&length), sizeof length);
  input.resize(input.size() + size);
  wire::write_cdr(sample, std::as_writable_bytes(std::span(input)).last(size));
}

}  // namespace collided::fuzz
