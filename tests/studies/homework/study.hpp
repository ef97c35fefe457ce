#pragma once

#include <string>
#include <vector>

#include "tests/studies/homework/method.hpp"
#include "tests/studies/homework/slope.hpp"

namespace collided::homework {
using namespace engine;

enum class Sweep { objects, polygons, size };
inline constexpr Sweep kSweeps[] = {Sweep::objects, Sweep::polygons, Sweep::size};
const char* name(Sweep sweep);

struct StudyOptions {
  std::uint64_t seed = 2000;
  bool quick = false;
  std::vector<MakeMethod> methods;  // the first is the one that the others' pairs are compared with
};

/// One method on one recording.
struct Point {
  Sweep sweep = Sweep::objects;
  double x = 0;  // objects, polygons of an object, or relative size
  Problem problem;
  std::size_t polygons = 0;  // that an object really has
  std::string method;
  std::size_t repeats = 0;
  double median_us = 0;  // a frame
  double p95_us = 0;
  double mean_us = 0;
  double contacts = 0;  // pairs of objects that meet, mean of a frame
  double candidates = 0;
  double polygon_pairs = -1;    // mean of a frame; -1: the method does not tell
  std::size_t pairs_equal = 0;  // over all frames, with the first method
  std::size_t wrong = 0;        // pairs missed or false, by the exact oracle
  std::size_t first_wrong = 0;  // the same of the first method
};

/// Where a sweep measures, and what at each place.
std::vector<double> places_of(Sweep sweep, bool quick);
Problem problem_at(Sweep sweep, double x, std::uint64_t seed, bool quick);

/// All three sweeps: 1 to 50 objects and on to 100,000 with the density of 50; polygons; relative size.
/// A method whose frame takes too long is left out of the rest of its sweep.
std::vector<Point> run_study(const StudyOptions& options);

/// Whether two objects' polygons share a point, in rationals, every pair of polygons whose boxes do.
bool meet_exactly(const Recording& recording, const std::vector<Pose>& poses, std::uint32_t a, std::uint32_t b);

/// Pairs that one has and the other has not, judged: how many of them each is wrong about.
struct Judgement {
  std::size_t first_wrong = 0;
  std::size_t wrong = 0;
};
Judgement judge(const Recording& recording, const std::vector<Pose>& poses, const ObjectPairs& first,
                const ObjectPairs& other);

/// Time of a method against x within [low, high]: its mean, since where few objects meet the median frame has no
/// contact.
Slope slope_of(const std::vector<Point>& points, Sweep sweep, const std::string& method, double low, double high);

/// Each in order of appearance.
std::vector<std::string> methods_of(const std::vector<Point>& points);

}  // namespace collided::homework
