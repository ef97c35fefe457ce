#include "server/programs/import/assimp_scene.hpp"

// Replaces assimp_scene.cpp in a build without Assimp.
namespace collided::engine {

Scene read_with_assimp(const std::string&, const LoadOptions&, LoadReport&) {
  throw LoadError("this build has no Assimp, which alone reads this format");
}

}  // namespace collided::engine
