#pragma once

#include "server/intake/readers/reading.hpp"

namespace collided::engine {

/// Reads a tile file (.ctiles), from anyone: all of it, or the tiles that have something of what options.within asks for.
///
/// A part of which one tile has everything is read as a whole where its box comes into the asked one, and so are the parts
/// that options.needed_whole names. Of other parts those triangles are read that come into the box; they keep the numbers
/// that they have in the whole part, and their order. Which ones these are depends on the box alone, and the mesh of
/// all tiles is the one that they were made of, without vertices that no triangle has.
///
/// cost     memory and time go by what is read; bytes that are read are given back tile by tile
/// throws   LoadError: nothing is left out in silence
Scene read_tiles(const Reading& reading);

}  // namespace collided::engine
