#include "client/library/watching/nearest_news.hpp"

#include "idl/fence_ids.hpp"
#include "idl/glob.hpp"

namespace collided::client {

bool is_wanted(const NearestEvent& event, const NearestWatchOptions& wanted) {
  const auto any_is = [&](const std::string& glob) {
    return wire_contract::glob_matches(glob, event.nearest) || wire_contract::glob_matches(glob, event.from) ||
           wire_contract::glob_matches(glob, event.to);
  };
  return (wanted.only.empty() || any_is(wanted.only)) && (wanted.skip.empty() || !any_is(wanted.skip));
}

std::optional<NearestEvent> NearestNews::take(const Event& event) {
  if (!wire_contract::is_nearest_id(event.b_id)) return std::nullopt;
  NearestEvent told{.kind = event.kind == EventKind::open ? NearestEventKind::is : NearestEventKind::changed,
                    .doubt = event.doubt,
                    .poses_merged = event.poses_merged,
                    .resync = event.resync,
                    .nearest = event.b,
                    .from = {},
                    .to = {},
                    .epoch = event.epoch,
                    .sequence = event.sequence,
                    .world_time = event.world_time,
                    .bracket_low_s = event.bracket_low_s,
                    .bracket_high_s = event.bracket_high_s};
  if (event.kind == EventKind::ended) {
    const auto newest = newest_.find(event.b_id);
    // Where messages were lost, who follows may have been told before.
    if (newest == newest_.end() || newest->second.id != event.a_id) return std::nullopt;
    if (event.b_triangle == wire_contract::kNearestGoesOn) {
      newest->second.ended = event.reason;
      newest->second.poses_merged = event.poses_merged;
      return std::nullopt;
    }
    told.reason = event.reason;
    told.from = newest->second.object;
    told.doubt = Doubt::none;
    newest_.erase(newest);
    return told;
  }
  Newest& newest = newest_[event.b_id];
  told.reason = newest.ended;
  told.poses_merged = event.poses_merged || newest.poses_merged;
  told.from = newest.object;
  told.to = event.a;
  told.to_id = event.a_id;
  if (event.doubt == Doubt::none) {
    told.distance_m = 0.0 - event.depth_m;
    told.distance_error_m = event.depth_error_m;
    told.point = event.point;
    told.normal = event.normal;
  }
  newest = {.object = event.a, .id = event.a_id};
  return told;
}

}  // namespace collided::client
