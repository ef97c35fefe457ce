#pragma once

#include <cstdint>
#include <functional>
#include <random>
#include <string>
#include <vector>

#include "server/geometry/mesh.hpp"
#include "server/geometry/ray.hpp"

namespace collided::census {
using namespace engine;

class Table;

/// A library that answers the same question; empty where the distribution does not have it.
struct Peer {
  std::string name;
  std::function<bool(const Ray&)> meets;
};

std::vector<Peer> closed_mesh_peers(const TriangleMesh& mesh);

/// FCL's distance between two turned boxes of a micrometre, counted as missed when it is more than 1 % off.
void count_fcl_distances(Table& table, int count, std::mt19937_64& random);

}  // namespace collided::census
