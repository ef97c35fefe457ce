#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>

#include "idl/etcd/etcd_address.hpp"
#include "idl/etcd/etcd_members.hpp"

namespace collided::etcd {

struct StoreChange {
  std::string key;
  std::optional<std::string> value;  // nothing: the key is gone
  std::int64_t revision = 0;
};

/// What is watched, and what is called for it, on the thread that watches.
struct StoreWatch {
  std::string key;
  bool is_prefix = false;  // every key that begins with it
  std::int64_t from = 1;   // the first revision whose changes are of interest
  std::function<void(const StoreChange&)> changed = {};
  std::function<bool()> is_over = {};  // asked ten times a second
  /// Gets why changes cannot be read, when that begins or is another reason, and an empty text when they are read again.
  std::function<void(const std::string&)> problem = {};
};

enum class WatchEnd : std::uint8_t {
  over,       // is_over() said so
  read_again  // revisions that were asked for are compacted away: read the keys, and watch from there
};

/// Calls for every change to the keys, once each and in the order of their revisions, until it is over. A member that falls
/// silent is left for another one, which goes on with the revision after the last that was told.
///
/// patience_ns  for a member to begin
/// returns      within a fifth of a second of is_over()
/// delay        a change comes at once; where the member is cut off or frozen, within kWatchLifeNs and the patience
/// throws       ModuleMissing
/// threads      any; each call has a connection of its own
WatchEnd watch(const EtcdAddress& address, std::int64_t patience_ns, StoreWatch asked);

/// So long one stream is read. A frozen member looks like one where nothing changes, so it is asked anew.
inline constexpr std::int64_t kWatchLifeNs = 5'000'000'000;

}  // namespace collided::etcd
