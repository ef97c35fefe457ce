#include "server/service/events/standing_frames.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>

#include "idl/columns.hpp"
#include "server/world/fences/fences.hpp"

namespace collided::engine::service {
namespace {

constexpr double kNotKnown = std::numeric_limits<double>::infinity();

/// A row of both messages; members are named like the columns of collided.idl.
struct StandingRow {
  StandingEventKind kind = StandingEventKind::enter;
  StandingForm form = StandingForm::region;
  std::uint8_t detect = kDetectAll;
  EndReason reason = EndReason::none;
  std::uint8_t doubt = 0;
  std::uint8_t shard = 0;
  ObjectId standing = 0;
  ObjectId object = 0;
  ObjectId other = 0;
  double band_m = 0;
  std::uint64_t episode = 0;
  std::int64_t began_ns = 0;
  Vec3 point = Vec3::Zero();
  Vec3 normal = Vec3::Zero();
  double distance_m = 0;
  double distance_error_m = 0;
  double closing = 0;
  double closing_error = 0;
  double contact_low_s = kNotKnown;
  double contact_high_s = kNotKnown;
  double bracket_low_s = 0;
  double bracket_high_s = 0;
  double left_low_s = 0;
  double left_high_s = 0;
};

StandingEventKind kind_of_beginning(const AskedStanding& asked) {
  if (asked.form == StandingForm::region) return StandingEventKind::enter;
  if (asked.form == StandingForm::nearest) return StandingEventKind::changed;
  if (asked.band_m == 0) return StandingEventKind::contact;
  return asked.is_widest ? StandingEventKind::approach : StandingEventKind::near;
}

/// The common part of an event and a held pair. In doubt all is reported, which errs on the safe side.
StandingRow row_of(const OpenContact& of, const AskedStanding& asked) {
  const bool may_be_silent = asked.form == StandingForm::region && of.doubt == Doubt::none;
  return {.kind = kind_of_beginning(asked),
          .form = asked.form,
          .detect = may_be_silent ? asked.detects : kDetectAll,
          .doubt = static_cast<std::uint8_t>(of.doubt),
          .shard = wire_contract::contact_shard(of.a, of.b),
          .standing = of.b,
          .object = of.a,
          .other = asked.about,
          .band_m = asked.band_m,
          .episode = of.episode,
          .began_ns = of.began_ns};
}

void put_distance(StandingRow& row, const OpenContact& of) {
  if (of.doubt != Doubt::none) return;
  row.point = of.contact.point;
  row.normal = of.contact.normal;
  row.distance_m = -of.contact.depth_m;
  row.distance_error_m = of.contact.depth_error_m;
}

void put_region(StandingRow& row, const Event& event, const Event* left) {
  if (event.kind == EventKind::began) row.point = event.of.contact.point;
  else row.kind = StandingEventKind::exit;
  if (left == nullptr) return;
  row.kind = StandingEventKind::cross;
  row.left_low_s = left->bracket_low_s;
  row.left_high_s = left->bracket_high_s;
}

void put_band(StandingRow& row, const Event& event) {
  if (event.kind == EventKind::ended) {
    row.kind = StandingEventKind::leave;
    return;
  }
  if (event.of.doubt != Doubt::none) return;
  put_distance(row, event.of);
  // The normal is a unit vector up to rounding, so the product's error is small against the velocity's.
  row.closing = -event.of.contact.normal.dot(event.relative_velocity);
  row.closing_error = event.velocity_error + 8e-16 * event.relative_velocity.norm();
  // The time until the two would touch, and its bound.
  const Contact& forecast = event.of.surface;
  if (!std::isfinite(forecast.depth_error_m)) return;
  row.contact_low_s = std::max(0.0, forecast.depth_m - forecast.depth_error_m);
  row.contact_high_s = forecast.depth_m + forecast.depth_error_m;
}

/// began  the nearest from now on; null: there is none
void put_nearest(StandingRow& row, const Event& event, const Event* began) {
  const bool ends_one = event.kind == EventKind::ended;
  row.other = ends_one ? event.of.a : 0;
  row.episode = ends_one ? event.of.episode : 0;
  row.object = began != nullptr ? began->of.a : 0;
  row.doubt = began != nullptr ? static_cast<std::uint8_t>(began->of.doubt) : 0;
  if (began == nullptr) return;
  row.shard = wire_contract::contact_shard(began->of.a, began->of.b);
  put_distance(row, began->of);
}

}  // namespace

void StandingBook::note(const OpenContact& of, const World& world) {
  Entry& entry = asked_[of.b];
  if (entry.holds++ == 0) {
    const FenceTable& table = world.fences()->table();
    const std::uint32_t slot = slot_of(of.b);
    const FenceRule& rule = table.rule(slot);
    entry.asked = {.name = table.name(slot), .detects = rule.detects};
    if (rule.nearest) entry.asked.form = StandingForm::nearest;
    if (rule.band) {
      const std::shared_ptr<const ObjectInfo>& about = world.objects()[table.carrier(slot)];
      entry.asked = {.name = rule.band->margin,
                     .form = StandingForm::bands,
                     .band_m = rule.band->within_m,
                     .is_widest = table.widest(slot) == slot,
                     .about = about->id};
    }
  }
  objects_.note(of.a, world);
  if (entry.asked.about != 0) objects_.note(entry.asked.about, world);
}

void StandingBook::forget(const OpenContact& of) {
  const auto found = asked_.find(of.b);
  if (found == asked_.end()) return;
  objects_.forget(of.a);
  if (found->second.asked.about != 0) objects_.forget(found->second.asked.about);
  if (--found->second.holds == 0) asked_.erase(found);
}

std::string_view StandingBook::name(ObjectId id) const {
  if (!is_fence(id)) return objects_.name(id);
  const auto found = asked_.find(id);
  return found == asked_.end() ? std::string_view() : found->second.asked.name;
}

void StandingColumns::add(const Event& event, const Event* next, const StandingBook& book, bool is_merged) {
  if (kinds.empty()) first_sequence = event.sequence;
  const AskedStanding& asked = book.asked(event.of.b);
  StandingRow row = row_of(event.of, asked);
  row.bracket_low_s = event.bracket_low_s;
  row.bracket_high_s = event.bracket_high_s;
  if (event.kind == EventKind::ended) row.reason = event.reason;
  switch (asked.form) {
    case StandingForm::region: put_region(row, event, next); break;
    case StandingForm::bands: put_band(row, event); break;
    case StandingForm::nearest: put_nearest(row, event, event.kind == EventKind::began ? &event : next); break;
  }
  if (is_merged) row.doubt |= wire_contract::kDoubtPosesMerged;
  wire::put_row(*this, row);
  named_ids.push_back(row.standing);
  for (const ObjectId id : {row.object, row.other}) {
    if (id != 0) named_ids.push_back(id);
  }
}

void StandingStateColumns::add(const OpenContact& open, const StandingBook& book) {
  const AskedStanding& asked = book.asked(open.b);
  StandingRow row = row_of(open, asked);
  if (asked.form == StandingForm::nearest) put_distance(row, open);
  if (asked.form == StandingForm::region) row.point = open.contact.point;
  wire::put_row(*this, row);
  named_ids.push_back(row.standing);
  for (const ObjectId id : {row.object, row.other}) {
    if (id != 0) named_ids.push_back(id);
  }
}

std::size_t StandingStateColumns::bytes() const {
  return size() * wire::bytes_of_row<StandingShardColumns>() + named_ids.size() * sizeof(ObjectId) + names.size();
}

}  // namespace collided::engine::service
