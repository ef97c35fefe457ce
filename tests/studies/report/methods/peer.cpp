#include "tests/studies/report/methods/peer.hpp"

#include <cstdint>
#include <cstdio>
#include <fstream>
#include <iostream>

#include "tests/studies/bench/clock.hpp"

namespace collided::report {
using namespace engine;
namespace {

template <class T>
void put(std::ofstream& out, const std::vector<T>& values) {
  const std::uint64_t count = values.size();
  out.write(reinterpret_cast<const char*>(&count), sizeof count);
  out.write(reinterpret_cast<const char*>(values.data()), static_cast<std::streamsize>(count * sizeof(T)));
}

template <class T>
std::vector<T> get(std::ifstream& in) {
  std::uint64_t count = 0;
  in.read(reinterpret_cast<char*>(&count), sizeof count);
  std::vector<T> values(in ? count : 0);
  in.read(reinterpret_cast<char*>(values.data()), static_cast<std::streamsize>(values.size() * sizeof(T)));
  return values;
}

}  // namespace

void write_problem(const std::filesystem::path& file, const PeerProblem& problem) {
  std::ofstream out(file, std::ios::binary);
  put(out, std::vector<char>(problem.kind.begin(), problem.kind.end()));
  std::vector<double> vertices;
  for (const Vec3& v : problem.mesh.vertices) vertices.insert(vertices.end(), {v[0], v[1], v[2]});
  put(out, vertices);
  put(out, problem.mesh.triangles);
  put(out, std::vector<std::uint64_t>{problem.numbers_each});
  put(out, problem.numbers);
}

PeerProblem read_problem(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  PeerProblem problem;
  const std::vector<char> kind = get<char>(in);
  problem.kind.assign(kind.begin(), kind.end());
  const std::vector<double> vertices = get<double>(in);
  for (std::size_t i = 0; i + 2 < vertices.size(); i += 3) {
    problem.mesh.vertices.emplace_back(vertices[i], vertices[i + 1], vertices[i + 2]);
  }
  problem.mesh.triangles = get<TriangleCorners>(in);
  const auto each = get<std::uint64_t>(in);
  problem.numbers_each = each.empty() ? 1 : each[0];
  problem.numbers = get<double>(in);
  return problem;
}

int serve_peer(const PeerProblem& problem, const std::string& answers_file,
               const std::function<PeerAnswer(const double*)>& answer) {
  std::vector<PeerAnswer> answers(problem.count());
  std::puts("ready");
  std::fflush(stdout);
  for (std::string line; std::getline(std::cin, line);) {
    const double start = bench::thread_seconds();
    for (std::size_t i = 0; i < answers.size(); ++i) answers[i] = answer(problem.question(i));
    std::printf("%.9f\n", bench::thread_seconds() - start);
    std::fflush(stdout);
  }
  std::ofstream out(answers_file, std::ios::binary);
  put(out, answers);
  return out ? 0 : 1;
}

}  // namespace collided::report
