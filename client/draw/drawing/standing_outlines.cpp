#include "client/draw/drawing/standing_outlines.hpp"

#include <chrono>
#include <utility>

#include <nlohmann/json.hpp>

#include "idl/commands.hpp"
#include "idl/described_json.hpp"

namespace collided::draw {
namespace {

constexpr std::size_t kMostNearest = 50;
constexpr std::chrono::seconds kOutlinePatience{1};

std::vector<double> line_between(const Vec3& a, const Vec3& b) { return {a.x(), a.y(), a.z(), b.x(), b.y(), b.z()}; }

/// From one object's nearest point to the other's; nothing if they touch, or the answer is unknown.
void add_line_from_object(Client& client, StandingOutline& outline) {
  const Result<PairAnswer> pair = client.pair(outline.to, outline.holds.front().object, {.timeout = kOutlinePatience});
  if (!pair || pair->verdict == Verdict::undecided) return;
  outline.distance_m = pair->verdict == Verdict::miss ? pair->distance_m : 0;
  if (pair->verdict == Verdict::miss) outline.lines = {line_between(pair->on_a, pair->on_b)};
}

void add_line_from_point(Client& client, StandingOutline& outline) {
  const std::string& nearest = outline.holds.front().object;
  AskOptions options;
  options.only = nearest;
  options.timeout = kOutlinePatience;
  const Result<Answer> answer = client.ask(NearQuestion{.point = *outline.point}, options);
  if (!answer || answer->hits.empty() || answer->hits.front().object != nearest) return;
  outline.distance_m = answer->hits.front().distance_m;
  outline.lines = {line_between(*outline.point, answer->hits.front().point)};
}

}  // namespace

const std::string& StandingOutline::carrier() const {
  static const std::string kWorld;
  return form == StandingForm::region ? to : form == StandingForm::bands ? about : kWorld;
}

Result<std::vector<StandingOutline>> standing_outlines(Client& client, bool with_lines) {
  const nlohmann::json arguments{{"outlines", true}, {"lines", with_lines}, {"limit", 1'000}};
  const Result<std::string> text =
      client.command(wire_contract::command::kFences, arguments.dump(), {}, kOutlinePatience);
  if (!text) return text.error();
  std::vector<StandingOutline> outlines;
  try {
    const nlohmann::json answer = nlohmann::json::parse(*text);
    for (const nlohmann::json& row : answer.at("standing"))
      outlines.push_back({from_json<OutlinedStanding>(row, true)});
  } catch (const nlohmann::json::exception& fault) {
    return Error{ErrorCode::refused,
                 std::string("the server's list of standing questions cannot be read: ") + fault.what(), ""};
  }
  return outlines;
}

Result<std::vector<StandingOutline>> nearest_outlines(Client& client) {
  const Result<std::vector<ListedStanding>> all = client.standing({}, StandingForm::nearest);
  if (!all) return all.error();
  std::vector<StandingOutline> outlines;
  for (const ListedStanding& listed : *all) {
    if (outlines.size() == kMostNearest) break;
    StandingOutline& outline = outlines.emplace_back();
    static_cast<DefinedStanding&>(outline) = listed;
    outline.holds = listed.holds;
    if (!outline.is_held()) continue;
    outline.point ? add_line_from_point(client, outline) : add_line_from_object(client, outline);
  }
  return outlines;
}

std::vector<std::vector<Vec3>> placed_lines(const StandingOutline& outline, const Pose& carrier) {
  std::vector<std::vector<Vec3>> lines;
  for (const std::vector<double>& numbers : outline.lines) {
    std::vector<Vec3>& line = lines.emplace_back();
    for (std::size_t i = 0; i + 2 < numbers.size(); i += 3)
      line.push_back(carrier.position + carrier.rotation * Vec3(numbers[i], numbers[i + 1], numbers[i + 2]));
  }
  return lines;
}

}  // namespace collided::draw
