#include <cfenv>
#include <cinttypes>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <random>

#include "server/exact_phase/distance/closest.hpp"
#include "server/exact_phase/distance/contact.hpp"
#include "server/exact_phase/motion/time_of_contact.hpp"
#include "server/exact_phase/overlap/overlap.hpp"
#include "server/exact_phase/ray/ray_cast.hpp"
#include "tests/accuracy/census/pair_inputs.hpp"
#include "tests/accuracy/census/ray_inputs.hpp"

namespace collided::census {
using namespace engine;
namespace {

/// Of every decision and the bits of every number, in order. (Fowler, Noll, Vo; 1a.)
class Hash {
 public:
  void add(double number) {
    unsigned char bytes[sizeof number];
    std::memcpy(bytes, &number, sizeof number);
    for (const unsigned char byte : bytes) add_byte(byte);
  }
  void add(const Vec3& v) {
    for (const double x : v) add(x);
  }
  void add(const ExactResult& v) {
    add_byte(static_cast<unsigned char>(v.decision));
    add_byte(static_cast<unsigned char>(v.level));
  }
  std::uint64_t value() const { return value_; }

 private:
  void add_byte(unsigned char byte) { value_ = (value_ ^ byte) * 0x100000001b3u; }

  std::uint64_t value_ = 0xcbf29ce484222325u;
};

template <class MakeCase>
void ask_rays(Hash& hash, Maker& make, const Placing& at, MakeCase make_case) {
  const auto input = make_case(make);
  RayHit hit;
  const ExactResult verdict = cast_ray(placed(input.first, at), placed(input.second, at), hit);
  hash.add(verdict);
  if (!verdict.yes()) return;
  for (const double number : {hit.distance_m, hit.distance_error_m, hit.exit_m, hit.exit_error_m}) hash.add(number);
  hash.add(hit.point);
  hash.add(hit.normal);
  hash.add(hit.weights);
}

template <class MakeCase>
void ask_pairs(Hash& hash, Maker& make, const Placing& at, MakeCase make_case) {
  const auto [a, b] = make_case(make);
  const auto shape_a = placed(a, at);
  const auto shape_b = placed(b, at);
  const ExactResult verdict = overlaps(shape_a, shape_b);
  hash.add(verdict);
  if (!verdict.yes()) return;
  const Contact found = contact(shape_a, shape_b);
  hash.add(found.depth_m);
  hash.add(found.depth_error_m);
  hash.add(found.normal);
  hash.add(found.point);
}

template <class Shape>
void ask_point(Hash& hash, const Vec3& point, const Vec3& end, const Shape& shape) {
  const Closest found = closest(point, shape);
  hash.add(found.distance_m);
  hash.add(found.distance_error_m);
  hash.add(found.point);
  hash.add(found.point_error_m);
  hash.add(found.normal);
  TimeBracket bracket;
  hash.add(first_contact(MovingSphere{point, end, 1000 * std::abs(point[0] - end[0])}, shape, 1e-9, bracket));
  hash.add(bracket.low);
  hash.add(bracket.high);
}

void ask_all(Hash& hash, Maker& make, const Placing& at) {
  ask_rays(hash, make, at, triangle_case);
  ask_rays(hash, make, at, ball_case);
  ask_rays(hash, make, at, box_case);
  ask_rays(hash, make, at, pill_case);
  ask_pairs(hash, make, at, ball_ball);
  ask_pairs(hash, make, at, ball_box);
  ask_pairs(hash, make, at, ball_pill);
  ask_pairs(hash, make, at, ball_triangle);
  ask_pairs(hash, make, at, box_box);
  ask_pairs(hash, make, at, box_pill);
  ask_pairs(hash, make, at, box_triangle);
  ask_pairs(hash, make, at, pill_pill);
  ask_pairs(hash, make, at, pill_triangle);
  ask_pairs(hash, make, at, triangle_triangle);
  const Vec3 point = at.point(make.point());
  const Vec3 end = at.point(make.point());
  ask_point(hash, point, end, placed(make.ball(), at));
  ask_point(hash, point, end, placed(make.box(), at));
  ask_point(hash, point, end, placed(make.pill(), at));
  ask_point(hash, point, end, placed(make.triangle(), at));
}

int run(int argc, char** argv) {
  bool traps = false;
  const char* expected = nullptr;
  for (int i = 1; i < argc; ++i) {
    if (std::strcmp(argv[i], "--traps") == 0) traps = true;
    else if (std::strcmp(argv[i], "--expect") == 0 && i + 1 < argc) expected = argv[++i];
    else return std::fprintf(stderr, "usage: bits [--traps] [--expect HASH]\n"), 2;
  }
  // A trap ends the process with SIGFPE, at the operation that raised it.
  if (traps) feenableexcept(FE_INVALID | FE_DIVBYZERO);
  std::mt19937_64 generator(20261123);
  Hash hash;
  for (const Family family : kAllFamilies) {
    Maker make(generator, family);
    for (int i = 0; i < 400; ++i) {
      Placing at = make.placing();
      // Sizes of 1e-12 to 1e19 m. Far beyond, products of up to twelve lengths overflow, on purpose: the bound becomes
      // infinite or not a number, and the question goes to the next rung (the far family counts that in the census).
      if (traps) at.power = std::clamp(at.power, -60, 40);
      ask_all(hash, make, at);
    }
  }
  std::printf("%016" PRIx64 "\n", hash.value());
  if (expected == nullptr || hash.value() == std::strtoull(expected, nullptr, 16)) return 0;
  std::fprintf(stderr, "expected %s\n", expected);
  return 1;
}

}  // namespace
}  // namespace collided::census

/// One number that stands for every bit of a fixed mix of questions: the same from any compiler, level and thread.
int main(int argc, char** argv) { return collided::census::run(argc, argv); }
