#include <collided/vcollide.hpp>

#include <iostream>

// As a program for V-COLLIDE has it: two tetrahedra, one of them moved until they are apart.
using namespace collided::vcollide;

namespace {

int add_tetrahedron(VCollide& vc) {
  const double corner[4][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  const int face[4][3] = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
  int id = -1;
  vc.NewObject(&id);
  for (int i = 0; i < 4; ++i) vc.AddTri(corner[face[i][0]], corner[face[i][1]], corner[face[i][2]], i);
  vc.EndObject();
  return id;
}

int object_pairs_at(VCollide& vc, int id, double x) {
  const double trans[4][4] = {{1, 0, 0, x}, {0, 1, 0, 0.1}, {0, 0, 1, 0.1}, {0, 0, 0, 1}};
  VCReport report;
  if (vc.UpdateTrans(id, trans) != VC_OK || vc.Collide(&report, VC_ALL_CONTACTS) != VC_OK) return -1;
  for (int pair = 0; pair < report.numObjPairs(); ++pair) {
    std::cout << report.obj1ID(pair) << " x " << report.obj2ID(pair) << ": " << report.numTriPairs(pair)
              << " pairs of triangles\n";
  }
  return report.numObjPairs();
}

}  // namespace

int main() {
  VCollide vc;
  add_tetrahedron(vc);
  const int moved = add_tetrahedron(vc);
  return object_pairs_at(vc, moved, 0.5) == 1 && object_pairs_at(vc, moved, 1.5) == 0 ? 0 : 1;
}
