#pragma once

#include <string>

#include "server/world/query/query.hpp"

namespace collided::engine {

/// Decides one answer again and compares: every part of every object in rational arithmetic alone, without index,
/// filter or floating point. Passes over parts that a plain and generous comparison shows to be far off.
///
/// question  one question, as the client sent it
/// given     its answer: answers, reasons and hits of that question alone
/// returns   what differs, as a sentence with the question's numbers; empty where nothing does. An `undecided` answer
/// claims nothing and differs from nothing
/// cost      some microseconds per part near the question, some nanoseconds per other part; allocates
/// threads   any
std::string audit(const Snapshot& snapshot, const Questions& question, const Answers& given);

}  // namespace collided::engine
