// Repeated definitions: they arrive on another topic than batches, and may overtake some. Applied at once they would
// place a moving object, and the batches behind them would count as late.
#include <vector>

#include "server/service/ingest/publishers.hpp"
#include "server/service/questions/validation.hpp"

namespace collided::engine::service {

/// They wait for the next batch, or for the gap's time.
void Publishers::wait_for_batches(Publisher& publisher, const DefinitionSample& sample) {
  publisher.said_again.push_back(
      {.number = sample.object_number, .sequence = sample.sequence, .pose = std::get<Pose>(checked_pose(sample.pose))});
}

/// Applies those from before that number, since every batch before them has come or will never come. step_first: one of
/// them must be placed but was touched in this step; the rest is applied by the next call.
Applied Publishers::take_said_again(Publisher& publisher, std::uint64_t before) {
  bool is_step_first = false;
  std::erase_if(publisher.said_again, [&](const SaidAgain& said) {
    if (said.sequence >= before || is_step_first) return false;
    Record* const record = publisher.objects.find(said.number);
    const bool is_overtaken = record == nullptr || record->definition_sequence >= said.sequence;
    if (is_overtaken || record->place != Place::in_world || world_.info(record->id) == nullptr) return true;
    if (!is_posed_at(*record, said.pose)) {
      is_step_first = record->touched_step == step_;
      if (is_step_first) return false;
      place_again(publisher, *record, said);
    }
    record->definition_sequence = said.sequence;
    ++counts_.definitions_applied;
    return true;
  });
  return is_step_first ? Applied::step_first : Applied::done;
}

/// The poses that moved it there were lost.
void Publishers::place_again(Publisher& publisher, Record& record, const SaidAgain& said) {
  leave(record, EndReason::geometry_changed);
  record.pose = said.pose;
  record.has_velocity = false;
  --counts_.definitions_applied;  // counted again as it enters
  enter(publisher, record);
}

}  // namespace collided::engine::service
