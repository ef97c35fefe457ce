#include "client/library/watching/margin_news.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>

#include "idl/glob.hpp"

namespace collided::client {
namespace {

/// The parts of a band's name; false: it is none.
bool read_band(std::string_view name, MarginEvent& event, std::uint32_t& index) {
  std::string_view parts[4];
  for (std::size_t i = 0; i < 4; ++i) {
    const std::size_t end = name.find('\n');
    if ((end == std::string_view::npos) != (i == 3)) return false;
    parts[i] = name.substr(0, end);
    name.remove_prefix(std::min(name.size(), end + (i < 3 ? 1 : 0)));
  }
  event.margin = parts[0];
  event.around = parts[1];
  const auto read = [](std::string_view text, auto& number) {
    return std::from_chars(text.data(), text.data() + text.size(), number).ec == std::errc();
  };
  return read(parts[2], index) && read(parts[3], event.band_m);
}

MarginEventKind kind_of(const Event& event, double band_m, std::uint32_t index) {
  if (event.kind == EventKind::open) return MarginEventKind::within;
  if (event.kind == EventKind::ended) return MarginEventKind::leave;
  if (band_m == 0) return MarginEventKind::contact;
  return index == 0 ? MarginEventKind::approach : MarginEventKind::near;
}

bool is_wanted(const MarginEvent& event, const MarginWatchOptions& wanted) {
  const auto any_is = [&](const std::string& glob) {
    return wire_contract::glob_matches(glob, event.margin) || wire_contract::glob_matches(glob, event.object) ||
           wire_contract::glob_matches(glob, event.around);
  };
  return (wanted.only.empty() || any_is(wanted.only)) && (wanted.skip.empty() || !any_is(wanted.skip));
}

void take_approach(const Event& event, MarginEvent& told) {
  told.distance_m = 0.0 - event.depth_m;
  told.distance_error_m = event.depth_error_m;
  told.point = event.point;
  told.normal = event.normal;
  // The normal is a unit vector up to a rounding, and so is the product's error beside the velocity's.
  told.closing_mps = 0.0 - event.normal.dot(event.relative_velocity);
  told.closing_error_mps = event.velocity_error + 8e-16 * event.relative_velocity.norm();
  if (std::isfinite(event.surface_depth_error_m)) {
    told.contact_in = {std::max(0.0, event.surface_depth_m - event.surface_depth_error_m),
                       event.surface_depth_m + event.surface_depth_error_m};
  }
}

}  // namespace

std::optional<MarginEvent> margin_news(const Event& event, const MarginWatchOptions& wanted) {
  MarginEvent told{.reason = event.kind == EventKind::ended ? event.reason : EndReason::none,
                   .doubt = event.doubt,
                   .poses_merged = event.poses_merged,
                   .resync = event.resync,
                   .margin = {},
                   .object = event.a,
                   .around = {},
                   .object_id = event.a_id,
                   .epoch = event.epoch,
                   .sequence = event.sequence,
                   .episode = event.episode,
                   .world_time = event.world_time,
                   .entered = event.began,
                   .bracket_low_s = event.bracket_low_s,
                   .bracket_high_s = event.bracket_high_s};
  std::uint32_t index = 0;
  if (!read_band(event.b, told, index) || !is_wanted(told, wanted)) return std::nullopt;
  told.kind = kind_of(event, told.band_m, index);
  if (event.kind == EventKind::began && event.doubt == Doubt::none) take_approach(event, told);
  return told;
}

}  // namespace collided::client
