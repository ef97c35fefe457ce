#pragma once

#include <string>

#include "server/geometry/mesh.hpp"

/// A mesh as the text or the bytes of a file, to be read back: numbers with nine digits, floats in STL.
namespace collided::scenes {
using namespace engine;

std::string obj_file(const TriangleMesh& mesh);
std::string off_file(const TriangleMesh& mesh);
std::string stl_file(const TriangleMesh& mesh);  // binary
std::string ply_file(const TriangleMesh& mesh);  // binary, little endian, doubles

}  // namespace collided::scenes
