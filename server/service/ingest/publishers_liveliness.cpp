// Publishers that come and go: what becomes of their objects, and when a publisher is forgotten.
#include "server/service/ingest/publishers.hpp"

#include <fmt/format.h>

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
  publisher->lost = true;
  publisher->lost_ns = now_ns;
  publisher->parts.clear();
  world_.lose(publisher->id);
  ++changes_;  // no pair waits for the lost publisher's time any more
  bool left_nothing = true;
  for (Record& record : publisher->objects.records()) {
    left_nothing = left_nothing && record.place == Place::gone;
    if (record.place != Place::in_world) continue;
    if (record.described->definition.lost_policy == LostPolicy::freeze) world_.set_stale(record.id, true);
    if (record.described->definition.lost_policy == LostPolicy::freeze) ++changes_;
    if (record.described->definition.lost_policy != LostPolicy::remove) continue;
    leave(record, EndReason::publisher_lost);
    record.place = Place::taken_away;
  }
  // A publisher that removed all its objects before it left is no loss. It stays known for a while, for questions that
  // wait for its last sample.
  publisher->took_leave = left_nothing;
  if (!left_nothing) notice(fmt::format("publisher {} is lost", printable(publisher->name)));
  return Applied::done;
}

void Publishers::back_alive(Publisher& publisher) {
  publisher.lost = false;
  publisher.numbers_while_lost.clear();
  if (!publisher.took_leave) notice(fmt::format("publisher {} is back", printable(publisher.name)));
  for (Record& record : publisher.objects.records()) {
    if (record.place == Place::taken_away) enter(publisher, record);
    if (record.place != Place::in_world || record.described->definition.lost_policy != LostPolicy::freeze) continue;
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
    return true;
  });
}

void Publishers::settle(std::int64_t now_ns) {
  if (!claims_.empty()) find_lost_claims();
  if (!waiting_.empty()) retry_names();
  for (auto& [id, publisher] : publishers_) {
    publisher->watermark.settle(now_ns);
    // One that has to be placed right after a step waits for the next call.
    if (!publisher->said_again.empty())
      static_cast<void>(take_said_again(*publisher, publisher->watermark.through() + 1));
  }
  forget_lost(now_ns);
}

}  // namespace collided::engine::service
