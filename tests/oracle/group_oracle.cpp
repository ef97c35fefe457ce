#include "tests/oracle/group_oracle.hpp"

#include <algorithm>
#include <limits>
#include <set>

#include "server/world/query/object_parts.hpp"

namespace collided::oracle {
namespace {

constexpr double kEndless = std::numeric_limits<double>::infinity();

PlainClearance plain_clearance(const std::vector<ConvexPart>& a, const std::vector<ConvexPart>& b) {
  PlainClearance found{.low_m = kEndless, .high_m = kEndless};
  double deepest_low_m = -kEndless;
  double deepest_high_m = -kEndless;
  for (const ConvexPart& of_a : a) {
    for (const ConvexPart& of_b : b) {
      if (overlaps(of_a, of_b).yes()) {
        const Contact contact = engine::contact(of_a, of_b);
        found.touches = true;
        deepest_low_m = std::max(deepest_low_m, contact.depth_m - contact.depth_error_m);
        deepest_high_m = std::max(deepest_high_m, contact.depth_m + contact.depth_error_m);
      } else if (!found.touches) {
        const Separation apart = separation(of_a, of_b);
        found.low_m = std::min(found.low_m, apart.distance_m - apart.error_m);
        found.high_m = std::min(found.high_m, apart.distance_m + apart.error_m);
      }
    }
  }
  if (found.touches) {
    found.low_m = -deepest_high_m;
    found.high_m = -deepest_low_m;
  }
  return found;
}

}  // namespace

std::vector<PlainClearance> plain_clearances(const Snapshot& snapshot, const std::vector<ObjectId>& from,
                                             const std::vector<ObjectId>& to, bool with_filtered) {
  std::map<ObjectId, std::vector<ConvexPart>> parts;
  for (const ObjectId id : from) parts[id] = parts_of_object(snapshot, id);
  for (const ObjectId id : to) parts[id] = parts_of_object(snapshot, id);
  std::vector<PlainClearance> found;
  std::set<std::pair<ObjectId, ObjectId>> seen;
  for (const ObjectId a : from) {
    for (const ObjectId b : to) {
      const ObjectInfo& info_a = *snapshot.objects[slot_of(a)];
      const ObjectInfo& info_b = *snapshot.objects[slot_of(b)];
      if (a == b || !seen.insert(std::minmax(a, b)).second) continue;
      if (!with_filtered && !may_meet(info_a, info_b)) continue;
      if (parts[a].empty() || parts[b].empty()) continue;
      PlainClearance pair = plain_clearance(parts[a], parts[b]);
      pair.a = a;
      pair.b = b;
      found.push_back(pair);
    }
  }
  std::sort(found.begin(), found.end(), [](const auto& x, const auto& y) { return x.low_m < y.low_m; });
  return found;
}

}  // namespace collided::oracle
