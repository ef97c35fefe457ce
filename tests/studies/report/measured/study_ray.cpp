#include <algorithm>
#include <cmath>
#include <random>

#include "server/broad_phase/hierarchy/bvh.hpp"
#include "server/exact_phase/arithmetic/precision.hpp"
#include "server/exact_phase/exactly.hpp"
#include "server/exact_phase/ray/ray_cast.hpp"
#include "tests/studies/report/measured/studies.hpp"
#include "tests/studies/report/methods/peer_method.hpp"
#include "tests/studies/report/methods/plain.hpp"

namespace collided::report {
using namespace engine;
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

Vec3 to_float(const Vec3& v) { return v.cast<float>().cast<double>(); }

Vec3 on_unit_sphere(std::mt19937_64& random) {
  std::normal_distribution<double> normal;
  const double x = normal(random);
  const double y = normal(random);
  return Vec3(x, y, normal(random)).normalized();
}

/// From around the mesh through it, all coordinates floats.
std::vector<Ray> random_rays(const TriangleMesh& mesh, int count, std::mt19937_64& random) {
  std::vector<Ray> rays;
  const double size = extent(mesh);
  for (int i = 0; i < count; ++i) {
    const Vec3 origin = to_float(2 * size * on_unit_sphere(random));
    const Vec3 through = 0.4 * size * on_unit_sphere(random);
    rays.push_back({origin, to_float(through - origin)});
  }
  return rays;
}

/// At vertices, at points of edges, and nearly along faces.
std::vector<Ray> hard_rays(const TriangleMesh& mesh, int count, std::mt19937_64& random) {
  std::vector<Ray> rays;
  const double size = extent(mesh);
  std::uniform_real_distribution<double> part(0, 1);
  for (int i = 0; i < count; ++i) {
    const Triangle t = mesh.triangle(static_cast<std::uint32_t>(random() % mesh.triangles.size()));
    const Vec3 normal = (t.b - t.a).cross(t.c - t.a).normalized();
    Vec3 target = t.a;
    if (i % 3 == 1) target = t.a + part(random) * (t.b - t.a);
    Vec3 from = size * (normal + 0.5 * on_unit_sphere(random));
    if (i % 3 == 2) {
      target = (t.a + t.b + t.c) / 3;
      from = size * ((t.b - t.a).normalized() + 1e-6 * normal);
    }
    const Vec3 origin = to_float(target + from);
    rays.push_back({origin, to_float(target - origin)});
  }
  return rays;
}

/// By force: every triangle that plain double cannot rule out by far is solved in rationals.
Truth truth_of(const TriangleMesh& mesh, const Ray& ray) {
  const V<double> o(ray.origin);
  const V<double> d(ray.direction);
  std::optional<oracle::Rational> first;
  for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i) {
    const Triangle t = mesh.triangle(i);
    const V<double> a(t.a);
    const V<double> edge1 = V<double>(t.b) - a;
    const V<double> edge2 = V<double>(t.c) - a;
    const V<double> p = d.cross(edge2);
    const V<double> from = o - a;
    const V<double> q = from.cross(edge1);
    const double det = edge1.dot(p);
    const double slack = 1e-3 * std::abs(det) + 1e-12 * std::sqrt(d.dot(d) * edge1.dot(edge1) * edge2.dot(edge2));
    const double u = (det < 0 ? -1 : 1) * from.dot(p);
    const double v = (det < 0 ? -1 : 1) * d.dot(q);
    if (u < -slack || v < -slack || u + v > std::abs(det) + slack) continue;
    const auto s = oracle::first_parameter(ray, t);
    if (s && (!first || *s < *first)) first = *s;
  }
  if (!first) return {};
  return {true, oracle::Wide(*first) * oracle::length(ray.direction)};
}

struct Walk {
  const Ray& ray;
  double direction_m;
  Answer best;
  double best_s = kInfinity;
};

template <class T>
double keep_plain(Walk& walk, const Triangle& t, double limit) {
  const auto s = plain_ray<T>(V<T>(walk.ray.origin), V<T>(walk.ray.direction), V<T>(t.a), V<T>(t.b), V<T>(t.c));
  if (!s || !(static_cast<double>(*s) < walk.best_s)) return limit;
  walk.best_s = static_cast<double>(*s);
  walk.best = {true, walk.best_s * walk.direction_m};
  return walk.best_s;
}

