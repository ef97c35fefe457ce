#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <utility>

#include "client/library/watching/watch_state.hpp"

namespace collided::test {

using client::HeardBookmark;
using client::HeardFrame;
using client::HeardShard;
using client::ServerLife;
using Pair = std::pair<std::uint64_t, std::uint64_t>;

/// A server's contacts, told as a real one tells them. Names of a pair stay from life to life; ids change.
class Model {
 public:
  explicit Model(std::uint64_t epoch, std::uint64_t server = 1) : life_{server, epoch} {}

  HeardFrame began(Pair pair) {
    contacts_[pair] = ++sequence_;
    return frame(EventKind::began, EndReason::none, pair, sequence_);
  }
  HeardFrame contained(Pair pair, Containment which) {
    within_[pair] = which;
    ++sequence_;
    return frame(EventKind::contained, EndReason::none, pair, contacts_.at(pair));
  }
  HeardFrame emerged(Pair pair) {
    ++sequence_;
    HeardFrame heard = frame(EventKind::emerged, EndReason::none, pair, contacts_.at(pair));
    within_.erase(pair);
    return heard;
  }
  /// As a server does, what lies within emerges first.
  HeardFrame ended(Pair pair, EndReason why = EndReason::separated) {
    const std::uint64_t episode = contacts_.at(pair);
    contacts_.erase(pair);
    within_.erase(pair);
    ++sequence_;
    return frame(EventKind::ended, why, pair, episode);
  }
  HeardFrame persisted(Pair pair) const {
    HeardFrame heard = frame(EventKind::persisted, EndReason::none, pair, contacts_.at(pair));
    heard.first_sequence = 0;
    return heard;
  }
  HeardShard shard(Pair pair) const { return shard(shard_of(pair)); }
  HeardShard shard(std::uint8_t number) const {
    HeardShard shard{life_, number, sequence_, {}};
    for (const auto& [pair, episode] : contacts_) {
      if (shard_of(pair) == number) {
        shard.contacts.push_back(event(EventKind::open, EndReason::none, pair, episode));
      }
    }
    return shard;
  }
  HeardBookmark bookmark(bool settled = true) const {
    HeardBookmark bookmark{life_, sequence_, static_cast<std::uint32_t>(contacts_.size()), 0, {}, settled};
    for (const auto& [pair, episode] : contacts_) {
      bookmark.contact_hash += wire_contract::contact_hash(id(pair.first), id(pair.second), episode);
    }
    return bookmark;
  }
  const std::map<Pair, std::uint64_t>& contacts() const { return contacts_; }
  std::uint8_t shard_of(Pair pair) const { return wire_contract::contact_shard(id(pair.first), id(pair.second)); }

 private:
  std::uint64_t id(std::uint64_t object) const { return object + life_.epoch * 1'000; }
  Event event(EventKind what, EndReason why, Pair pair, std::uint64_t episode) const {
    Event made;
    made.kind = what;
    made.reason = why;
    made.a = std::to_string(pair.first);
    made.b = std::to_string(pair.second);
    made.a_id = id(pair.first);
    made.b_id = id(pair.second);
    made.episode = episode;
    if (const auto within = within_.find(pair); within != within_.end()) made.contained = within->second;
    return made;
  }
  HeardFrame frame(EventKind what, EndReason why, Pair pair, std::uint64_t episode) const {
    return {life_, sequence_, {{event(what, why, pair, episode), shard_of(pair)}}};
  }

  ServerLife life_;
  std::map<Pair, std::uint64_t> contacts_;
  std::map<Pair, Containment> within_;
  std::uint64_t sequence_ = 0;
};

}  // namespace collided::test
