// Publishers that come and go: their objects, and when a publisher is forgotten.
#include "server/service/ingest/publishers.hpp"

#include <fmt/format.h>

#include <utility>

#include "idl/clocks.hpp"
#include "server/service/questions/validation.hpp"

namespace collided::engine::service {

void Publishers::writer_alive(std::uint64_t id, WriterKind kind, std::int64_t) {
  Publisher* publisher = find(id);
  if (!publisher) return;
  (kind == WriterKind::object ? publisher->object_writer : publisher->pose_writer) = true;
  if (publisher->lost) back_alive(*publisher);
}

Applied Publishers::writer_lost(std::uint64_t id, WriterKind kind, std::int64_t now_ns) {
  Publisher* publisher = find(id);
  if (!publisher || publisher->lost) return Applied::done;
  (kind == WriterKind::object ? publisher->object_writer : publisher->pose_writer) = false;
  if (publisher->object_writer || publisher->pose_writer) return Applied::done;
  if (any_touched(*publisher)) return Applied::step_first;
  note_lost(*publisher, true);
  publisher->lost_ns = now_ns;
  publisher->parts.clear();
  world_.lose(publisher->id);
  ++changes_;  // pairs no longer wait for the lost publisher's time
  bool left_nothing = true;
  for (const Record& record : publisher->objects.records()) {
    left_nothing = left_nothing && record.place == Place::gone;
    if (record.place != Place::in_world || record.described->definition.lost_policy == LostPolicy::hold) continue;
    world_.set_stale(record.id, true);
    ++changes_;
  }
  // A publisher that removed all its objects before it left is not lost. It stays known for a while, for questions that
  // wait for its last sample.
  publisher->took_leave = left_nothing;
  publisher->is_frozen = !left_nothing;
  if (!left_nothing) notice_loss(*publisher);
  if (limits_.forget_after_ns == 0) apply_lost_policies(*publisher);
  if (lost_count_ > limits_.lost_publishers) forget_first_lost();
  return Applied::done;
}

void Publishers::notice_loss(Publisher& publisher) {
  const std::string name = printable(publisher.name);
  if (std::exchange(publisher.was_lost_before, true)) return notice(fmt::format("publisher {} is lost", name));
  notice(fmt::format(
      "publisher {} is lost: it ended without closing, or was silent for longer than its lease. Its objects are "
      "stale, and leave by their lost policies in {:.3g} s (--forget-after). If it pauses for so long, publish "
      "with a longer lease",
      name, static_cast<double>(limits_.forget_after_ns) * wire_contract::kNanosecond_s));
}

/// Objects with the policy remove leave with their publisher and return with it.
void Publishers::apply_lost_policies(Publisher& publisher) {
  publisher.is_frozen = false;
  for (Record& record : publisher.objects.records()) {
    if (record.place != Place::in_world || record.described->definition.lost_policy != LostPolicy::remove) continue;
    leave(record, EndReason::publisher_lost);
    record.place = Place::taken_away;
  }
}

void Publishers::apply_lost_policies(std::int64_t now_ns) {
  for (auto& [id, publisher] : publishers_) {
    const bool is_over = publisher->is_frozen && now_ns - publisher->lost_ns >= limits_.forget_after_ns;
    if (is_over && !any_touched(*publisher)) apply_lost_policies(*publisher);  // else with the next call
  }
}

/// The first publisher to be lost, of those whose policies wait or of all. Null: there is none.
Publishers::Publisher* Publishers::first_lost(bool is_frozen) const {
  Publisher* first = nullptr;
  for (const auto& [id, publisher] : publishers_) {
    if (!publisher->lost || (is_frozen && !publisher->is_frozen)) continue;
    if (first == nullptr || publisher->lost_ns < first->lost_ns) first = publisher.get();
  }
  return first;
}

/// In a full world the objects of lost publishers give way to those of live ones.
void Publishers::make_room_for_object() {
  while (lost_count_ > 0 && world_.is_full()) {
    Publisher* const publisher = first_lost(true);
    if (publisher == nullptr) return;
    apply_lost_policies(*publisher);
  }
}

void Publishers::make_room_for_number() {
  while (lost_count_ > 0 && record_count_ >= limits_.object_numbers) forget_first_lost();
}

void Publishers::note_lost(Publisher& publisher, bool is_lost) {
  lost_count_ += static_cast<std::size_t>(is_lost) - static_cast<std::size_t>(publisher.lost);
  publisher.lost = is_lost;
}

/// Its held objects stay in the world until a command removes them or another publisher defines an object of that name.
/// Claimed objects go back to the world, where they can be claimed again.
void Publishers::forget_first_lost() {
  Publisher& publisher = *first_lost(false);
  apply_lost_policies(publisher);
  for (Record& record : publisher.objects.records()) {
    if (record.place == Place::in_world && !record.is_claim) record.place = Place::gone;
  }
  retire(publisher);
  --lost_count_;
  publishers_.erase(publisher.id);
}

void Publishers::back_alive(Publisher& publisher) {
  note_lost(publisher, false);
  publisher.is_frozen = false;
  publisher.numbers_while_lost.clear();
  if (!publisher.took_leave) notice(fmt::format("publisher {} is back", printable(publisher.name)));
  for (Record& record : publisher.objects.records()) {
    if (record.place == Place::taken_away) enter(publisher, record);
    if (record.place != Place::in_world || record.described->definition.lost_policy == LostPolicy::hold) continue;
    world_.set_stale(record.id, false);
    ++changes_;
  }
}

void Publishers::forget_lost(std::int64_t now_ns) {
  std::erase_if(publishers_, [&](const auto& entry) {
    Publisher& publisher = *entry.second;
    if (!publisher.lost || now_ns - publisher.lost_ns < limits_.forgotten_after_ns) return false;
    for (const Record& record : publisher.objects.records()) {
      if (record.place == Place::in_world && world_.info(record.id)) return false;
    }
    retire(publisher);
    --lost_count_;
    return true;
  });
}

void Publishers::settle(std::int64_t now_ns) {
  apply_lost_policies(now_ns);
  if (!claims_.empty()) find_lost_claims();
  if (!waiting_.empty()) retry_names();
  for (auto& [id, publisher] : publishers_) {
    publisher->watermark.settle(now_ns);
    // An object that has to be placed right after a step waits for the next call.
    if (!publisher->said_again.empty())
      static_cast<void>(take_said_again(*publisher, publisher->watermark.through() + 1));
  }
  forget_lost(now_ns);
}

}  // namespace collided::engine::service
