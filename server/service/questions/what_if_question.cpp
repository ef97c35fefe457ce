#include "server/service/questions/what_if_question.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <unordered_map>
#include <unordered_set>

#include "idl/glob.hpp"
#include "idl/topics.hpp"
#include "server/service/questions/group_names.hpp"
#include "server/service/questions/nearest_word.hpp"
#include "server/service/questions/validation.hpp"
#include "server/service/runtime/clock.hpp"

namespace collided::engine::service {
namespace {

using nlohmann::json;

/// Reads one chunk's question. Every step throws a Refusal if it cannot go on.
class WhatIfReader {
 public:
  WhatIfReader(const wire::Query& query, const Snapshot& state) : query_(query), state_(state) {
    for (const auto& info : state.objects) {
      if (info) by_name_.emplace(info->name, info.get());
    }
  }

  WhatIfAsk read() {
    read_arguments();
    const auto blob = dds::view(query_.blob);
    for (const std::string_view name : wire_contract::unpack_names(blob)) take_moved(name);
    read_attached();
    add_attached_in_world();
    choose_others();
    leave_out();
    return std::move(ask_);
  }

 private:
  [[noreturn]] static void refuse(const std::string& reason) { throw Refusal{"what-if: " + reason}; }

  void read_arguments() {
    arguments_ = json::parse(*query_.text ? query_.text : "{}", nullptr, false);
    if (!arguments_.is_object()) refuse("its text is no JSON object");
    for (const auto& [key, value] : arguments_.items()) {
      const bool is_known = (key == "nearer_m" && value.is_number() && value.get<double>() >= 0) ||
                            (key == "with_filtered" && value.is_boolean()) || (key == "attached" && value.is_array());
      if (!is_known)
        refuse(
            fmt::format("'{}' is not known, or not as it must be; allowed: nearer_m (0 and more), with_filtered, "
                        "attached",
                        key));
    }
    const bool is_any = query_.mode == static_cast<std::uint8_t>(HitMode::any);
    ask_.depth = !is_any;
    ask_.within_m = is_any ? 0 : arguments_.value("nearer_m", ask_.within_m);
    ask_.with_filtered = arguments_.value("with_filtered", false);
  }

  const ObjectInfo& find(std::string_view name) const {
    const auto found = by_name_.find(name);
    if (found != by_name_.end()) return *found->second;
    std::vector<std::string_view> names;
    for (const auto& [known, info] : by_name_) names.push_back(known);
    std::sort(names.begin(), names.end());
    refuse(unknown_object(name, names));
  }

  /// Finds an object that the question moves; each may be named once.
  const ObjectInfo& find_free(std::string_view name) {
    const ObjectInfo& info = find(name);
    if (info.scene_part != kNoScenePart)
      refuse(fmt::format("object {} is a part of scene {} and stays where it is", printable(name),
                         printable(info.rare->scene)));
    if (!goes_.insert(info.id).second) refuse(fmt::format("object {} is named twice", printable(name)));
    return info;
  }

  void take_moved(std::string_view name) { ask_.moved.push_back(find_free(name).id); }

  /// The wire has them in any order; the engine needs each after its parent.
  void read_attached() {
    struct Named {
      std::string child;
      std::string parent;
    };
    std::vector<Named> open;
    for (const json& pair : arguments_.value("attached", json::array())) {
      if (!pair.is_array() || pair.size() != 2 || !pair[0].is_string() || !pair[1].is_string())
        refuse("'attached' is a list of pairs of names, the one that is attached first");
      open.push_back({pair[0], pair[1]});
    }
    while (!open.empty()) {
      const auto next = std::find_if(open.begin(), open.end(),
                                     [&](const Named& pair) { return goes_.contains(find(pair.parent).id); });
      if (next == open.end())
        refuse(fmt::format("{} is attached to {}, which goes nowhere in this question", printable(open[0].child),
                           printable(open[0].parent)));
      const ObjectId parent = find(next->parent).id;
      ask_.attached.push_back({.child = find_free(next->child).id, .parent = parent});
      open.erase(next);
    }
  }

  /// Objects attached in the world move along too, unless the question places them.
  void add_attached_in_world() {
    if (!state_.parents) return;
    for (bool has_new = true; has_new;) {
      has_new = false;
      for (const auto& [child, parent] : *state_.parents) {
        const ObjectInfo* const there =
            slot_of(child) < state_.objects.size() ? state_.objects[slot_of(child)].get() : nullptr;
        if (there == nullptr || there->id != child) continue;  // not yet attached at that past instant
        if (!goes_.contains(parent) || !goes_.insert(child).second) continue;
        ask_.attached.push_back({.child = child, .parent = parent});
        has_new = true;
      }
    }
  }

