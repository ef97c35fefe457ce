#include "tests/model/plain_publishers.hpp"

#include <algorithm>

namespace collided::model {
using namespace engine;

using service::WriterKind;
using Place = PlainPublishers::Object::Place;

PlainPublishers::Party* PlainPublishers::meet(std::uint64_t id, std::uint64_t incarnation) {
  const auto [found, is_new] = parties_.try_emplace(id);
  Party& party = found->second;
  if (is_new) party.incarnation = incarnation;
  if (incarnation < party.incarnation) return nullptr;
  if (incarnation > party.incarnation) {
    for (auto& [number, object] : party.objects) leave({id, number}, object);
    Party again;
    again.incarnation = incarnation;
    again.object_writer = party.object_writer;
    again.pose_writer = party.pose_writer;
    again.lost = party.lost;
    party = again;
  }
  return &party;
}

void PlainPublishers::heard(std::uint64_t id, Party& party, WriterKind kind) {
  (kind == WriterKind::object ? party.object_writer : party.pose_writer) = true;
  if (party.lost) back_alive(id, party);
}

void PlainPublishers::back_alive(std::uint64_t id, Party& party) {
  party.lost = party.is_frozen = false;
  for (const std::uint32_t number : party.numbers) {
    Object& object = party.objects.at(number);
    if (object.place == Place::taken_away) enter({id, number}, object);
    if (object.place != Place::in_world || object.policy == LostPolicy::hold) continue;
    object.is_stale = false;
    ++changes;
  }
}

void PlainPublishers::note(Party& party, std::uint64_t sequence, std::uint64_t& newest, std::int64_t now_ns) {
  newest = std::max(newest, sequence);
  if (party.through == 0) party.through = sequence;
  const bool had_gap = !party.heard.empty() && *party.heard.rbegin() > party.through;
  if (sequence > party.through && !had_gap) party.gap_since_ns = now_ns;
  party.heard.insert(sequence);
  go_on(party);
}

void PlainPublishers::go_on(Party& party) {
  party.through = std::max(party.through, std::min(party.newest_definition, party.newest_pose));
  while (party.heard.contains(party.through + 1)) ++party.through;
}

bool PlainPublishers::is_in_world(const Key& key, const Object& object) const {
  const auto owner = owners_.find(object.name);
  return object.place == Place::in_world && owner != owners_.end() && owner->second == key;
}

void PlainPublishers::leave(const Key& key, Object& object) {
  if (object.place != Place::in_world) return;
  if (is_in_world(key, object)) owners_.erase(object.name);
  object.place = Place::gone;
  object.is_stale = false;
  ++changes;
}

void PlainPublishers::enter(const Key& key, Object& object) {
  const auto owner = owners_.find(object.name);
  if (owner != owners_.end()) {
    const auto party = parties_.find(owner->second.first);
    if (party == parties_.end() || !party->second.lost) {
      if (object.place == Place::waits) return;
      object.place = Place::waits;
      waiting_.push_back(key);
      ++counts.name_conflicts;
      return;
    }
    const Key of = owner->second;
    Object& yields = party->second.objects.at(of.second);
    leave(of, yields);
    yields.place = Place::taken_away;
  }
  owners_[object.name] = key;
  object.place = Place::in_world;
  ++changes;
  ++counts.definitions_applied;
}

void PlainPublishers::define(const service::DefinitionSample& sample, std::int64_t now_ns) {
  Party* party = meet(sample.publisher, sample.incarnation);
  if (party == nullptr) {
    ++counts.definitions_late;
    return;
  }
  heard(sample.publisher, *party, WriterKind::object);
  const Key key{sample.publisher, sample.object_number};
  if (!party->objects.contains(sample.object_number)) party->numbers.push_back(sample.object_number);
  Object& object = party->objects[sample.object_number];
  if (sample.sequence <= object.defined_by) {
    ++counts.definitions_late;
    return;
  }
  const bool is_said_again = !sample.removed && is_in_world(key, object) && object.name == sample.name &&
                             object.policy == static_cast<LostPolicy>(sample.lost_policy) &&
                             object.moving == sample.moving && object.layers == sample.filter.layers;
  const bool waits = is_said_again && party->through + 1 < sample.sequence;
  if (waits) party->said_again.push_back({sample.object_number, sample.sequence, sample.pose});
  else object.defined_by = sample.sequence;
  if (waits) {
    // It takes its place among the batches.
  } else if (sample.removed) {
    leave(key, object);
    object.place = Place::gone;
    object.moving = false;
    ++counts.definitions_applied;
  } else {
    leave(key, object);
    object.name = sample.name;
    object.policy = static_cast<LostPolicy>(sample.lost_policy);
    object.moving = sample.moving;
    object.layers = sample.filter.layers;
    object.pose = sample.pose;
    object.velocity.reset();
    enter(key, object);
  }
  party->definitions_seen = std::max(party->definitions_seen, sample.sequence);
  note(*party, sample.sequence, party->newest_definition, now_ns);
  for (auto& [id, other] : parties_) release_parked(id, other, now_ns);
}

void PlainPublishers::take_said_again(std::uint64_t id, Party& party, std::uint64_t before) {
  std::erase_if(party.said_again, [&](const SaidAgain& said) {
    if (said.sequence >= before) return false;
    Object& object = party.objects.at(said.number);
    const Key key{id, said.number};
    if (said.sequence <= object.defined_by || !is_in_world(key, object)) return true;
    object.defined_by = said.sequence;
    if (object.pose == said.pose) {
      ++counts.definitions_applied;
      return true;
    }
    leave(key, object);
    object.pose = said.pose;
    object.velocity.reset();
    enter(key, object);
    return true;
  });
}

void PlainPublishers::release_parked(std::uint64_t id, Party& party, std::int64_t now_ns) {
  while (!party.parked.empty() && party.parked.front().definitions_through <= party.definitions_seen) {
    apply(id, party, party.parked.front(), now_ns);
    party.parked.pop_front();
  }
}

void PlainPublishers::move(const service::PoseSample& sample, std::int64_t now_ns) {
  Party* party = meet(sample.publisher, sample.incarnation);
  if (party == nullptr) {
    counts.poses_late += sample.object_numbers.size();
    return;
  }
  heard(sample.publisher, *party, WriterKind::pose);
  const std::size_t count = sample.object_numbers.size();
  if (sample.poses.size() != 7 * count || (!sample.velocities.empty() && sample.velocities.size() != 6 * count)) {
    ++counts.batches_malformed;
    return note(*party, sample.sequence, party->newest_pose, now_ns);
  }
  if (sample.definitions_through <= party->definitions_seen) return apply(sample.publisher, *party, sample, now_ns);
  if (party->parked.size() >= limits_.parked_batches) {
    party->parked.pop_front();
    ++counts.batches_dropped;
  }
  party->parked.push_back(sample);
  ++counts.batches_parked;
  // The one that was dropped may have kept others waiting.
  release_parked(sample.publisher, *party, now_ns);
}

void PlainPublishers::apply(std::uint64_t id, Party& party, const service::PoseSample& sample, std::int64_t now_ns) {
  take_said_again(id, party, sample.sequence);
  if ((sample.flags & wire_contract::kPosesAllSaid) != 0) party.said_all = true;
  std::set<std::uint32_t> named;
  bool any = false;
  for (std::size_t i = 0; i < sample.object_numbers.size(); ++i) {
    if (!accept(party, sample, i, named)) continue;
    const std::uint32_t number = sample.object_numbers[i];
    const bool moves = is_in_world({id, number}, party.objects.at(number));
    ++(moves ? counts.poses_applied : counts.poses_unknown);
    any = any || moves;
  }
  note(party, sample.sequence, party.newest_pose, now_ns);
  ++counts.batches_applied;
  if (any) ++changes;
  // A new instant is news for the pairs of other publishers, whatever moved then.
  const bool is_sign_of_life = sample.source_time_ns == 0 && sample.object_numbers.empty() && !party.says_no_times;
  if (!is_sign_of_life) party.says_no_times = sample.source_time_ns <= 0;
  std::set<std::uint64_t> in_world;
  for (const auto& [name, key] : owners_) {
    if (key.first == 0 || parties_.at(key.first).objects.at(key.second).moving) in_world.insert(key.first);
  }
  if (!is_sign_of_life && in_world.size() > 1) ++changes;
}

bool PlainPublishers::accept(Party& party, const service::PoseSample& sample, std::size_t index,
                             std::set<std::uint32_t>& named) {
  const std::uint32_t number = sample.object_numbers[index];
  const auto found = party.objects.find(number);
  if (found == party.objects.end() || found->second.place == Place::gone) {
    ++counts.poses_unknown;
    return false;
  }
  Object& object = found->second;
  if (sample.sequence <= object.posed_by || sample.sequence < object.defined_by) {
    ++(named.contains(number) ? counts.poses_refused : counts.poses_late);
    return false;
  }
  if (!object.moving) {
    ++counts.poses_refused;
    return false;
  }
  named.insert(number);
  object.posed_by = sample.sequence;
  std::copy_n(&sample.poses[7 * index], 7, object.pose.begin());
  object.velocity.reset();
  if (!sample.velocities.empty()) std::copy_n(&sample.velocities[6 * index], 6, object.velocity.emplace().begin());
  return true;
}

void PlainPublishers::writer_lost(std::uint64_t id, WriterKind kind, std::int64_t now_ns) {
  const auto found = parties_.find(id);
  if (found == parties_.end() || found->second.lost) return;
  Party& party = found->second;
  (kind == WriterKind::object ? party.object_writer : party.pose_writer) = false;
  if (party.object_writer || party.pose_writer) return;
  party.lost = true;
  party.lost_ns = now_ns;
  ++changes;  // others wait for it no longer
  for (auto& [number, object] : party.objects) {
    party.is_frozen = party.is_frozen || object.place != Place::gone;
    if (object.place == Place::in_world && object.policy != LostPolicy::hold) object.is_stale = true, ++changes;
  }
}

void PlainPublishers::writer_alive(std::uint64_t id, WriterKind kind) {
  if (const auto found = parties_.find(id); found != parties_.end()) heard(id, found->second, kind);
}

void PlainPublishers::settle(std::int64_t now_ns) {
  for (auto& [id, party] : parties_) {
    if (!party.is_frozen || now_ns - party.lost_ns < limits_.forget_after_ns) continue;
    party.is_frozen = false;
    for (auto& [number, object] : party.objects) {
      if (object.place != Place::in_world || object.policy != LostPolicy::remove) continue;
      leave({id, number}, object);
      object.place = Place::taken_away;
    }
  }
  const std::vector<Key> waiting = std::exchange(waiting_, {});
  for (const Key& key : waiting) {
    const auto party = parties_.find(key.first);
    const bool is_known = party != parties_.end() && party->second.objects.contains(key.second);
    if (!is_known || party->second.objects.at(key.second).place != Place::waits) continue;
    Object& object = party->second.objects.at(key.second);
    if (!party->second.lost) enter(key, object);
    if (object.place == Place::waits && std::find(waiting_.begin(), waiting_.end(), key) == waiting_.end())
      waiting_.push_back(key);
  }
  for (auto& [id, party] : parties_) {
    const bool has_gap = !party.heard.empty() && *party.heard.rbegin() > party.through;
    if (has_gap && now_ns - party.gap_since_ns >= service::SequenceWatermark::kGapPatienceNs)
      party.through = *party.heard.rbegin();
    take_said_again(id, party, party.through + 1);
  }
  for (auto entry = parties_.begin(); entry != parties_.end();) {
    const std::uint64_t id = entry->first;
    Party& party = entry->second;
    const bool is_in_use = std::any_of(party.objects.begin(), party.objects.end(), [&](const auto& object) {
      return is_in_world({id, object.first}, object.second);
    });
    if (!party.lost || now_ns - party.lost_ns < limits_.forgotten_after_ns || is_in_use) {
      ++entry;
      continue;
    }
    for (auto& [number, object] : party.objects) leave({id, number}, object);
    entry = parties_.erase(entry);
  }
}

std::optional<std::pair<std::uint64_t, std::uint32_t>> PlainPublishers::owner(const std::string& name) const {
  const auto found = owners_.find(name);
  return found == owners_.end() ? std::nullopt : std::optional(found->second);
}

std::set<std::uint64_t> PlainPublishers::waiting_for(const std::string& name) const {
  std::set<std::uint64_t> waiting;
  for (const auto& [id, party] : parties_) {
    for (const auto& [number, object] : party.objects) {
      if (object.place == Place::waits && object.name == name) waiting.insert(id);
    }
  }
  return waiting;
}

}  // namespace collided::model
