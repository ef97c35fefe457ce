#include <utility>
#include <vector>

#include "idl/clocks.hpp"
#include "server/geometry/float_environment.hpp"
#include "server/world/step/candidates.hpp"
#include "server/world/step/inner_edges.hpp"
#include "server/world/world_state.hpp"

namespace collided::engine {

using wire_contract::steady_ns;

namespace {

/// Contacts of removed objects end before anything else, since their slots may be reused from now on.
void end_removed(std::vector<std::pair<ObjectId, EndReason>>& removed, ContactLedger& ledger) {
  for (const auto& [id, reason] : removed) ledger.end_object(id, reason);
  removed.clear();
}

/// Turns a lost object's contacts into doubts; an object found again is tested in this step, moved or not.
void note_lost(World::State& s) {
  for (const auto& [id, is_lost] : s.lost) {
    if (is_lost) {
      s.ledger.lose(id);
    } else if (s.rows.find(id) != nullptr) {
      s.ledger.find_again(id);
      s.rows.look_again(slot_of(id));
    }
  }
  s.lost.clear();
}

/// Puts each mover's whole motion since its last pose into the grid, so that pairs that met on the way are candidates.
/// While nothing moves, the last snapshot's grid is shared; while little does, most of it.
void index_motion(StepMotion& motion, const Snapshot& current, bool has_open, std::shared_ptr<Grid>& grid) {
  if (!has_open && current.grid) {
    grid = current.grid;
    return;
  }
  if (!grid || grid.use_count() > 1) grid = std::make_shared<Grid>();
  if (current.grid) grid->update(*current.grid, motion.bounds(), motion.changed());
  else grid->rebuild(motion.bounds());
  motion.note_indexed();
}

}  // namespace

bool World::step(std::int64_t world_time_ns, std::uint64_t batches, const StepOptions& step_options) {
  const OwnFloatEnvironment own_floats;
  State& s = *state_;
  Snapshot* next = s.ring.writable();
  if (next == nullptr) return false;
  const std::int64_t started = steady_ns();
  s.version += batches;
  s.settle_attachments();
  s.cost = {.moved = static_cast<std::uint32_t>(s.rows.moved().size())};

  // Ingest: changes since the last step end contacts and go into the snapshot.
  s.ledger.begin_step(world_time_ns, step_options.persisted);
  if (s.fences) s.fences->begin_step(world_time_ns, {s.removed, s.lost});
  end_removed(s.removed, s.ledger);
  note_lost(s);
  s.take_pair_rules();
  s.sources.begin_step(world_time_ns, s.motion.is_any_open());
  s.rows.stamp_changes(world_time_ns, s.sources);
  s.fill(*next, world_time_ns);
  s.memory.note({s.rows, s.sources, s.scenes, s.stale_objects, *next});
  const std::int64_t updated = steady_ns();

  // Motion, and the index over its bounds.
  s.motion.begin_step(s.sources, s.apart);
  const bool has_open = !s.rows.moved().empty() || s.motion.is_any_open();
  index_motion(s.motion, s.ring.current(), has_open, next->grid);
  const std::int64_t indexed = steady_ns();

  // Decisions, written to the ledger.
  const StepView view{s.rows, s.motion, s.sources, s.scenes, s.options, step_options, world_time_ns, s.looks_at_all};
  if (has_open) s.decide(view, *next->grid);
  if (s.fences && (has_open || s.fences->has_news())) s.fences->decide(view, *next->grid);
  const std::int64_t decided = steady_ns();
  if (has_open) {
    if (step_options.contacts) correct_inner_edges(s.rows, s.motion, s.scenes, s.ledger);
    s.looks_at_all = s.cost.truncated;
  } else {
    s.cost.truncated = s.looks_at_all;
  }
  s.mark_unsure_ends();
  s.ledger.finish_step();
  if (s.fences) s.fences->finish_step();

  // Publish.
  next->contacts_truncated = s.cost.truncated;
  s.ring.publish();
  s.apart.end_step();
  s.sources.end_step();
  s.motion.end_step(s.sources.floor_ns());
  s.rows.end_step();
  s.last_step_ns = world_time_ns;
  s.cost.update_ns = updated - started;
  s.cost.broad_ns = indexed - updated;
  s.cost.exact_ns = decided - indexed;
  s.cost.events_ns = steady_ns() - decided;
  return true;
}

void World::State::take_pair_rules() {
  if (!std::exchange(has_new_pair_rules, false)) return;
  if (!pair_rules) {
    ledger.set_allowed({});
  } else {
    // Names are matched once per object: the same few objects touch step after step.
    struct SlotFit {
      ObjectId id = 0;
      RuleFit fit;
    };
    const auto is_allowed = [rules = pair_rules, this, fits = std::vector<SlotFit>()](ObjectId a, ObjectId b) mutable {
      const auto fit_of = [&](ObjectId id) {
        const std::uint32_t slot = slot_of(id);
        if (slot >= fits.size()) fits.resize(slot + 1);
        if (fits[slot].id != id) fits[slot] = {id, rules->fit_of(rows.info(slot)->name)};
        return fits[slot].fit;
      };
      return rules->allows(fit_of(a), fit_of(b));
    };
    ledger.set_allowed(is_allowed);
    ledger.end_allowed();
  }
  rows.place_all_movers_again();
}

/// A shard may hold only the triangles of a part that reach into its box and margin. If an object separates from the
/// part there, the shard does not know the rest: an object that reaches beyond the box may touch the part elsewhere,
/// and another shard reports when that contact ends.
void World::State::mark_unsure_ends() {
  const bool is_any_cut_off = std::ranges::any_of(scenes, [](const auto& scene) { return scene->is_cut_off; });
  if (!options.held || !is_any_cut_off) return;
  const auto is_cut_off = [&](ObjectId id) {
    const ObjectInfo* const info = rows.find(id);
    return info != nullptr && !info->rare->cut.is_whole();
  };
  const auto reaches_beyond = [&](ObjectId id) {
    if (rows.find(id) == nullptr) return true;
    const Aabb& motion_bounds = motion.bounds()[slot_of(id)];
    return !((motion_bounds.low.array() >= options.held->low.array()).all() &&
             (motion_bounds.high.array() <= options.held->high.array()).all());
  };
  ledger.retell_unsure([&](const OpenContact& of) {
    return (is_cut_off(of.a) && reaches_beyond(of.b)) || (is_cut_off(of.b) && reaches_beyond(of.a));
  });
}

void World::State::fill(Snapshot& next, std::int64_t world_time_ns) {
  rows.copy_changes(next);
  next.epoch = options.epoch;
  next.version = version;
  next.world_time_ns = world_time_ns;
  next.scenes = scenes;
  next.settled_ns = sources.settled_ns(world_time_ns);
  next.stale_objects = stale_objects;
  next.covers = covers;
  next.covers_without_places = options.held.has_value();
  next.pair_rules = pair_rules;
  next.parents = attachments.table();
}

void World::State::decide(const StepView& step, const Grid& grid) {
  lists.boxes.begin_step(rows.size());
  if (options.step_threads > 1 && !step_pool) step_pool = std::make_unique<StepPool>(options.step_threads - 1);
  Decisions decisions(step, ledger, apart, lists, cost);
  SharedDecisions shared(step, ledger, apart, lists, cost, step_pool.get(), *step_blocks);
  Candidates candidates(step, decisions, cost, step_pool ? &shared : nullptr);
  candidates.decide_scenes();
  if (!cost.truncated) candidates.decide_pairs(grid);
  // The search was cut short: contacts it did not reach must still be confirmed or ended.
  if (cost.truncated) decisions.decide_open();
  decisions.end_parted(last_step_ns);
}

}  // namespace collided::engine