  void choose_others() {
    const std::string only = query_.only;
    const std::string skip = query_.skip;
    if (only.empty()) {
      ask_.against = all_others(state_, {goes_.begin(), goes_.end()}, skip);
    } else {
      auto meant = objects_meant(state_, "what-if", only, skip);
      if (auto* refusal = std::get_if<Refusal>(&meant)) throw *refusal;
      ask_.against = std::get<std::vector<ObjectId>>(std::move(meant));
    }
    std::erase_if(ask_.against, [&](ObjectId id) {
      return goes_.contains(id) || (state_.objects[slot_of(id)]->filter.layers & query_.mask) == 0;
    });
    if (ask_.against.empty() && goes_.size() == 1) refuse("there is nothing that the object could touch");
  }

  /// Skipped objects are ignored, even if they are moved or move along.
  void leave_out() {
    const std::string skip = query_.skip;
    if (skip.empty()) return;
    for (const ObjectId id : goes_) {
      if (wire_contract::glob_matches(skip, state_.objects[slot_of(id)]->name)) ask_.left_out.push_back(id);
    }
    if (ask_.left_out.size() == goes_.size())
      refuse(fmt::format("'skip' {} leaves out everything that is moved", printable(skip)));
  }

  const wire::Query& query_;
  const Snapshot& state_;
  json arguments_;
  WhatIfAsk ask_;
  std::unordered_map<std::string_view, const ObjectInfo*> by_name_;
  std::unordered_set<ObjectId> goes_;  // moved, or attached to a moved one
};

AnswerHit hit_of(const MemberPair& pair, bool second) {
  const ObjectClearance& found = pair.clearance;
  const Contained inner = second ? Contained::b_in_a : Contained::a_in_b;
  AnswerHit hit;
  hit.object = second ? pair.b : pair.a;
  hit.triangle = second ? found.b_triangle : found.a_triangle;
  hit.flags = static_cast<std::uint8_t>((found.contained == inner ? kHitInside : 0) | (pair.is_stale ? kHitStale : 0));
  hit.distance_m = found.clearance_m;
  hit.error_m = found.error_m;
  hit.point = second ? found.on_b : found.on_a;
  hit.point_error_m = found.point_error_m;
  hit.normal = found.normal;
  return hit;
}

void put_answer(const WhatIfAnswer& given, const Snapshot& state, std::size_t place, Answers& answers) {
  answers.answers[place] = verdict_of(given.touches);
  if (given.touches == Decision::undecided) {
    const bool is_numeric = given.nearest && !given.nearest->is_stale;
    answers.reasons[place] = given.is_late     ? UndecidedReason::deadline
                             : given.uncovered ? UndecidedReason::not_covered
                             : is_numeric      ? UndecidedReason::numeric
                                               : UndecidedReason::stale_object;
    if (given.uncovered && !given.is_late)
      answers.not_covered.push_back(
          {.question = static_cast<std::uint32_t>(place), .leaving = {.point = *given.uncovered}});
  }
  if (!given.nearest) return;
  answers.hits.push_back(hit_of(*given.nearest, false));
  answers.hits.push_back(hit_of(*given.nearest, true));
  answers.hit_counts[place] = 2;
  const std::int64_t posed_ns = state.posed_ns[slot_of(given.nearest->b)];
  if (posed_ns > 0 && (answers.oldest_pose_ns < 0 || posed_ns < answers.oldest_pose_ns))
    answers.oldest_pose_ns = posed_ns;
}

}  // namespace

std::variant<WhatIfAsk, Refusal> what_if_asked(const wire::Query& query, const Snapshot& state) {
  try {
    return WhatIfReader(query, state).read();
  } catch (const Refusal& refusal) { return refusal; }
}

void answer_what_if(WhatIf& what_if, std::span<const double> numbers, const SearchTime& time, std::int64_t pause_ns,
                    const std::function<bool()>& goes_on, Answers& answers) {
  constexpr std::size_t kConfigurationsALook = 16;
  const std::size_t width = what_if.moved_count() * kPoseNumbers;
  const std::size_t count = numbers.size() / width;
  answers.reset(count);
  std::vector<Pose> poses(what_if.moved_count());
  bool is_read = true;
  for (std::size_t i = 0; i < count; ++i) {
    for (auto* column : {&answers.hit_counts, &answers.nodes, &answers.exact_tests}) (*column)[i] = 0;
    answers.levels[i] = 0;
    answers.reasons[i] = UndecidedReason::none;
    bool is_configuration = true;
    for (std::size_t k = 0; k < poses.size(); ++k)
      is_configuration = read_pose(numbers.data() + i * width + k * kPoseNumbers, poses[k]) && is_configuration;
    if (i % kConfigurationsALook == 0) is_read = is_read && goes_on();
    if (!is_configuration) {
      answers.answers[i] = Verdict::invalid;
    } else if (is_read) {
      Deadline end = time.end();
      const WhatIfAnswer given = what_if.at(poses, end);
      if (given.is_late && time.is_given_up()) return answers.cut(i);
      put_answer(given, what_if.snapshot(), i, answers);
    } else {
      answers.answers[i] = Verdict::undecided;
      answers.reasons[i] = UndecidedReason::deadline;
    }
    if (pause_ns != 0 && steady_ns() > pause_ns) return answers.cut(i + 1);
  }
}

}  // namespace collided::engine::service
