#include "client/cli/programs/fleet/shard_planning.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <optional>
#include <tuple>
#include <utility>

namespace collided::cli {
namespace {

using shards::ShardBox;
using shards::ShardEntry;
using shards::ShardMap;

std::uint64_t load_of(const HeldObject& object, LoadMeasure measure) {
  switch (measure) {
    case LoadMeasure::moving: return object.moving ? 1 : 0;
    case LoadMeasure::objects: return 1;
    case LoadMeasure::triangles: return object.triangles;
  }
  return 0;
}

/// A plane across an axis, with the load on either side.
struct CutPlane {
  std::size_t axis = 0;
  double at = 0;
  std::uint64_t low_load = 0;
  std::uint64_t high_load = 0;
  double gap_m = 0;  // the plane may be moved within it without a change

  /// Order of preference: even, then few on both sides, then far from everything, then the first axis.
  auto order() const { return std::tuple(std::max(low_load, high_load), low_load + high_load, -gap_m, axis, at); }
};

/// A number with few digits in the middle half between two.
double round_between(double low, double high) {
  const double middle = low + (high - low) / 2;
  const double quarter = (high - low) / 4;
  constexpr int kMostDecimals = 15;
  for (int decimals = 0; decimals <= kMostDecimals; ++decimals) {
    const double scale = std::pow(10.0, decimals);
    const double rounded = std::round(middle * scale) / scale;
    if (std::abs(rounded - middle) <= quarter) return rounded;
  }
  return middle;
}

/// Where an object begins, or ends, to be held as a plane moves up an axis.
struct BoxSide {
  double at = 0;
  std::uint64_t load = 0;
};

/// The best plane across one axis. At a plane p the low side holds objects that begin at p + margin or below, the high
/// side those that end at p - margin or above; between two such places nothing changes.
std::optional<CutPlane> best_across(std::size_t axis, const ShardBox& box, double margin_m,
                                    std::span<const HeldObject* const> objects, LoadMeasure measure) {
  std::vector<BoxSide> begins;
  std::vector<BoxSide> ends;
  std::vector<double> places;
  CutPlane split{.axis = axis};
  for (const HeldObject* object : objects) {
    const std::uint64_t load = load_of(*object, measure);
    begins.push_back({object->bounds.low[axis] - margin_m, load});
    ends.push_back({object->bounds.high[axis] + margin_m, load});
    split.high_load += load;
    for (const double place : {begins.back().at, ends.back().at}) {
      if (std::isfinite(place)) places.push_back(std::clamp(place, box.low[axis], box.high[axis]));
    }
  }
  std::ranges::sort(begins, {}, &BoxSide::at);
  std::ranges::sort(ends, {}, &BoxSide::at);
  std::ranges::sort(places);
  std::optional<CutPlane> best;
  std::size_t begun = 0;
  std::size_t ended = 0;
  for (std::size_t i = 0; i + 1 < places.size(); ++i) {
    if (places[i] == places[i + 1]) continue;
    split.at = round_between(places[i], places[i + 1]);
    split.gap_m = places[i + 1] - places[i];
    if (!(split.at > places[i] && split.at < places[i + 1])) continue;
    for (; begun < begins.size() && begins[begun].at <= split.at; ++begun) split.low_load += begins[begun].load;
    for (; ended < ends.size() && ends[ended].at < split.at; ++ended) split.high_load -= ends[ended].load;
    if (!best || split.order() < best->order()) best = split;
  }
  return best;
}

/// An intermediate box, with everything that it would hold.
struct PlannedBox {
  ShardBox box;
  std::vector<const HeldObject*> objects;
  std::uint64_t load = 0;
};

PlannedBox part_of(const ShardBox& box, double margin_m, std::span<const HeldObject* const> among,
                   LoadMeasure measure) {
  PlannedBox part{.box = box, .objects = {}};
  const ShardBox held = shards::grown(box, margin_m);
  for (const HeldObject* object : among) {
    if (!shards::meet(held, object->bounds)) continue;
    part.objects.push_back(object);
    part.load += load_of(*object, measure);
  }
  return part;
}

std::pair<PlannedBox, PlannedBox> halves_of(const PlannedBox& part, double margin_m, LoadMeasure measure) {
  if (part.load == 0) throw shards::ShardMapError("nothing there counts as load");
  std::optional<CutPlane> best;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::optional<CutPlane> across = best_across(axis, part.box, margin_m, part.objects, measure);
    if (across && (!best || across->order() < best->order())) best = across;
  }
  if (!best || std::max(best->low_load, best->high_load) >= part.load) {
    throw shards::ShardMapError("no plane leaves less on both sides: all of a load of " + std::to_string(part.load) +
                                " lies too near together, beside a margin of " + std::to_string(margin_m) + " m");
  }
  ShardBox low = part.box;
  ShardBox high = part.box;
  low.high[best->axis] = high.low[best->axis] = best->at;
  return {part_of(low, margin_m, part.objects, measure), part_of(high, margin_m, part.objects, measure)};
}

}  // namespace

std::uint64_t load_of(const ExpectedLoad& load, LoadMeasure measure) {
  switch (measure) {
    case LoadMeasure::moving: return load.moving;
    case LoadMeasure::objects: return load.objects;
    case LoadMeasure::triangles: return load.triangles;
  }
  return 0;
}

std::vector<ExpectedLoad> expected_loads(const ShardMap& map, std::span<const HeldObject> objects) {
  std::vector<ExpectedLoad> loads(map.size());
  for (const HeldObject& object : objects) {
    for (shards::ShardSet holders = map.holders_of(object.bounds); holders != 0; holders &= holders - 1) {
      ExpectedLoad& load = loads[static_cast<std::size_t>(std::countr_zero(holders))];
      load.moving += object.moving ? 1 : 0;
      load.objects += 1;
      load.triangles += object.triangles;
    }
  }
  return loads;
}

ShardPlan split_shard_box(const ShardMap& map, std::size_t split, std::span<const std::string> names,
                          std::span<const HeldObject> objects, LoadMeasure measure) {
  std::vector<const HeldObject*> all;
  for (const HeldObject& object : objects) all.push_back(&object);
  std::vector<PlannedBox> parts{part_of(map.at(split).box, map.margin_m(), all, measure)};
  while (parts.size() < names.size()) {
    const auto heaviest = std::ranges::max_element(parts, {}, &PlannedBox::load);
    auto [low, high] = halves_of(*heaviest, map.margin_m(), measure);
    *heaviest = std::move(low);
    parts.insert(heaviest + 1, std::move(high));
  }
  std::vector<ShardEntry> entries;
  for (std::size_t place = 0; place < map.size(); ++place) {
    if (place != split) entries.push_back(map.at(place));
    else
      for (std::size_t i = 0; i < parts.size(); ++i) entries.push_back({names[i], parts[i].box});
  }
  ShardPlan plan{.map = ShardMap::of(map.margin_m(), std::move(entries)), .loads = {}};
  plan.loads = expected_loads(plan.map, objects);
  plan.objects = objects.size();
  for (const HeldObject& object : objects)
    plan.objects_in_many += std::popcount(plan.map.holders_of(object.bounds)) > 1 ? 1 : 0;
  return plan;
}

}  // namespace collided::cli
