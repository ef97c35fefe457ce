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

/// The primitives of an object, shared between objects of one shape: a copy takes no memory.
/// threads  as std::shared_ptr: any may read, and copy its own instance
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

/// Finds the list among recently made ones, so that equal objects share one. Lists of more than kMost primitives are
/// not remembered: keeping them would take memory.
///
/// memory   at most kRemembered lists
/// threads  one
class RecentPrimitives {
 public:
  static constexpr std::size_t kMost = 8;
  static constexpr std::size_t kRemembered = 256;

  /// Compares bit for bit; hulls by the identity of their meshes.
  SharedPrimitives shared(std::span<const Primitive> list);

 private:
  std::vector<SharedPrimitives> lists_;  // by a hash; allocated on first use
};

}  // namespace collided::engine
