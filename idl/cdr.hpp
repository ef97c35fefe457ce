#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "idl/dds.hpp"

/// Wire samples as bytes: a header of four bytes, then plain CDR, little-endian (OMG, "DDS for Extensible and Dynamic
/// Topic Types" 1.3, 7.4: XCDR version 1, final types). It serves files and memory; DDS has its own serialization. It
/// handles every wire type of dds.hpp; only read_cdr() allocates.
namespace collided::wire {

/// Number of bytes that write_cdr() fills.
template <class T>
std::size_t cdr_size(const T& sample);

/// Writes a sample.
///
/// out  exactly cdr_size(sample) bytes
template <class T>
void write_cdr(const T& sample, std::span<std::byte> out);

/// Returns a sample as a vector of bytes.
template <class T>
std::vector<std::byte> cdr_bytes(const T& sample) {
  std::vector<std::byte> bytes(cdr_size(sample));
  write_cdr(sample, bytes);
  return bytes;
}

/// Reads a sample from bytes of unknown origin. Returns false if they are not such a sample: a length beyond the end, a
/// text without its zero or longer than its field, a bool that is neither 0 nor 1, big-endian, or excess bytes. The
/// sample then holds parts of it. Allocates no more memory than the bytes have.
template <class T>
[[nodiscard]] bool read_cdr(std::span<const std::byte> bytes, dds::Sample<T>& sample);

}  // namespace collided::wire
