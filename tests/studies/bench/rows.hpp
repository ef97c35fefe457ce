#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

namespace collided::bench {

inline constexpr int kRuns = 5;

/// What the programs of this folder are told: [--quick] [--csv FILE] [--only NAME] [--peers NAME] [--no-header].
struct Options {
  bool quick = false;
  bool header = true;
  std::string csv{};   // rows are appended
  std::string only{};  // works and scenes whose name contains it

  std::string peers{};  // other methods than ours whose name contains it

  bool wants(const std::string& scene, const std::string& work) const;
  bool takes(const std::string& method) const;
};

/// Leaves with status 2 and a sentence where an argument is unknown.
Options read_options(int argc, char** argv);

/// One way of doing a work: ours, or a peer's.
struct Method {
  std::string name{};
  std::function<void()> run{};       // all questions once
  std::function<double()> own_ns{};  // instead, where it measures itself: nanoseconds a question
  double bytes_each = 0;             // memory a triangle or object, all in; 0: unknown
  std::size_t equal = 0;             // answers equal to ours, for ours to the slow twin's
  std::size_t of = 0;                // answers compared
  std::vector<double> ns{};          // a question, one entry a run; filled by measure
  std::function<void()> prepare{};   // before each run, not timed
};

struct Work {
  std::string scene{};
  std::size_t size = 0;  // triangles or objects
  std::string name{};
  std::size_t questions = 1;
  std::string note{};        // of our own row
  bool on_the_wall = false;  // other threads work too: the wall's clock, not the calling thread's
};

/// Runs every method in turn, kRuns times after one warming run, and writes a row for each: nanoseconds a question
/// (median, least, most) and how many times as long as ours it took (median of the runs; our own row: the best peer).
/// methods[0] is ours.
void measure(const Options& options, const Work& work, std::vector<Method>& methods);

}  // namespace collided::bench
