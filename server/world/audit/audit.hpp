#pragma once

#include <string>

#include "server/world/query/query.hpp"

namespace collided::engine {

/// Decides one answer again and compares: every part of every object in rational arithmetic alone, without index,
/// filter or floating point. Skips parts that a simple and generous comparison shows to be far off.
///
/// question  one question, as the client sent it
/// given     its answer, with reasons and hits, for that question alone
/// returns   what differs, as a sentence with the question's numbers; empty if nothing does. An `undecided` answer
///           claims nothing and never differs
/// cost      some microseconds per part near the question, some nanoseconds per other part; allocates
/// threads   any
std::string audit(const Snapshot& snapshot, const Questions& question, const Answers& given);

}  // namespace collided::engine
