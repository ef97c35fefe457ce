#include "client/draw/drawing/nearest_outlines.hpp"

#include <algorithm>
#include <chrono>
#include <map>
#include <nlohmann/json.hpp>
#include <string>

namespace collided::draw {
namespace {

constexpr std::size_t kMostNearest = 50;
constexpr std::chrono::seconds kNearestPatience{1};

/// From one object's nearest point to the other's; nothing where they touch, or that is not known.
void add_line(Client& client, const ListedNearest& listed, FenceOutline& outline) {
  const Result<PairAnswer> pair = client.pair(listed.question.to, listed.object, {.timeout = kNearestPatience});
  if (!pair || pair->verdict == Verdict::undecided) return;
  outline.distance_m = pair->verdict == Verdict::miss ? pair->distance_m : 0;
  if (pair->verdict == Verdict::miss) outline.lines = {{pair->on_a, pair->on_b}};
}

/// From the question's point.
void add_line_from_point(Client& client, const ListedNearest& listed, FenceOutline& outline) {
  AskOptions options;
  options.only = listed.object;
  options.timeout = kNearestPatience;
  const Result<Answer> answer = client.ask(NearQuestion{.point = *listed.question.point}, options);
  if (!answer || answer->hits.empty() || answer->hits.front().object != listed.object) return;
  outline.distance_m = answer->hits.front().distance_m;
  outline.lines = {{*listed.question.point, answer->hits.front().point}};
}

/// Numbers as JSON has them.
std::map<std::string, std::string> definition_of(const NearestQuestion& question) {
  const auto text = [](const nlohmann::json& value) { return value.dump(); };
  std::map<std::string, std::string> definition{
      {"only", question.only},       {"skip", question.skip},
      {"mask", text(question.mask)}, {"within", text(question.within_m)},
      {"keep", text(question.keep)}, {"hysteresis", text(question.hysteresis_m)}};
  if (question.point) definition["point"] = text({question.point->x(), question.point->y(), question.point->z()});
  return definition;
}

}  // namespace

Result<std::vector<FenceOutline>> nearest_outlines(Client& client) {
  const Result<std::vector<ListedNearest>> all = client.nearest();
  if (!all) return all.error();
  std::vector<FenceOutline> outlines;
  for (const ListedNearest& listed : *all) {
    if (outlines.size() == kMostNearest) break;
    FenceOutline& outline = outlines.emplace_back(FenceOutline{.name = listed.question.name});
    outline.is_nearest = true;
    outline.of = listed.question.to;
    outline.definition = definition_of(listed.question);
    if (listed.object.empty()) continue;
    (listed.is_in_doubt ? outline.in_doubt : outline.inside).push_back(listed.object);
    listed.question.point ? add_line_from_point(client, listed, outline) : add_line(client, listed, outline);
  }
  return outlines;
}

}  // namespace collided::draw
