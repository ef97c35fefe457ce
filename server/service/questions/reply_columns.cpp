#include "server/service/questions/reply_columns.hpp"

#include <algorithm>

#include "idl/columns.hpp"
#include "idl/topics.hpp"

namespace collided::engine::service {
namespace {

constexpr std::size_t kBytesPerAnswer = 3 + 3 * 4;
constexpr std::size_t kBytesPerNotCovered = 4 + 4 * 8;
constexpr std::size_t kBytesPerHit = 8 + 4 + 1 + 8 * wire_contract::kHitNumbers;
// The rest is for the fixed fields, the lengths of the sequences and what DDS puts around a message.
constexpr std::size_t kRoom = wire_contract::kMaxMessageBytes - 4'096;

}  // namespace

void ReplyFiller::start(ReplyColumns& columns) {
  wire::clear(columns);
  first_ = question_;
  bytes_ = 0;
  ++reply_number_;
  if (named_in_.size() < snapshot_.objects.size()) named_in_.resize(snapshot_.objects.size(), 0);
}

bool ReplyFiller::fill(ReplyColumns& columns) {
  if (question_ >= answers_.answers.size()) return false;
  start(columns);
  while (question_ < answers_.answers.size() && add_question(columns)) ++question_;
  return true;
}

const ObjectInfo* ReplyFiller::info_of(ObjectId id) const {
  const std::uint32_t slot = slot_of(id);
  return slot < snapshot_.objects.size() ? snapshot_.objects[slot].get() : nullptr;
}

std::string_view ReplyFiller::name_of(ObjectId id) const {
  const ObjectInfo* info = info_of(id);
  return info ? std::string_view(info->name) : std::string_view();
}

/// Bytes that the hit adds to this reply, with its object's name if the reply does not have it yet.
std::size_t ReplyFiller::bytes_of(const AnswerHit& hit) {
  const std::uint32_t slot = slot_of(hit.object);
  const bool named = slot < named_in_.size() && named_in_[slot] == reply_number_;
  return kBytesPerHit + (named ? 0 : sizeof(ObjectId) + name_of(hit.object).size() + 1);
}

bool ReplyFiller::leaves_covered() const {
  return not_covered_ < answers_.not_covered.size() && answers_.not_covered[not_covered_].question == question_;
}

/// Records where the question leaves the covered space, if it does. A truncated answer has another reason.
void ReplyFiller::add_not_covered(bool is_cut, ReplyColumns& columns) {
  if (!leaves_covered()) return;
  const NotCovered& entry = answers_.not_covered[not_covered_++];
  if (is_cut) return;
  columns.uncovered_questions.push_back(static_cast<std::uint32_t>(question_ - first_));
  put(columns.uncovered_points, entry.leaving.point);
  put(columns.uncovered_distances, entry.leaving.covered_m);
}

void ReplyFiller::add_hit(std::size_t index, ReplyColumns& columns) {
  const AnswerHit& hit = answers_.hits[index];
  const std::uint32_t slot = slot_of(hit.object);
  if (slot < named_in_.size() && named_in_[slot] != reply_number_) {
    named_in_[slot] = reply_number_;
    columns.named_ids.push_back(hit.object);
    put(columns.names, name_of(hit.object));
  }
  columns.objects.push_back(hit.object);
  const ObjectInfo* info = info_of(hit.object);
  columns.triangles.push_back(info ? info->reported_triangle(hit.triangle) : hit.triangle);
  columns.hit_flags.push_back(hit.flags);
  if (answers_.brackets.empty()) {
    put(columns.distances, hit.distance_m);
    put(columns.distance_errors, hit.error_m);
    put(columns.exits, hit.exit_m);
  } else {
    const TimeBracket& bracket = answers_.brackets[index];
    put(columns.sweep_ends, bracket.high);
    put(columns.sweep_widths, bracket.high - bracket.low);
    put(columns.sweep_begins, bracket.low);
  }
  put(columns.points, hit.point);
  put(columns.normals, hit.normal);
  put(columns.weights, hit.weights);
  put(columns.point_errors, hit.point_error_m);
}

/// False: the reply has no room for this question, which starts the next one.
bool ReplyFiller::add_question(ReplyColumns& columns) {
  const std::size_t hit_count = answers_.hit_counts[question_];
  // An upper bound: a name that repeats within the question is counted each time.
  const std::size_t own_bytes = kBytesPerAnswer + (leaves_covered() ? kBytesPerNotCovered : 0);
  std::size_t bytes = own_bytes;
  for (std::size_t i = 0; i < hit_count; ++i) bytes += bytes_of(answers_.hits[hit_ + i]);
  const bool alone = columns.answers.empty();
  const bool fits = bytes_ + bytes <= kRoom && columns.objects.size() + hit_count <= wire_contract::kMaxHitsPerChunk;
  if (!fits && !alone) return false;
  bytes_ += own_bytes;
  std::size_t kept = 0;
  for (; kept < hit_count && kept < wire_contract::kMaxHitsPerChunk; ++kept) {
    const std::size_t more = bytes_of(answers_.hits[hit_ + kept]);
    if (bytes_ + more > kRoom) break;
    bytes_ += more;
    add_hit(hit_ + kept, columns);
  }
  const bool cut = kept < hit_count;
  add_not_covered(cut, columns);
  const Verdict answer = cut ? Verdict::undecided : answers_.answers[question_];
  columns.answers.push_back(static_cast<std::uint8_t>(answer));
  columns.reasons.push_back(static_cast<std::uint8_t>(cut ? UndecidedReason::truncated : answers_.reasons[question_]));
  columns.levels.push_back(answers_.levels[question_]);
  columns.hit_counts.push_back(static_cast<std::uint32_t>(kept));
  columns.nodes.push_back(answers_.nodes[question_]);
  columns.exact_tests.push_back(answers_.exact_tests[question_]);
  if (answer == Verdict::undecided) ++undecided_;
  hit_ += hit_count;
  return true;
}

}  // namespace collided::engine::service
