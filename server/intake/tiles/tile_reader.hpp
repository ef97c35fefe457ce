#pragma once

#include "server/intake/readers/reading.hpp"

namespace collided::engine {

/// Reads an untrusted tile file (.ctiles): all of it, or the tiles with some content of options.within.
///
/// A part that lies in one tile is read whole if its box reaches into the requested one, and so are the parts that
/// options.needed_whole names. From other parts those triangles are read that reach into the box; they keep their
/// numbers in the whole part, and their order. The selection depends on the box alone. The mesh of all tiles is the one
/// from which they were made, without unused vertices.
///
/// cost     memory and time depend on what is read; memory is given back tile by tile
/// throws   LoadError: nothing is left out silently
Scene read_tiles(const Reading& reading);

}  // namespace collided::engine
