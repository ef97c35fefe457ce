#include <cstdio>
#include <cstdlib>

#include "server/geometry/tolerance.hpp"

/// The constants as the product has them, for the proofs: one sed command each. Given a factor, times that: what must
/// not be provable any more.
int main(int argc, char** argv) {
  using namespace collided::engine;
  const double factor = argc > 1 ? std::atof(argv[1]) : 1;
  const auto print = [factor](const char* name, double value) { std::printf("s/@%s@/%a/g\n", name, factor * value); };
  print("TRIPLE", kTripleProductError);
  print("TURN", kTurnError);
  print("SEPARATION", kSeparationError);
  print("ORIENTATION", kOrientationError);
  print("SLACK", kBoundSlack);
  print("POINT_ON_RAY", kPointOnRay);
  print("POINT_SUM", kPointSum);
  std::printf("s/@U@/%a/g\n", kRoundoff);
  return 0;
}
