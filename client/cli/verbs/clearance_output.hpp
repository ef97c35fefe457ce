#pragma once

#include <collided/client.hpp>

#include "client/cli/output/output.hpp"

namespace collided::cli {

/// Prints the pairs as records, or as the rows of a table for people.
///
/// with_proof  certificates were requested, and the received ones prove their answers
void print_clearance(Printer& printer, const ClearanceAnswer& answer, bool with_proof);

/// "apart", "touching" or "undecided"; "inside" if one lies within the other, a solid.
std::string_view state_of(const ClearancePair& pair);

}  // namespace collided::cli
