// Spheres and boxes against a mesh (any triangle, all triangles, the deepest contact) and the closest point: the
// product's exact path beside the libraries of the distribution, in turn in one run.

#include <cmath>
#include <cstdio>
#include <random>

#include "server/exact_phase/distance/closest.hpp"
#include "server/exact_phase/exactly.hpp"
#include "server/exact_phase/overlap/overlap.hpp"
#include "server/world/objects/scene_touch.hpp"
#include "server/world/query/query.hpp"
#include "tests/oracle/seed.hpp"
#include "tests/scenes/meshes.hpp"
#include "tests/studies/bench/obj.hpp"
#include "tests/studies/bench/peers/overlap_peers.hpp"
#include "tests/studies/bench/rows.hpp"
#include "tests/studies/bench/scene_answers.hpp"

namespace collided::bench {
using namespace engine;
namespace {

using MakePeer = std::unique_ptr<OverlapPeer> (*)(const TriangleMesh&);
const std::vector<MakePeer> kPeers{
#ifdef COLLIDED_BENCH_EMBREE
    embree_peer,
#endif
#ifdef COLLIDED_BENCH_BULLET
    bullet_peer,
#endif
#ifdef COLLIDED_BENCH_CGAL
    cgal_peer,
#endif
#ifdef COLLIDED_BENCH_FCL
    fcl_peer,
#endif
#ifdef COLLIDED_BENCH_ODE
    ode_peer,
#endif
};

enum class Set { sphere, box };

struct Places {
  std::vector<Vec3> centers;
  double radius_m = 0;
  Vec3 half_m = Vec3::Zero();
};

/// Numbers, each once.
class Marks {
 public:
  explicit Marks(std::size_t size) : words_(size / 64 + 1) {}
  void add(std::uint32_t number) {
    std::uint64_t& word = words_[number / 64];
    const std::uint64_t bit = std::uint64_t{1} << number % 64;
    if ((word & bit) == 0) list_.push_back(number);
    word |= bit;
  }
  /// How many they were.
  long clear() {
    for (const std::uint32_t number : list_) words_[number / 64] = 0;
    const auto count = static_cast<long>(list_.size());
    list_.clear();
    return count;
  }

 private:
  std::vector<std::uint64_t> words_;
  std::vector<std::uint32_t> list_;
};

/// Triangles met, by the tree and the exact phase; a triangle that the tree names twice counts once.
template <class Asked>
long count_met(const StaticScene& scene, const Asked& asked, Marks& met) {
  WalkCost cost;
  const auto decide = [&](std::uint32_t triangle) {
    if (overlaps(asked, scene.mesh.triangle(triangle)).yes()) met.add(triangle);
    return true;
  };
  if constexpr (std::is_same_v<Asked, Sphere>) {
    const auto decide_near = [&](std::uint32_t triangle, double limit_m2) {
      decide(triangle);
      return limit_m2;
    };
    scene.tree.walk_near(asked.center, square_up(asked.radius_m), 0, decide_near, cost);
  } else {
    scene.tree.walk_box(bounds(asked), decide, cost);
  }
  return met.clear();
}

long met_by_force(const TriangleMesh& mesh, const Vec3& center, double radius_m, const Vec3& half_m, Set set) {
  const Vec3 reach = set == Set::sphere ? Vec3::Constant(radius_m) : half_m;
  const Aabb around{center - 1.001 * reach, center + 1.001 * reach};
  long count = 0;
  for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i) {
    const Triangle t = mesh.triangle(i);
    if (!overlaps(around, bounds(t))) continue;
    const Decision met = set == Set::sphere ? exactly::overlaps(Sphere{center, radius_m}, t)
                                            : exactly::overlaps(Box{.center = center, .half_m = half_m}, t);
    count += met == Decision::yes ? 1 : 0;
  }
  return count;
}

std::vector<double> numbers_of(const Places& places, Set set) {
  std::vector<double> numbers;
  for (const Vec3& c : places.centers) {
    numbers.insert(numbers.end(), c.begin(), c.end());
    if (set == Set::sphere) {
      numbers.push_back(places.radius_m);
    } else {
      numbers.insert(numbers.end(), places.half_m.begin(), places.half_m.end());
      numbers.insert(numbers.end(), {1, 0, 0, 0});
    }
  }
  return numbers;
}

/// Around points of the surface, up to `away_m` off it.
std::vector<Vec3> places_near(const TriangleMesh& mesh, std::size_t count, double away_m, std::mt19937_64& random) {
  std::uniform_real_distribution<double> part(-1, 1);
  std::vector<Vec3> places;
  for (std::size_t i = 0; i < count; ++i) {
    const Triangle t = mesh.triangle(static_cast<std::uint32_t>(random() % mesh.triangles.size()));
    const double x = part(random);
    const double y = part(random);
    const Vec3 shift(x, y, part(random));
    // Single-precision coordinates, so that every library gets the same question.
    places.push_back(((t.a + t.b + t.c) / 3 + away_m * shift).cast<float>().cast<double>());
  }
  return places;
}

std::vector<Vec3> places_in(const Aabb& bounds, std::size_t count, std::mt19937_64& random) {
  std::vector<Vec3> places;
  for (std::size_t i = 0; i < count; ++i) {
    Vec3 place;
    for (int axis = 0; axis < 3; ++axis) {
      place[axis] = std::uniform_real_distribution<double>(bounds.low[axis], bounds.high[axis])(random);
    }
    places.push_back(place.cast<float>().cast<double>());
  }
  return places;
}

class Bench {
 public:
  Bench(const Options& options, std::string scene, const TriangleMesh& mesh)
      : options_(options), scene_(std::move(scene)), mesh_(mesh), product_(mesh) {
    for (const auto& make : kPeers) peers_.push_back(make(mesh));
  }
  void run(std::mt19937_64& random);

