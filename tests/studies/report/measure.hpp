#pragma once

#include <functional>
#include <string>
#include <vector>

#include "tests/oracle/exact_oracle.hpp"
#include "tests/studies/report/page/rows.hpp"

namespace collided::report {
using namespace engine;

struct Setting {
  unsigned long long seed = 2025;
  bool quick = false;
  bool full = false;
  std::string peers;  // folder of the peer programs; empty: none
  std::string scratch;

  /// Questions of a study: few in the quick form, four times as many in the full one.
  int count(int normal) const { return quick ? normal / 20 + 1 : full ? 4 * normal : normal; }
  int repeats() const { return quick ? 3 : 9; }
};

struct Answer {
  bool yes = false;
  double value = 0;
  double bound = kUnknown;  // NaN: none is claimed
  bool undecided = false;
};

struct Truth {
  bool yes = false;
  oracle::Wide value = 0;
};

/// One way to answer all questions of a study.
struct Method {
  std::string series;
  std::string label;
  double knob = kUnknown;
  std::function<double(std::vector<Answer>&)> pass;  // all questions once; returns the seconds that took
  std::string note{};
};

/// Seconds of this thread's processor time.
double timed(const std::function<void()>& work);

/// A pass that asks one question after the other.
template <class Question, class Ask>
std::function<double(std::vector<Answer>&)> each(const std::vector<Question>& questions, Ask ask) {
  return [&questions, ask](std::vector<Answer>& answers) {
    answers.resize(questions.size());
    return timed([&] {
      for (std::size_t i = 0; i < questions.size(); ++i) answers[i] = ask(questions[i]);
    });
  };
}

/// Every method `repeats` times, in turn, so that what else the machine does falls on all alike; errors against the
/// truth, relative to it but not to less than one rounding of `extent`. One row a method; a method whose pass gives
/// no answers (a peer that died) gives a row without numbers.
std::vector<Row> measure(const std::string& study, const std::string& scene, const std::vector<Method>& methods,
                         const std::vector<Truth>& truth, double extent, int repeats);

}  // namespace collided::report
