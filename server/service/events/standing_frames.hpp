#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <unordered_map>

#include <collided/codes.hpp>

#include "idl/messages.hpp"
#include "server/service/events/frames.hpp"
#include "server/world/world.hpp"

namespace collided::engine::service {

using codes::StandingEventKind;
using codes::StandingForm;

/// What the events of a standing question need to know of it, which may be removed before its last event is written.
struct AskedStanding {
  std::string name;
  StandingForm form = StandingForm::region;
  std::uint8_t detects = 0;  // of a region: codes::kDetect... bits
  double band_m = 0;         // of a band
  bool is_widest = false;    // of a band: it is the margin's widest
  ObjectId about = 0;        // of a band: the object that has it
};

/// The standing questions that hold for some object, and the names of both.
class StandingBook {
 public:
  /// To be called with each event that begins before its frame is written, and forget() with each that ended afterwards.
  void note(const OpenContact& of, const World& world);
  void forget(const OpenContact& of);
  /// Of a question that was noted.
  const AskedStanding& asked(ObjectId standing) const { return asked_.at(standing).asked; }
  /// Of an object or a question; empty where it was not noted.
  std::string_view name(ObjectId id) const;

 private:
  struct Entry {
    AskedStanding asked;
    std::uint32_t holds = 0;
  };
  std::unordered_map<ObjectId, Entry> asked_;
  NameBook objects_;
};

struct StandingColumns : wire::StandingFrameColumns {
  std::uint64_t first_sequence = 0;  // of the first event

  /// next       the event that this one joins; null: it joins none
  /// is_merged  poses of an object were merged on the way (kDoubtPosesMerged)
  void add(const Event& event, const Event* next, const StandingBook& book, bool is_merged);
  std::size_t size() const { return kinds.size(); }
};

struct StandingStateColumns : wire::StandingShardColumns {
  std::uint8_t shard = 0;
  // Of the shard kStandingSum.
  wire_contract::ServerState state = wire_contract::ServerState::starting;
  std::uint32_t count = 0;
  std::uint64_t hash = 0;

  void add(const OpenContact& open, const StandingBook& book);
  std::size_t size() const { return objects.size(); }
  /// About what the shard takes in a message, without its fixed fields.
  std::size_t bytes() const;
};

}  // namespace collided::engine::service
