#include "client/library/watching/fence_news.hpp"

#include <utility>

#include "client/library/watching/margin_news.hpp"
#include "idl/fence_ids.hpp"

namespace collided::client {
namespace {

using codes::kTellsCross;
using codes::kTellsEnter;
using codes::kTellsExit;

FenceEvent news_of(const Event& event, FenceEventKind kind) {
  return {.kind = kind,
          .reason = kind == FenceEventKind::exit ? event.reason : EndReason::none,
          .doubt = event.doubt,
          .poses_merged = event.poses_merged,
          .resync = event.resync,
          .object = event.a,
          .fence = event.b,
          .object_id = event.a_id,
          .fence_id = event.b_id,
          .epoch = event.epoch,
          .sequence = event.sequence,
          .episode = event.episode,
          .world_time = event.world_time,
          .entered = event.began,
          .bracket_low_s = event.bracket_low_s,
          .bracket_high_s = event.bracket_high_s,
          .point = event.point};
}

}  // namespace

std::vector<FenceEvent> FenceNews::take(const Event& event) {
  if (is_band_name(event.b) || wire_contract::is_nearest_id(event.b_id)) return {};
  const std::optional<Event> passing = std::exchange(passing_, std::nullopt);
  const bool is_passage = event.kind == EventKind::ended && event.reason == EndReason::crossed && passing &&
                          passing->episode == event.episode;
  std::vector<FenceEvent> told;
  if (is_passage && (event.b_triangle & kTellsCross) != 0) {
    told.push_back(news_of(*passing, FenceEventKind::cross));
    told.back().poses_merged = passing->poses_merged || event.poses_merged;
    told.back().sequence = event.sequence;
    told.back().left_low_s = event.bracket_low_s;
    told.back().left_high_s = event.bracket_high_s;
    return told;
  }
  // A passage whose end was missed, or that its fence tells as coming and going.
  if (passing && (passing->b_triangle & kTellsEnter) != 0) told.push_back(news_of(*passing, FenceEventKind::enter));
  if (event.kind == EventKind::began && event.reason == EndReason::crossed) {
    passing_ = event;
  } else if (event.kind == EventKind::began && (event.b_triangle & kTellsEnter) != 0) {
    told.push_back(news_of(event, FenceEventKind::enter));
  } else if (event.kind == EventKind::ended && (event.b_triangle & kTellsExit) != 0) {
    told.push_back(news_of(event, FenceEventKind::exit));
  } else if (event.kind == EventKind::open) {
    told.push_back(news_of(event, FenceEventKind::inside));
  }
  return told;
}

}  // namespace collided::client
