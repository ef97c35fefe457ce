#pragma once

#include <cstdio>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "server/world/query/pair_report.hpp"
#include "server/world/query/probes.hpp"
#include "server/world/query/query.hpp"
#include "server/world/world.hpp"

namespace collided::model {
using namespace engine;

/// What two worlds say, in lines of text that compare: objects by their names, since ids hang on a world's past, and
/// every number to its last bit (-0 as 0).
using Lines = std::vector<std::string>;

/// Of a text with %a for each number.
template <class... Numbers>
std::string line(const char* format, Numbers... numbers) {
  char text[1'000];
  std::snprintf(text, sizeof text, format, numbers...);
  return text;
}
std::string told(const Vec3& v);

/// Names by id as they were at any time, for events speak of what is gone.
class NamesById {
 public:
  void learn(const ObjectTable& objects) {
    for (const auto& info : objects) {
      if (info) names_[info->id] = info->name;
    }
  }
  std::string of(ObjectId id) const {
    const auto found = names_.find(id);
    return found == names_.end() ? "#" + std::to_string(id) : found->second;
  }

 private:
  std::map<ObjectId, std::string> names_;
};

struct AnswerDetail {
  bool cost = false;  // nodes, tests and levels too: of the same world and questions only
  bool hits = true;   // mode any may name another one in another world
  bool point_error = true;
  bool age = true;
};
/// A line for each question and for each hit.
Lines told(const Answers& answers, const NamesById& names, const AnswerDetail& detail);

/// What of a contact is told. Points are rounded differently where the other of the two has the lower id; the surface at an inner
/// edge hangs on which contacts were found in the same step.
struct ContactDetail {
  bool point = true;
  bool surface = true;
};
/// Lower name first, whichever has the lower id.
std::string told(const OpenContact& contact, const NamesById& names, const ContactDetail& detail);
std::string told(const Event& event, const NamesById& names, const ContactDetail& detail);
std::pair<std::string, std::string> pair_of(const OpenContact& contact, const NamesById& names);

Lines told(const PairReport& report);
std::string told(const ProbeReading& reading, const NamesById& names);

/// Fails with the lines that only one of the two has, after `what`.
void expect_same(const Lines& here, const Lines& twin, const std::string& what);

}  // namespace collided::model