double keep_exact(Walk& walk, const Triangle& t, double limit) {
  RayHit hit;
  if (exactly::cast_ray(walk.ray, t, hit) != Decision::yes) return limit;
  const double s = hit.distance_m / walk.direction_m;
  if (s < walk.best_s) {
    walk.best_s = s;
    walk.best = {true, hit.distance_m, hit.distance_error_m};
  }
  return std::min(limit, (hit.distance_m + hit.distance_error_m) / walk.direction_m * (1 + 0x1p-50));
}

/// As the product does it: the nearest by distance, the limit by distance and bound.
double keep_decided(Walk& walk, const Triangle& t, double limit) {
  RayHit hit;
  const ExactResult verdict = cast_ray(walk.ray, t, hit);
  if (verdict.decision == Decision::undecided) walk.best.undecided = true;
  if (!verdict.yes()) return limit;
  const double s = hit.distance_m / walk.direction_m;
  if (s < walk.best_s) {
    walk.best_s = s;
    walk.best = {true, hit.distance_m, hit.distance_error_m, walk.best.undecided};
  }
  return std::min(limit, (hit.distance_m + hit.distance_error_m) / walk.direction_m * (1 + 0x1p-50));
}

using DecideOnWalk = double (*)(Walk& walk, const Triangle& t, double limit);

class RayStudy {
 public:
  RayStudy(const NamedMesh& scene, const Bvh& tree, std::vector<Ray> rays)
      : scene_(scene), tree_(tree), rays_(std::move(rays)) {
    for (const Ray& ray : rays_) truth_.push_back(truth_of(scene.mesh, ray));
  }

  Method method(const std::string& series, const std::string& label, DecideOnWalk decide,
                const Precision& precision = {}, double knob = kUnknown) const {
    return {series, label, knob, each(rays_, [this, decide, precision](const Ray& ray) {
              const PrecisionScope scope(precision);
              Walk walk{ray, ray.direction.norm(), {}};
              WalkCost cost;
              const auto candidate = [&](std::uint32_t, const Triangle& t, double limit) {
                return decide(walk, t, limit);
              };
              tree_.walk_ray(ray, kInfinity, 0, scene_.mesh, candidate, cost);
              return walk.best;
            })};
  }

  std::vector<Row> run(const Setting& setting, const std::string& study) const {
    std::vector<Method> methods{method("ours: uncertified", "float", keep_plain<float>),
                                method("ours: uncertified", "double", keep_plain<double>),
                                method("ours: certified", "bounded double", keep_decided, {.highest = Level::filter}),
                                method("ours: certified", "exact on doubt", keep_decided),
                                method("ours: certified", "rationals always", keep_exact)};
    for (const double asked : asked_errors(setting.quick)) {
      methods.push_back(
          method("ours: error asked", short_number(asked, 1), keep_decided, {.error_asked_m = asked}, asked));
    }
    add_peers(methods, setting, study);
    return measure(study, scene_.name, methods, truth_, extent(scene_.mesh), setting.repeats());
  }

 private:
  void add_peers(std::vector<Method>& methods, const Setting& setting, const std::string& study) const {
    PeerProblem problem{"ray", scene_.mesh, 6, {}};
    for (const Ray& r : rays_) {
      problem.numbers.insert(problem.numbers.end(),
                             {r.origin[0], r.origin[1], r.origin[2], r.direction[0], r.direction[1], r.direction[2]});
    }
    const auto file = problem_file(setting, study);
    write_problem(file, problem);
    add_peer(methods, setting, "peer_embree", "default", file, "Embree 3.13.5 (float)", "default");
    add_peer(methods, setting, "peer_embree", "robust", file, "Embree 3.13.5 (float)", "robust");
    add_peer(methods, setting, "peer_bullet_float", "", file, "Bullet 3.24", "float");
    add_peer(methods, setting, "peer_bullet_double", "", file, "Bullet 3.24", "double");
    add_peer(methods, setting, "peer_cgal", "", file, "CGAL 5.5", "exact predicates");
  }

  const NamedMesh& scene_;
  const Bvh& tree_;
  std::vector<Ray> rays_;
  std::vector<Truth> truth_;
};

}  // namespace

std::vector<Row> study_ray(const Setting& setting) {
  std::mt19937_64 random(setting.seed);
  const NamedMesh scene = report_mesh(setting.quick);
  const Bvh tree = Bvh::build(scene.mesh);
  const int count = setting.count(3000);
  std::vector<Row> rows = RayStudy(scene, tree, random_rays(scene.mesh, count, random)).run(setting, "ray");
  const std::vector<Row> hard = RayStudy(scene, tree, hard_rays(scene.mesh, count, random)).run(setting, "ray_hard");
  rows.insert(rows.end(), hard.begin(), hard.end());
  return rows;
}

}  // namespace collided::report
