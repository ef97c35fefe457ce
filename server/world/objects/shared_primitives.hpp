#pragma once

#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "server/geometry/shapes.hpp"

namespace collided::engine {

/// The primitives of an object, which objects of one shape share: a copy takes no memory.
/// threads  as std::shared_ptr: any may read, and copy its own
class SharedPrimitives {
 public:
  SharedPrimitives() = default;
  SharedPrimitives(std::initializer_list<Primitive> list) : SharedPrimitives(std::span(list.begin(), list.size())) {}
  explicit SharedPrimitives(std::span<const Primitive> list);

  const Primitive* begin() const { return list_.get(); }
  const Primitive* end() const { return list_.get() + count_; }
  const Primitive* data() const { return list_.get(); }
  std::size_t size() const { return count_; }
  bool empty() const { return count_ == 0; }
  const Primitive& front() const { return list_[0]; }
  const Primitive& operator[](std::size_t number) const { return list_[static_cast<std::ptrdiff_t>(number)]; }
  std::vector<Primitive> copy() const { return {begin(), end()}; }
  bool shares(const SharedPrimitives& other) const { return list_ == other.list_; }

 private:
  std::shared_ptr<const Primitive[]> list_;
  std::uint32_t count_ = 0;
};

/// Finds the list among those that were made of late, so that a crowd of equal objects has one. Lists of more than
/// kMost primitives are not remembered: they have memory of their own to speak of.
///
/// memory   at most kRemembered lists
/// threads  one
class RecentPrimitives {
 public:
  static constexpr std::size_t kMost = 8;
  static constexpr std::size_t kRemembered = 256;

  /// Equal bit for bit; hulls by their meshes' identity.
  SharedPrimitives shared(std::span<const Primitive> list);

 private:
  std::vector<SharedPrimitives> lists_;  // by a hash; empty until it is used
};

}  // namespace collided::engine
