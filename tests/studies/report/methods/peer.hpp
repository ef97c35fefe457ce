#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "server/geometry/mesh.hpp"

namespace collided::report {
using namespace engine;

// Other people's programs answer in processes of their own: two builds of one library cannot share a process, and an
// assert inside a library ends only its own. A peer reads the problem from a file, answers "ready", then runs one pass
// for each line on its input and prints the seconds; at the end of its input it writes the answers and leaves.

struct PeerProblem {
  std::string kind;              // "ray", "nearest", "sphere_triangle", "box_box", ...
  TriangleMesh mesh;             // may be empty
  std::size_t numbers_each = 0;  // of one question
  std::vector<double> numbers;

  std::size_t count() const { return numbers.size() / numbers_each; }
  const double* question(std::size_t i) const { return numbers.data() + i * numbers_each; }
};

struct PeerAnswer {
  double yes = 0;
  double value = 0;
};

void write_problem(const std::filesystem::path& file, const PeerProblem& problem);
PeerProblem read_problem(const std::filesystem::path& file);

/// What a peer's main does. `answer` is asked for each question in turn.
int serve_peer(const PeerProblem& problem, const std::string& answers_file,
               const std::function<PeerAnswer(const double*)>& answer);

/// A started peer. Copies share it; the last one ends it.
class Peer {
 public:
  /// Nothing if the program is not there (its package was not, when this was built) or cannot do the kind.
  static std::optional<Peer> start(const std::filesystem::path& program, const std::string& option,
                                   const std::filesystem::path& problem);
  /// Seconds, or nothing if it has died.
  std::optional<double> pass();
  /// Ends it; empty if it died.
  std::vector<PeerAnswer> finish();

 private:
  struct Process;
  std::shared_ptr<Process> process_;
};

}  // namespace collided::report
