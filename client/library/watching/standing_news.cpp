#include "client/library/watching/standing_news.hpp"

#include <utility>

#include "idl/glob.hpp"

namespace collided::client {
namespace {

StandingEventKind kind_of(const StandingNews& news) {
  using enum StandingEventKind;
  const StandingEvent& reported = news.reported;
  if (news.kind == EventKind::open)
    return reported.form == StandingForm::region ? inside : reported.form == StandingForm::bands ? within : is;
  const bool is_end = news.kind == EventKind::ended;
  switch (reported.form) {
    case StandingForm::region: return !is_end ? enter : reported.kind == cross ? cross : exit;
    case StandingForm::bands:
      return is_end ? leave : reported.band_m == 0 ? contact : reported.kind == approach ? approach : near;
    case StandingForm::nearest: break;
  }
  return changed;
}

/// True if the region reports events of this kind. Kinds without a bit are always reported.
bool is_detected(StandingEventKind kind, std::uint8_t detects) {
  switch (kind) {
    case StandingEventKind::enter: return (detects & codes::kDetectEnter) != 0;
    case StandingEventKind::exit: return (detects & codes::kDetectExit) != 0;
    case StandingEventKind::cross: return (detects & codes::kDetectCross) != 0;
    default: return true;
  }
}

bool has_distance(const StandingNews& news) {
  if (news.doubt != Doubt::none || news.reported.form == StandingForm::region) return false;
  return news.kind == EventKind::began || (news.kind == EventKind::open && news.reported.form == StandingForm::nearest);
}

}  // namespace

std::optional<StandingEvent> event_of(const StandingNews& news) {
  if (news.is_superseded || (news.is_silent && !news.resync)) return std::nullopt;
  const StandingEvent& reported = news.reported;
  const bool is_end = news.kind == EventKind::ended;
  StandingEvent event{.kind = kind_of(news),
                      .form = reported.form,
                      .doubt = news.doubt,
                      .poses_merged = news.poses_merged,
                      .resync = news.resync,
                      .standing = news.b,
                      .object = news.a,
                      .other = reported.other,
                      .band_m = reported.band_m,
                      .object_id = news.a_id,
                      .epoch = news.epoch,
                      .sequence = news.sequence,
                      .episode = news.episode,
                      .world_time = news.world_time,
                      .entered = news.began,
                      .bracket_low_s = news.bracket_low_s,
                      .bracket_high_s = news.bracket_high_s};
  if (!is_detected(event.kind, news.detects)) return std::nullopt;
  if (event.kind == StandingEventKind::cross) {
    event.bracket_low_s = reported.bracket_low_s;
    event.bracket_high_s = reported.bracket_high_s;
    event.left_low_s = news.bracket_low_s;
    event.left_high_s = news.bracket_high_s;
  } else if (is_end || event.kind == StandingEventKind::changed) {
    event.reason = news.reason;
  }
  if (event.kind == StandingEventKind::is) event.other.clear();
  if (event.form == StandingForm::nearest && is_end) {
    event.other = std::exchange(event.object, {});
    event.object_id = 0;
    event.doubt = Doubt::none;
  }
  if (event.form == StandingForm::region) event.point = reported.point;
  if (!has_distance(news)) return event;
  event.point = reported.point;
  event.normal = reported.normal;
  event.distance_m = reported.distance_m;
  event.distance_error_m = reported.distance_error_m;
  event.closing_mps = reported.closing_mps;
  event.closing_error_mps = reported.closing_error_mps;
  event.contact_in = reported.contact_in;
  return event;
}

StandingNames names_of(const StandingNews& news) {
  const bool is_band = news.reported.form == StandingForm::bands;
  return {news.a, news.b, is_band ? news.reported.other : "", news.reported.band_m};
}

StandingNames place_of(const StandingNews& news) {
  StandingNames names = names_of(news);
  if (news.reported.form == StandingForm::nearest) std::get<0>(names).clear();
  return names;
}

void take_names(const StandingNews& from, StandingNews& to) {
  to.a = from.a;
  to.b = from.b;
  if (from.reported.form == StandingForm::bands) to.reported.other = from.reported.other;
}

bool is_wanted(const StandingEvent& event, const StandingWatchOptions& options) {
  if (options.form && *options.form != event.form) return false;
  const auto any_is = [&](const std::string& glob) {
    return wire_contract::glob_matches(glob, event.standing) || wire_contract::glob_matches(glob, event.object) ||
           wire_contract::glob_matches(glob, event.other);
  };
  return (options.only.empty() || any_is(options.only)) && (options.skip.empty() || !any_is(options.skip));
}

}  // namespace collided::client
