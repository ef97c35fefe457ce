#pragma once

#include <chrono>
#include <cstdint>
#include <cstdio>
#include <functional>
#include <string>
#include <vector>

#include "server/exact_phase/arithmetic/decision.hpp"
#include "server/exact_phase/arithmetic/precision.hpp"

namespace collided::census {
using namespace engine;

/// One line of the census: how often a method's yes/no was not the truth.
struct Row {
  std::string query;
  std::string family;
  std::string method;
  std::uint64_t count = 0;
  std::uint64_t missed = 0;
  std::uint64_t found_falsely = 0;
  std::uint64_t undecided = 0;
  std::uint64_t uncertain = 0;  // the double filter gave up
  std::uint64_t exact = 0;      // expansions or rationals decided
  std::uint64_t rational = 0;   // of those, rationals
  double nanoseconds = 0;       // in all

  std::uint64_t wrong() const { return missed + found_falsely + undecided; }
};

class Table {
 public:
  Row& row(const std::string& query, const std::string& family, const std::string& method) {
    for (Row& row : rows_) {
      if (row.query == query && row.family == family && row.method == method) return row;
    }
    rows_.push_back({query, family, method});
    return rows_.back();
  }
  const std::vector<Row>& rows() const { return rows_; }

  void print(std::size_t from) const {
    for (std::size_t i = from; i < rows_.size(); ++i) {
      const Row& r = rows_[i];
      const double n = static_cast<double>(r.count);
      std::printf(
          "%-18s %-9s %-15s %10llu asked, missed %9llu, false %9llu, undecided %llu, uncertain %.4f %%, exact %.4f %%, "
          "%.0f ns\n",
          r.query.c_str(), r.family.c_str(), r.method.c_str(), static_cast<unsigned long long>(r.count),
          static_cast<unsigned long long>(r.missed), static_cast<unsigned long long>(r.found_falsely),
          static_cast<unsigned long long>(r.undecided), 100 * static_cast<double>(r.uncertain) / n,
          100 * static_cast<double>(r.exact) / n, r.nanoseconds / n);
    }
    std::fflush(stdout);
  }

  bool write(const std::string& file) const {
    std::FILE* out = std::fopen(file.c_str(), "w");
    if (out == nullptr) return false;
    std::fprintf(out, "query,family,method,n,missed,false,uncertain,exact,ns\n");
    for (const Row& r : rows_) {
      std::fprintf(out, "%s,%s,%s,%llu,%llu,%llu,%llu,%llu,%.1f\n", r.query.c_str(), r.family.c_str(), r.method.c_str(),
                   static_cast<unsigned long long>(r.count), static_cast<unsigned long long>(r.missed),
                   static_cast<unsigned long long>(r.found_falsely), static_cast<unsigned long long>(r.uncertain),
                   static_cast<unsigned long long>(r.exact), r.nanoseconds / static_cast<double>(r.count));
    }
    return std::fclose(out) == 0;
  }

 private:
  std::vector<Row> rows_;
};

/// One way to answer; `ask` fills an answer a case.
template <class Case>
struct Method {
  std::string name;
  std::function<void(const std::vector<Case>&, std::vector<Decision>&)> ask;
  std::uint64_t at_most = ~std::uint64_t{0};  // peers need fewer cases than the product
};

template <class Case, class Ask>
Method<Case> method(std::string name, Ask ask, std::uint64_t at_most = ~std::uint64_t{0}) {
  return {std::move(name),
          [ask](const std::vector<Case>& cases, std::vector<Decision>& answers) {
            for (std::size_t i = 0; i < cases.size(); ++i) answers[i] = ask(cases[i]);
          },
          at_most};
}

inline constexpr const char* kOurs = "collided";

/// Makes cases and their truth in handfuls, asks every method, and counts. A case carries its truth as `meets`.
template <class Case, class Make>
void take(Table& table, const std::string& query, const std::string& family, std::uint64_t count, Make make,
          const std::vector<Method<Case>>& methods) {
  constexpr std::uint64_t kHandful = 2048;
  std::vector<Case> cases;
  std::vector<Decision> answers;
  const std::size_t first_row = table.rows().size();
  for (std::uint64_t done = 0; done < count; done += cases.size()) {
    cases.clear();
    while (cases.size() < std::min(kHandful, count - done)) cases.push_back(make());
    answers.assign(cases.size(), Decision::undecided);
    for (const Method<Case>& m : methods) {
      if (done >= m.at_most) continue;
      const RungCounts before = kernel::rungs;
      const auto start = std::chrono::steady_clock::now();
      m.ask(cases, answers);
      const std::chrono::duration<double, std::nano> spent = std::chrono::steady_clock::now() - start;
      Row& row = table.row(query, family, m.name);
      row.count += cases.size();
      row.nanoseconds += spent.count();
      row.uncertain += kernel::rungs.uncertain - before.uncertain;
      row.exact += kernel::rungs.expansion - before.expansion;
      row.rational += kernel::rungs.rational - before.rational;
      for (std::size_t i = 0; i < cases.size(); ++i) {
        row.undecided += answers[i] == Decision::undecided;
        row.missed += cases[i].meets && answers[i] == Decision::no;
        row.found_falsely += !cases[i].meets && answers[i] == Decision::yes;
      }
    }
  }
  table.print(first_row);
}

}  // namespace collided::census
