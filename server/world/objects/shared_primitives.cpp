#include "server/world/objects/shared_primitives.hpp"

#include <algorithm>
#include <cstring>
#include <functional>
#include <string_view>
#include <type_traits>
#include <variant>

namespace collided::engine {
namespace {

/// Every shape but the hull consists of doubles only, without padding.
template <class Shape>
std::string_view bytes_of(const Shape& shape) {
  static_assert(sizeof(Shape) % sizeof(double) == 0);
  return {reinterpret_cast<const char*>(&shape), sizeof(Shape)};
}

bool is_same_shape(const Hull& a, const Hull& b) {
  return a.mesh == b.mesh && bytes_of(a.rotation) == bytes_of(b.rotation) &&
         bytes_of(a.position) == bytes_of(b.position);
}
template <class Shape>
bool is_same_shape(const Shape& a, const Shape& b) {
  return bytes_of(a) == bytes_of(b);
}

bool is_same(const Primitive& a, const Primitive& b) {
  if (a.index() != b.index()) return false;
  return std::visit([&](const auto& one) { return is_same_shape(one, std::get<std::decay_t<decltype(one)>>(b)); }, a);
}

std::size_t hash_of(const Hull& hull) { return std::hash<const void*>{}(hull.mesh.get()); }
template <class Shape>
std::size_t hash_of(const Shape& shape) {
  return std::hash<std::string_view>{}(bytes_of(shape));
}

std::size_t hash_of_all(std::span<const Primitive> list) {
  std::size_t hash = list.size();
  for (const Primitive& primitive : list)
    hash = 31 * hash + std::visit([](const auto& one) { return hash_of(one); }, primitive);
  return hash;
}

}  // namespace

SharedPrimitives::SharedPrimitives(std::span<const Primitive> list) : count_(static_cast<std::uint32_t>(list.size())) {
  if (list.empty()) return;
  const auto made = std::make_shared<Primitive[]>(list.size());
  std::copy(list.begin(), list.end(), made.get());
  list_ = made;
}

SharedPrimitives RecentPrimitives::shared(std::span<const Primitive> list) {
  if (list.empty() || list.size() > kMost) return SharedPrimitives(list);
  if (lists_.empty()) lists_.resize(kRemembered);
  SharedPrimitives& known = lists_[hash_of_all(list) % kRemembered];
  if (!std::equal(known.begin(), known.end(), list.begin(), list.end(), is_same)) known = SharedPrimitives(list);
  return known;
}

}  // namespace collided::engine
