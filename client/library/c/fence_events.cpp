#include "client/library/c/fence_events.hpp"

#include "client/library/c/values.hpp"

namespace collided::c {
namespace {

/// What events of all kinds have in common.
template <class Told, class NewsEvent>
Told lent(const NewsEvent& event) {
  Told told{};
  told.kind = static_cast<std::int32_t>(event.kind);
  told.reason = static_cast<std::int32_t>(event.reason);
  told.doubt = static_cast<std::int32_t>(event.doubt);
  told.resync = event.resync ? 1 : 0;
  told.poses_merged = event.poses_merged ? 1 : 0;
  told.epoch = event.epoch;
  told.sequence = event.sequence;
  told.world_time_ns = event.world_time.count();
  told.bracket_low_s = event.bracket_low_s;
  told.bracket_high_s = event.bracket_high_s;
  return told;
}

}  // namespace

collided_fence_event lend_fence(const FenceEvent& event) {
  auto told = lent<collided_fence_event>(event);
  told.object = event.object.c_str();
  told.fence = event.fence.c_str();
  told.episode = event.episode;
  told.entered_ns = event.entered.count();
  told.left_low_s = event.left_low_s;
  told.left_high_s = event.left_high_s;
  put(event.point, told.point);
  return told;
}

collided_margin_event lend_margin(const MarginEvent& event) {
  auto told = lent<collided_margin_event>(event);
  told.margin = event.margin.c_str();
  told.object = event.object.c_str();
  told.around = event.around.c_str();
  told.band_m = event.band_m;
  told.episode = event.episode;
  told.entered_ns = event.entered.count();
  told.distance_m = event.distance_m;
  told.distance_error_m = event.distance_error_m;
  put(event.point, told.point);
  put(event.normal, told.normal);
  told.closing_mps = event.closing_mps;
  told.closing_error_mps = event.closing_error_mps;
  if (event.contact_in) {
    told.has_contact_in = 1;
    told.contact_in_low_s = event.contact_in->low_s;
    told.contact_in_high_s = event.contact_in->high_s;
  }
  return told;
}

collided_nearest_event lend_nearest(const NearestEvent& event) {
  auto told = lent<collided_nearest_event>(event);
  told.nearest = event.nearest.c_str();
  told.from = event.from.c_str();
  told.to = event.to.c_str();
  told.distance_m = event.distance_m;
  told.distance_error_m = event.distance_error_m;
  put(event.point, told.point);
  put(event.normal, told.normal);
  return told;
}

}  // namespace collided::c
