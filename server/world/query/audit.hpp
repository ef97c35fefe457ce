#pragma once

#include <string>

#include "server/world/query/query.hpp"

namespace collided::engine {

/// Works one answer out again and compares: every part of every object by rationals alone, without index, filter or
/// float. Parts that are far off by a plain and generous comparison are passed over.
///
/// question  one question, as it was asked
/// given     its answer: answers, reasons and hits of that question alone
/// returns   what differs, as a sentence with the question's numbers; empty where nothing does. An `undecided` answer
///           claims nothing and differs from nothing
/// cost      some microseconds a part near the question, some nanoseconds each of the others; allocates
/// threads   any
std::string audit(const Snapshot& snapshot, const Questions& question, const Answers& given);

}  // namespace collided::engine
