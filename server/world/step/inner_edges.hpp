#pragma once

#include <memory>
#include <vector>

#include "server/world/events/contact_ledger.hpp"
#include "server/world/objects/object_rows.hpp"
#include "server/world/step/step_motion.hpp"

namespace collided::engine {

/// True if flat faces of the object may form one surface with those of other bodies: a mesh, or a few primitives of
/// which some have faces.
bool has_flat_faces(const ObjectInfo& info);

/// Corrects contacts at inner edges of a surface made of several bodies: they get the normal of the face. Otherwise a
/// ball that rolls from a box onto its neighbour would stumble over the edge between them.
///
/// A mover's contact with one body takes the normal of its contact with another if, along that normal, the first body's
/// touched part reaches no farther towards the mover than the other's: then what separates the mover from the other
/// separates it from this one too. Its depth becomes the translation needed along the new normal. Only contacts that
/// take no normal pass theirs on, and a contact with the same normal as such a contact keeps its own.
///
/// limits   "no farther" allows for the rounding of placing both. Bodies count if they have flat faces and at most 16
///          primitives; a mover with more than 64 such contacts is not corrected
/// cost     proportional to the objects with a contact found in this step, and to their contacts at flat faces
/// threads  the writer, after all contacts of a step are found
void correct_inner_edges(const ObjectRows& rows, const StepMotion& motion, const SceneList& scenes,
                         ContactLedger& ledger);

}  // namespace collided::engine
