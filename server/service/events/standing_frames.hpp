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

/// Facts about a standing question for its events, kept since it may be removed before the last one is written.
struct AskedStanding {
  std::string name;
  StandingForm form = StandingForm::region;
  std::uint8_t detects = 0;  // of a region: codes::kDetect... bits
  double band_m = 0;         // of a band
  bool is_widest = false;    // of a band: it is the margin's widest
  ObjectId about = 0;        // of a band: its owner
};

/// The standing questions that hold an object, and the names of both.
class StandingBook {
 public:
  /// Call this with each event that begins before its frame is written, and forget() with each that ended afterwards.
  void note(const OpenContact& of, const World& world);
  void forget(const OpenContact& of);
  /// For a noted question.
  const AskedStanding& asked(ObjectId standing) const { return asked_.at(standing).asked; }
  /// For an object or a question; empty if it was not noted.
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

  /// next       the event that this one joins; null: none
  /// is_merged  poses of an object were merged on the path (kDoubtPosesMerged)
  void add(const Event& event, const Event* next, const StandingBook& book, bool is_merged);
  std::size_t size() const { return kinds.size(); }
};

struct StandingStateColumns : wire::StandingShardColumns {
  std::uint8_t shard = 0;
  // For the shard kStandingSum.
  wire_contract::ServerState state = wire_contract::ServerState::starting;
  std::uint32_t count = 0;
  std::uint64_t hash = 0;

  void add(const OpenContact& open, const StandingBook& book);
  std::size_t size() const { return objects.size(); }
  /// Approximate size of the shard in a message, without its fixed fields.
  std::size_t bytes() const;
};

}  // namespace collided::engine::service
