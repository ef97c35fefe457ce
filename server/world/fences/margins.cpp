// The margins of a world: which objects have bands, and when bands are added and removed.

#include <algorithm>
#include <charconv>
#include <cmath>

#include "idl/clocks.hpp"
#include "idl/glob.hpp"
#include "server/geometry/tolerance.hpp"
#include "server/world/fences/fences.hpp"

namespace collided::engine {
namespace {

bool is_good_distance(double metres) { return std::isfinite(metres) && metres >= 0; }

/// The shortest text that reads back as the same number.
std::string text_of(double number) {
  char text[32];
  return {text, std::to_chars(text, text + sizeof text, number).ptr};
}

}  // namespace

std::string band_name(std::string_view margin, std::string_view about, std::size_t index, double within_m) {
  std::string name(margin);
  name.append("\n").append(about).append("\n").append(std::to_string(index)).append("\n").append(text_of(within_m));
  return name;
}

std::string refusal_of(const MarginBands& margin) {
  const std::vector<double>& bands = margin.bands_m;
  if (bands.empty()) return "it has no band";
  if (bands.size() > MarginBands::kMost)
    return "it has " + std::to_string(bands.size()) + " bands, of which contact is one; at most " +
           std::to_string(MarginBands::kMost) + " are allowed";
  for (std::size_t i = 0; i < bands.size(); ++i) {
    if (!is_good_distance(bands[i]))
      return "band " + std::to_string(i + 1) + " is " + text_of(bands[i]) +
             " m; a finite distance, 0 or more, is needed";
    if (i > 0 && !(bands[i] < bands[i - 1]))
      return "band " + std::to_string(i + 1) + " is " + text_of(bands[i]) + " m, which is not less than " +
             text_of(bands[i - 1]) + " m before it; the widest comes first";
  }
  if (!is_good_distance(margin.hysteresis_m))
    return "its hysteresis is " + text_of(margin.hysteresis_m) + " m; a finite distance, 0 or more, is needed";
  if (!std::isfinite(bands.front() + margin.hysteresis_m)) return "its widest band and its hysteresis are too large";
  if (margin.dwell_ns < 0 || margin.dwell_ns > MarginBands::kLongestDwellNs)
    return "its dwell is " + text_of(static_cast<double>(margin.dwell_ns) * wire_contract::kNanosecond_s) +
           " s; 0 to 3600 s are allowed";
  return {};
}

void Fences::drop_pending(ObjectId id) {
  std::erase_if(pending_, [&](const auto& entry) { return entry.first.first == id || entry.first.second == id; });
}

/// Gives new margins bands around the existing objects, and new objects bands of the existing margins.
void Fences::make_bands(const StepView& step) {
  if (margins_.empty()) return;
  const auto is_new_margin = [&](const std::string& name) {
    return std::find(new_margins_.begin(), new_margins_.end(), name) != new_margins_.end();
  };
  for (const std::uint32_t slot : step.rows.moved()) {
    if (step.rows.info(slot) == nullptr || !step.rows.is_new(slot)) continue;
    for (const auto& [name, margin] : margins_) {
      // For a moving object all known time is decided, as for contacts; else only the present.
      if (!is_new_margin(name)) add_bands(step, margin, slot, !step.rows.info(slot)->moving);
    }
  }
  for (const std::string& name : new_margins_) {
    for (std::uint32_t slot = 0; slot < step.rows.size(); ++slot) {
      if (step.rows.info(slot) != nullptr) add_bands(step, margins_.find(name)->second, slot, true);
    }
  }
  new_margins_.clear();
}

/// is_new: nothing is reported for the time before the bands.
void Fences::add_bands(const StepView& step, const FenceDefinition& margin, std::uint32_t object, bool is_new) {
  const std::shared_ptr<const ObjectInfo>& info = step.rows.table()[object];
  // Parts of a scene share one mesh, and have no body of their own to measure distances from.
  if (info->scene_part != kNoScenePart) return;
  const auto is_of = [&](const std::string& glob) { return wire_contract::glob_matches(glob, info->name); };
  const bool is_looked_at = is_of(margin.only) && (info->filter.layers & margin.mask) != 0;
  if (!is_of(margin.margin->around) && (info->moving || !is_looked_at)) return;
  if (!margin.skip.empty() && is_of(margin.skip)) return;
  const std::vector<double>& bands = margin.margin->bands_m;
  if (table_.count() + bands.size() > FenceTable::kMost) {
    cost_.truncated = true;
    return;
  }
  const std::vector<std::uint32_t> slots = table_.take_slots(bands.size());
  for (std::size_t i = 0; i < bands.size(); ++i) {
    FenceRule rule{.carrier = {},
                   .only = margin.only,
                   .skip = margin.skip,
                   .mask = margin.mask,
                   .detects = margin.detects,
                   .owner = margin.owner};
    rule.band = BandRule{.margin = margin.name,
                         .around = margin.margin->around,
                         .within_m = bands[i],
                         .hysteresis_m = margin.margin->hysteresis_m,
                         .dwell_in_ns = bands[i] > 0 ? margin.margin->dwell_ns : 0,
                         .dwell_out_ns = margin.margin->dwell_ns};
    table_.add_band(slots[i], slots[0], band_name(margin.name, info->name, i, bands[i]), rule, info, object);
    if (i == 0) table_.set_bounds(slots[0], bounds_at(step, slots[0]));
    if (step.rows[object].is_stale) ledger_.lose(table_.id(slots[i]));
    if (is_new) new_.push_back(slots[i]);
  }
}

/// Adds the fence and its inner bands.
void Fences::add_with_inner(std::uint32_t fence, std::vector<std::uint32_t>& to) const {
  to.push_back(fence);
  if (!table_.is_band(fence)) return;
  for (const std::uint32_t other : table_.carried_by(table_.carrier(fence))) {
    if (other != fence && table_.is_band(other) && table_.widest(other) == fence) to.push_back(other);
  }
}

/// For an inner band: the bounds of the widest, reduced by the difference of their distances. A filter: too large by
/// some roundings.
Aabb Fences::bounds_around(std::uint32_t fence) const {
  if (!table_.is_inner_band(fence)) return table_.bounds(fence);
  const std::uint32_t widest = table_.widest(fence);
  Aabb bounds = table_.bounds(widest);
  if (bounds.empty()) return bounds;
  const double farther_m = table_.beyond_m(widest) - table_.beyond_m(fence);
  const Vec3 size_m = bounds.low.cwiseAbs().cwiseMax(bounds.high.cwiseAbs());
  const Vec3 less_m = (Vec3::Constant(farther_m) - kBoundSlack * (size_m + Vec3::Constant(farther_m))).cwiseMax(0);
  bounds.low += less_m;
  bounds.high -= less_m;
  return bounds;
}

/// Decides pending pairs that were not met in this step though one of the two moved: it was teleported.
void Fences::decide_left_pending(const StepView& step, StandingDecisions& decisions) {
  std::vector<std::pair<std::uint32_t, std::uint32_t>> left;
  for (auto& [pair, turned] : pending_) {
    const std::uint32_t fence = slot_of(pair.second);
    const std::uint32_t mover = slot_of(pair.first);
    if (turned.considered_in_step == step_) continue;
    if (step.rows.has_moved(mover) || step.rows.has_moved(table_.carrier(fence))) left.emplace_back(fence, mover);
  }
  for (const auto& [fence, mover] : left) decide_pair(decisions, fence, mover, false);
}

}  // namespace collided::engine
