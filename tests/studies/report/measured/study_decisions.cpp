#include <random>

#include "server/broad_phase/hierarchy/bvh.hpp"
#include "server/exact_phase/ray/ray_cast.hpp"
#include "tests/scenes/meshes.hpp"
#include "tests/studies/report/measured/studies.hpp"
#include "tests/studies/report/methods/peer_method.hpp"
#include "tests/studies/report/methods/plain.hpp"

namespace collided::report {
using namespace engine;
namespace {

Vec3 on_sphere(std::mt19937_64& random) {
  std::normal_distribution<double> normal;
  const double x = normal(random);
  const double y = normal(random);
  return Vec3(x, y, normal(random)).normalized();
}

struct Any {
  const Ray& ray;
  bool hit = false;
};

template <class T>
double plainly(Any& any, const Triangle& t, double limit) {
  any.hit = plain_ray<T>(V<T>(any.ray.origin), V<T>(any.ray.direction), V<T>(t.a), V<T>(t.b), V<T>(t.c)).has_value();
  return any.hit ? -1 : limit;
}

double exactly_so(Any& any, const Triangle& t, double limit) {
  RayHit hit;
  any.hit = cast_ray(any.ray, t, hit).yes();
  return any.hit ? -1 : limit;
}

using Decide = double (*)(Any& any, const Triangle& t, double limit);

}  // namespace

std::vector<Row> study_decisions(const Setting& setting) {
  std::mt19937_64 random(setting.seed + 7);
  // A closed surface seen from inside: every ray hits it, so no reference is needed.
  TriangleMesh mesh = scenes::icosphere(setting.quick ? 3 : 5, 1);
  for (Vec3& v : mesh.vertices) v = v.cast<float>().cast<double>();
  const Bvh tree = Bvh::build(mesh);
  std::uniform_real_distribution<double> part(0, 1);
  std::vector<Row> rows;
  const int count = setting.quick ? 2000 : setting.full ? 1000000 : 100000;
  for (const std::string family : {"random direction", "toward a vertex, exactly", "toward an edge"}) {
    std::vector<Ray> rays;
    PeerProblem problem{"ray", mesh, 6, {}};
    for (int i = 0; i < count; ++i) {
      const Triangle t = mesh.triangle(static_cast<std::uint32_t>(random() % mesh.triangles.size()));
      Vec3 direction = family[0] == 'r' ? on_sphere(random) : t.a;
      if (family == "toward an edge") direction = t.a + part(random) * (t.b - t.a);
      direction = direction.cast<float>().cast<double>();
      rays.push_back({Vec3::Zero(), direction});
      problem.numbers.insert(problem.numbers.end(), {0, 0, 0, direction[0], direction[1], direction[2]});
    }
    const std::vector<Truth> truth(rays.size(), Truth{true, 0});
    const auto method = [&](const std::string& series, Decide decide) {
      return Method{series, "", kUnknown, each(rays, [&, decide](const Ray& ray) {
                      Any any{ray};
                      WalkCost cost;
                      const auto candidate = [&](std::uint32_t, const Triangle& t, double limit) {
                        return decide(any, t, limit);
                      };
                      tree.walk_ray(ray, INFINITY, 0, mesh, candidate, cost);
                      return Answer{any.hit, 0};
                    })};
    };
    std::vector<Method> methods{method("ours", exactly_so), method("plain double", plainly<double>),
                                method("plain float", plainly<float>)};
    const auto file = problem_file(setting, "decisions");
    write_problem(file, problem);
    add_peer(methods, setting, "peer_embree", "default", file, "Embree default", "");
    add_peer(methods, setting, "peer_embree", "robust", file, "Embree robust", "");
    add_peer(methods, setting, "peer_bullet_float", "", file, "Bullet float", "");
    add_peer(methods, setting, "peer_cgal", "", file, "CGAL", "");
    for (Row& row : measure("decisions", family, methods, truth, 1, setting.repeats())) {
      // The questions are only yes or no.
      row.error_max = row.error_p50 = kUnknown;
      rows.push_back(row);
    }
  }
  return rows;
}

}  // namespace collided::report
