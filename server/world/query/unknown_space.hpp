#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "server/world/query/question.hpp"

namespace collided::engine {

/// Objects with unknown content that count for one filter, with memory for tests against them.
struct UnknownSpace {
  SlotMarks objects;
  std::vector<std::uint8_t> scenes;  // by scene; 0: none of its parts is such an object
  bool is_any = false;
  std::vector<AnswerHit> found;
};

/// Whether a miss, or a nearest hit, depends on unknown space: the whole space of the question, up to the least
/// distance of the nearest hit if there is one, must be apart from it. Decided by the same exact tests as hits;
/// touching counts as reaching in.
///
/// numbers  of the question, which is answered; nodes and tests are added to its own
/// returns  where it reaches in, or nothing
/// threads  one per scratch; no allocation once its memory has grown
std::optional<Leaving> reaches_unknown(Question& question, const double* numbers, UnknownSpace& unknown);

/// A point of unknown space within a distance of one of the boxes; nothing if there certainly is none. Empty boxes are
/// near nothing.
std::optional<Vec3> unknown_near(const Snapshot& snapshot, std::span<const Aabb> boxes, double distance_m);

}  // namespace collided::engine