 private:
  void overlap(Set set, bool any, const Places& places);
  void deepest(Set set, const Places& places);
  void closest(const std::string& name, const std::vector<Vec3>& places);

  const Options& options_;
  std::string scene_;
  const TriangleMesh& mesh_;
  SceneAnswers product_;
  std::vector<std::unique_ptr<OverlapPeer>> peers_;
  Marks met_{mesh_.triangles.size()};
};

/// "any" is asked of the product as a client does; "all" lists triangles, which the product does for itself.
void Bench::overlap(Set set, bool any, const Places& places) {
  const std::string name = std::string(set == Set::sphere ? "sphere" : "box") + (any ? " any" : " all");
  if (!options_.wants(scene_, name)) return;
  const std::size_t count = places.centers.size();
  const std::vector<double> numbers = numbers_of(places, set);
  std::vector<long> ours(count);
  const auto run_ours = [&] {
    if (any) {
      const Answers& answers =
          product_.ask(set == Set::sphere ? QuestionKind::sphere : QuestionKind::box, HitMode::any, numbers, 1);
      for (std::size_t i = 0; i < count; ++i) ours[i] = answers.answers[i] == Verdict::hit ? 1 : 0;
      return;
    }
    for (std::size_t i = 0; i < count; ++i) {
      const Vec3& c = places.centers[i];
      ours[i] = set == Set::sphere ? count_met(product_.scene(), Sphere{c, places.radius_m}, met_)
                                   : count_met(product_.scene(), Box{.center = c, .half_m = places.half_m}, met_);
    }
  };
  run_ours();
  constexpr std::size_t kForced = 50;
  std::vector<Method> methods{{.name = "collided", .run = run_ours, .bytes_each = product_.bytes_a_triangle()}};
  for (std::size_t i = 0; i < std::min(count, kForced); ++i) {
    const long truth = met_by_force(mesh_, places.centers[i], places.radius_m, places.half_m, set);
    methods[0].equal += (any ? std::min(truth, 1L) : truth) == ours[i] ? 1 : 0;
    ++methods[0].of;
  }
  double met = 0;
  for (const long m : ours) met += static_cast<double>(m);
  std::vector<long> theirs(count);
  for (const auto& peer : peers_) {
    const auto ask = [&, p = peer.get()](std::size_t i) {
      const Vec3& c = places.centers[i];
      return set == Set::sphere ? p->sphere(c, places.radius_m, any) : p->box(c, places.half_m, any);
    };
    if (ask(0) == kCannot) continue;
    Method method{.name = peer->name(), .run = [ask, count, &theirs] {
                    for (std::size_t i = 0; i < count; ++i) theirs[i] = ask(i);
                  }};
    method.run();
    for (std::size_t i = 0; i < count; ++i) method.equal += theirs[i] == ours[i] ? 1 : 0;
    method.of = count;
    methods.push_back(std::move(method));
  }
  char note[60];
  std::snprintf(note, sizeof note, "%.1f triangles met", met / static_cast<double>(count));
  measure(options_, {scene_, mesh_.triangles.size(), name, count, note}, methods);
}

/// What a client gets: yes or no with the deepest contact.
void Bench::deepest(Set set, const Places& places) {
  const std::string name = std::string(set == Set::sphere ? "sphere" : "box") + " deepest contact";
  if (!options_.wants(scene_, name)) return;
  const std::vector<double> numbers = numbers_of(places, set);
  const QuestionKind kind = set == Set::sphere ? QuestionKind::sphere : QuestionKind::box;
  std::vector<Method> methods{
      {.name = "collided", .run = [&] { product_.ask(kind, HitMode::closest, numbers, 1000); }}};
  measure(options_, {scene_, mesh_.triangles.size(), name, places.centers.size(), ""}, methods);
}

void Bench::closest(const std::string& name, const std::vector<Vec3>& places) {
  if (!options_.wants(scene_, name)) return;
  std::vector<double> numbers;
  for (const Vec3& p : places) {
    numbers.insert(numbers.end(), p.begin(), p.end());
    numbers.push_back(std::numeric_limits<double>::infinity());
  }
  std::vector<double> ours(places.size());
  const auto run_ours = [&] {
    const Answers& answers = product_.ask(QuestionKind::near, HitMode::closest, numbers, 1);
    for (std::size_t i = 0; i < places.size(); ++i) ours[i] = answers.hits[i].distance_m;
  };
  run_ours();
  std::vector<Method> methods{{.name = "collided", .run = run_ours, .bytes_each = product_.bytes_a_triangle()}};
  // The slow twin: every triangle, but for those whose box is farther than the answer.
  for (std::size_t i = 0; i < std::min<std::size_t>(places.size(), 20); ++i) {
    double nearest_m = std::numeric_limits<double>::infinity();
    for (std::uint32_t t = 0; t < mesh_.triangles.size(); ++t) {
      const Triangle triangle = mesh_.triangle(t);
      const Aabb box = bounds(triangle);
      const Vec3 off = (box.low - places[i]).cwiseMax(places[i] - box.high).cwiseMax(0);
      if (off.norm() <= 1.001 * ours[i]) {
        nearest_m = std::min(nearest_m, exactly::closest(places[i], triangle).distance_m);
      }
    }
    methods[0].equal += std::abs(nearest_m - ours[i]) <= 1e-12 * nearest_m ? 1 : 0;
    ++methods[0].of;
  }
  std::vector<double> theirs(places.size());
  for (const auto& peer : peers_) {
    if (std::isnan(peer->closest_m(places[0]))) continue;
    Method method{.name = peer->name(), .run = [&, p = peer.get()] {
                    for (std::size_t i = 0; i < places.size(); ++i) theirs[i] = p->closest_m(places[i]);
                  }};
    method.run();
    for (std::size_t i = 0; i < places.size(); ++i) {
      method.equal += std::abs(theirs[i] - ours[i]) <= 1e-4 * ours[i] + 1e-12 ? 1 : 0;
    }
    method.of = places.size();
    methods.push_back(std::move(method));
  }
  measure(options_, {scene_, mesh_.triangles.size(), name, places.size(), "peers equal within 1e-4"}, methods);
}

void Bench::run(std::mt19937_64& random) {
  Aabb around;
  double area_m2 = 0;
  for (std::uint32_t i = 0; i < mesh_.triangles.size(); ++i) {
    const Triangle t = mesh_.triangle(i);
    around.extend(bounds(t));
    area_m2 += (t.b - t.a).cross(t.c - t.a).norm() / 2;
  }
  // A disc of this radius holds about 250 triangles of the mean area.
  const auto radius_m =
      static_cast<double>(static_cast<float>(std::sqrt(80 * area_m2 / static_cast<double>(mesh_.triangles.size()))));
  const std::size_t count = options_.quick ? 300 : 3000;
  Places far{places_near(mesh_, count, 2 * radius_m, random), radius_m, Vec3::Constant(radius_m)};
  Places on{places_near(mesh_, count, 0.2 * radius_m, random), radius_m, Vec3::Constant(radius_m)};
  for (const Set set : {Set::sphere, Set::box}) {
    overlap(set, true, far);
    overlap(set, false, on);
    deepest(set, on);
  }
  closest("closest point, near", far.centers);
  closest("closest point, in box", places_in(around, count, random));
}

void run_scene(const Options& options, const std::string& name, TriangleMesh mesh, std::mt19937_64& random) {
  if (mesh.triangles.empty()) {
    std::printf("%s: not here, left out\n", name.c_str());
    return;
  }
  for (Vec3& vertex : mesh.vertices) vertex = vertex.cast<float>().cast<double>();
  Bench(options, name, mesh).run(random);
}

}  // namespace
}  // namespace collided::bench

int main(int argc, char** argv) {
  using namespace collided;
  const bench::Options options = bench::read_options(argc, argv);
  std::mt19937_64 random = oracle::seeded(20240607);
  bench::run_scene(options, "bunny", bench::read_obj("/usr/share/glmark2/models/bunny.obj"), random);
  bench::run_scene(options, "terrain", scenes::terrain(options.quick ? 200 : 707, 1000, random()), random);
  return 0;
}
