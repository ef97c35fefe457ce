#include "client/library/connection/names.hpp"

#include <algorithm>
#include <vector>

#include "idl/standing_ids.hpp"
#include "idl/topics.hpp"

namespace collided::client {

/// The slot; an additional bit marks a fence's.
std::uint64_t Names::slot_of(std::uint64_t id) {
  return static_cast<std::uint32_t>(id) | (wire_contract::is_standing_id(id) ? std::uint64_t{1} << 32 : 0);
}

void Names::learn(std::span<const std::uint64_t> ids, std::span<const std::uint8_t> packed) {
  if (ids.empty()) { return; }
  const std::vector<std::string_view> names = wire_contract::unpack_names(packed);
  const std::lock_guard lock(mutex_);
  for (std::size_t i = 0; i < std::min(ids.size(), names.size()); ++i) {
    Entry& entry = by_slot_[slot_of(ids[i])];
    if (entry.id != ids[i] || entry.name != names[i]) { entry = {ids[i], std::string(names[i])}; }
  }
}

std::string Names::name(std::uint64_t id) const {
  const std::lock_guard lock(mutex_);
  const auto found = by_slot_.find(slot_of(id));
  return found != by_slot_.end() && found->second.id == id ? found->second.name : '#' + std::to_string(id);
}

}  // namespace collided::client
