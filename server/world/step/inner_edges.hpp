#pragma once

#include <memory>
#include <vector>

#include "server/world/events/contact_ledger.hpp"
#include "server/world/objects/object_rows.hpp"

namespace collided::engine {

/// Fills OpenContact::surface of contacts at the inner edges of a surface that several bodies form with the normal of
/// its face: by the contact's own normal, a ball that rolls from a box onto its neighbour stumbles over the edge
/// between them.
///
/// A contact of a mover with one body takes the normal of its contact with another body when, along that normal, the
/// first body's touched part reaches no farther towards the mover than the other's: then what parts the mover from the
/// other parts it from this one too. Its depth is the push along that normal. Normals are taken only from contacts that
/// could take none themselves, and a contact with the normal of such a one keeps it.
///
/// What counts as no farther: up to the rounding of placing both. Bodies are those with flat faces, of at most 16
/// primitives; a mover with more than 64 such contacts is left as it is.
/// Writer's thread, after all contacts of a step are found.
void correct_inner_edges(const ObjectRows& rows, const std::vector<std::shared_ptr<const StaticScene>>& scenes,
                         ContactLedger& ledger);

}  // namespace collided::engine
