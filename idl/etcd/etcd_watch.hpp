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

/// The keys to watch, and the callbacks, which run on the watching thread.
struct StoreWatch {
  std::string key;
  bool is_prefix = false;  // every key that begins with it
  std::int64_t from = 1;   // the first revision to report
  std::function<void(const StoreChange&)> changed = {};
  std::function<bool()> is_over = {};  // asked ten times a second
  /// Gets why changes cannot be read, when that begins or is another reason, and an empty text when they are read again.
  std::function<void(const std::string&)> problem = {};
};

enum class WatchEnd : std::uint8_t {
  over,       // is_over() returned true
  read_again  // revisions that were asked for are compacted away: read the keys, and watch from there
};

/// Calls for every change to the keys, once each and in the order of their revisions, until it is over. If a member
/// falls silent, the next one continues after the last reported revision.
///
/// patience_ns  for a member to begin
/// returns      within a fifth of a second of is_over()
/// delay        a change comes at once; where the member is cut off or frozen, within kWatchLifeNs and the patience
/// throws       ModuleMissing
/// threads      any; each call has a connection of its own
WatchEnd watch(const EtcdAddress& address, std::int64_t patience_ns, StoreWatch asked);

/// Lifetime of one stream. A frozen member looks like one without changes, so the watch reconnects.
inline constexpr std::int64_t kWatchLifeNs = 5'000'000'000;

}  // namespace collided::etcd
