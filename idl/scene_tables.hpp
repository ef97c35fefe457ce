#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <type_traits>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "idl/scene_generated.h"

// Functions of server and client for reading and writing tables of idl/scene.fbs and of the schemas that include it.
namespace collided::format {

static_assert(std::endian::native == std::endian::little, "numbers are copied as they lie in memory");

/// The most that FlatBuffers can address: its offsets have 31 bits.
inline constexpr std::uint64_t kMaxBufferBytes = (std::uint64_t{1} << 31) - 1;

/// Bytes aligned for doubles: the given ones if they are aligned, else a copy.
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

/// The root table of an untrusted buffer if its structure is valid, else null. Numbers may have any value.
///
/// identifier  four letters required in the buffer; null: none
template <class Table>
const Table* verified(const std::uint8_t* data, std::size_t byte_count, const char* identifier) {
  constexpr std::uint32_t kMostDepth = 5;  // a valid buffer has scene, object, shape, mesh
  if (byte_count > kMaxBufferBytes) return nullptr;
  // A table takes at least 8 bytes, so a larger number of tables must share bytes, and verifying them could take
  // forever.
  flatbuffers::Verifier verifier(data, byte_count, kMostDepth, static_cast<std::uint32_t>(byte_count / 8 + 1));
  return verifier.VerifyBuffer<Table>(identifier) ? flatbuffers::GetRoot<Table>(data) : nullptr;
}

/// The elements of a vector as values of one or more elements each, such as points of three numbers. They are copied,
/// since the verifier does not guarantee that 8-byte numbers are aligned. Elements that do not fill a value are
/// dropped.
template <class Value, class Element>
std::vector<Value> copied(const flatbuffers::Vector<Element>* from) {
  static_assert(sizeof(Value) % sizeof(std::remove_pointer_t<Element>) == 0);
  std::vector<Value> values(from == nullptr ? 0
                                            : from->size() * sizeof(std::remove_pointer_t<Element>) / sizeof(Value));
  if (!values.empty()) std::memcpy(static_cast<void*>(values.data()), from->Data(), values.size() * sizeof(Value));
  return values;
}

/// Packs the numbers of values into a vector.
template <class Number, class Value>
flatbuffers::Offset<flatbuffers::Vector<Number>> write_numbers(flatbuffers::FlatBufferBuilder& builder,
                                                               const std::vector<Value>& values) {
  static_assert(sizeof(Value) % sizeof(Number) == 0);
  Number* numbers = nullptr;
  const auto vector = builder.CreateUninitializedVector(values.size() * sizeof(Value) / sizeof(Number), &numbers);
  if (!values.empty()) std::memcpy(numbers, values.data(), values.size() * sizeof(Value));
  return vector;
}

/// Values as structs of the schema.
inline Vec3 packed(const Eigen::Vector3d& v) { return {v.x(), v.y(), v.z()}; }
inline Quat packed(const Eigen::Quaterniond& q) { return {q.w(), q.x(), q.y(), q.z()}; }
inline Mat3 packed(const Eigen::Matrix3d& m) {
  return {packed(Eigen::Vector3d(m.col(0))), packed(Eigen::Vector3d(m.col(1))), packed(Eigen::Vector3d(m.col(2)))};
}

}  // namespace collided::format
