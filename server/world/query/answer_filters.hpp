#pragma once

#include <cstdint>
#include <limits>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "server/world/objects/slot_marks.hpp"
#include "server/world/objects/snapshot.hpp"

namespace collided::engine {

struct Questions;     // query.hpp
struct UnknownSpace;  // unknown_space.hpp

/// True if layers and name patterns let the object answer.
bool may_answer(const ObjectInfo& info, const Questions& asked);

/// Marks the scenes with all parts marked, so that walks through them need not test single parts.
void mark_open_scenes(const SceneList& scenes, const std::vector<std::uint8_t>& marks, std::vector<std::uint8_t>& open);

/// Which objects and scenes may answer questions with one mask and one pair of name patterns, in one state of the
/// world.
struct AnswerFilter {
  SlotMarks allowed;
  std::vector<std::uint8_t> open_scenes;  // by scene: every part of it may answer
  bool all_open = false;                  // for every scene
  bool has_solids = false;                // for any scene
  std::shared_ptr<UnknownSpace> unknown;  // null: there never was any

  // The questions and the state that it is for.
  static constexpr std::uint64_t kNoVersion = std::numeric_limits<std::uint64_t>::max();
  std::uint64_t table_version = kNoVersion;
  std::uint64_t parts_version = kNoVersion;
  std::uint32_t mask = 0;
  std::string only, skip;
  std::uint64_t used_at = 0;  // counted in uses of other filters

  std::size_t bytes() const;
};

/// The filters that one thread used last. An object added or removed costs each filter one chunk of slots at its next
/// use, not a pass over all names.
/// Always: current() is the last one taken; at most kMost filters, of which those not current take at most kMostBytes.
class AnswerFilters {
 public:
  static constexpr std::size_t kMost = 16;
  static constexpr std::size_t kMostBytes = 8 << 20;

  /// Makes the questions' filter the current one, for the snapshot. cost: see AnswerFilters; all names for a new
  /// filter.
  void take(const Snapshot& snapshot, const Questions& asked);
  const AnswerFilter& current() const { return current_; }
  AnswerFilter& current() { return current_; }

  std::size_t count() const { return others_.size() + (current_.table_version == AnswerFilter::kNoVersion ? 0 : 1); }
  std::size_t bytes() const;
  /// Number of filters that were replaced by others.
  std::uint64_t dropped() const { return dropped_; }

 private:
  void switch_to(const Questions& asked);
  void keep_within_bytes();

  AnswerFilter current_;
  std::vector<AnswerFilter> others_;
  std::uint64_t uses_ = 0;
  std::uint64_t dropped_ = 0;
};

}  // namespace collided::engine
