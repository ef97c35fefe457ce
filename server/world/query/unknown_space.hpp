#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "server/world/query/question.hpp"

namespace collided::engine {

/// Objects of which it is not known what is in them, as one filter lets them count, and memory to ask about them.
struct UnknownSpace {
  SlotMarks objects;
  std::vector<std::uint8_t> scenes;  // by scene: 0, no part of one is such an object
  bool is_any = false;
  std::vector<AnswerHit> found;
};

/// Whether a miss, or a nearest hit, claims something about unknown space: all that the question covers, up to the least
/// distance of the nearest hit where there is one, must be apart from it. The same exact tests decide that find hits;
/// touching counts as reaching in.
///
/// numbers  of the question, which is answered; nodes and tests are added to its own
/// returns  where it reaches in, or nothing
/// threads  one a scratch; no allocation once its memory has grown
std::optional<Leaving> reaches_unknown(Question& question, const double* numbers, UnknownSpace& unknown);

/// A point of unknown space within a distance of one of the boxes; nothing where there is surely none. Empty boxes are
/// near nothing.
std::optional<Vec3> unknown_near(const Snapshot& snapshot, std::span<const Aabb> boxes, double distance_m);

}  // namespace collided::engine
