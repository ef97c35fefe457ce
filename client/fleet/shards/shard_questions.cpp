#include "client/fleet/shards/shard_questions.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <future>
#include <memory>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "client/library/asking/question_encoding.hpp"
#include "client/library/connection/errors.hpp"
#include "client/fleet/shards/answer_merging.hpp"
#include "client/fleet/shards/question_reach.hpp"
#include "client/fleet/shards/shard_instants.hpp"
#include "idl/topics.hpp"

namespace collided::client {
namespace {

using shards::for_each_place;
using shards::ShardMap;
using shards::ShardSet;
using wire_contract::kMaxQuestionsPerRequest;

template <class Question>
std::optional<Error> fault_of(std::span<const Question> questions) {
  const std::string noun = QuestionWire<Question>::noun;
  if (questions.empty() || questions.size() > kMaxQuestionsPerRequest) {
    return bad_input(noun + ": " + std::to_string(questions.size()) + " questions; a request holds 1 to " +
                     std::to_string(kMaxQuestionsPerRequest));
  }
  for (std::size_t i = 0; i < questions.size(); ++i) {
    const auto wrong = fault(questions[i]);
    if (wrong) return bad_input((questions.size() == 1 ? noun : noun + ' ' + std::to_string(i)) + ": " + *wrong);
  }
  return std::nullopt;
}

/// What one shard was asked in a round, and what it said.
struct ShardShare {
  std::vector<std::uint32_t> questions;  // their numbers in the batch, ascending
  std::vector<Answer> answers;           // as many, or none where it did not answer
};

/// One batch.
template <class Question>
class ShardBatch {
 public:
  ShardBatch(ShardLinks& links, std::span<const Question> questions, const AskOptions& options)
      : links_(links), view_(links.view()), questions_(questions), options_(options) {}

  Result<Answers> run() {
    // The world of a shard that rested may have begun to change between its time and its answer.
    constexpr int kMostTries = 3;
    for (int tries = 0; tries < kMostTries; ++tries) {
      Result<ShardInstants> instants = choose_instants(links_, map_, options_);
      if (!instants) return instants.error();
      instants_ = std::move(*instants);
      is_outrun_ = false;
      total_ = {};
      if (auto error = ask_all()) return *error;
      if (!is_outrun_) return merge();
    }
    return Error{ErrorCode::timeout, "the shards began to change while they were asked about one instant", "ask again"};
  }

 private:
  std::optional<Error> ask_all() {
    first_.assign(map_.size(), {});
    second_.assign(map_.size(), {});
    asked_.assign(questions_.size(), 0);
    for (std::size_t i = 0; i < questions_.size(); ++i) put(i, first_shards(questions_[i]), first_);
    if (auto error = ask_round(first_)) return error;
    if constexpr (std::is_same_v<Question, NearQuestion>) {
      for (std::size_t i = 0; i < questions_.size(); ++i) {
        const Answer found = merged_of(i);
        put(i, shards_left(questions_[i], map_, options_, found) & ~asked_[i], second_);
      }
      return ask_round(second_);
    }
    return std::nullopt;
  }

  ShardSet first_shards(const Question& question) const {
    if constexpr (std::is_same_v<Question, NearQuestion>) {
      return ShardSet{1} << map_.owner_of({question.point.x(), question.point.y(), question.point.z()});
    } else {
      return touched_shards(map_, question);
    }
  }

  void put(std::size_t question, ShardSet shards, std::vector<ShardShare>& round) {
    asked_[question] |= shards;
    for_each_place(shards,
                   [&](std::size_t place) { round[place].questions.push_back(static_cast<std::uint32_t>(question)); });
  }

  std::vector<Question> questions_of(const ShardShare& share) const {
    std::vector<Question> chosen;
    chosen.reserve(share.questions.size());
    for (const std::uint32_t number : share.questions) chosen.push_back(questions_[number]);
    return chosen;
  }

  AskOptions options_for(std::size_t place) const {
    AskOptions asked = options_;
    asked.as_of = instants_.of_shard[place].instant;
    return asked;
  }

  /// All shards work at once. Error: one of them refuses, or something is wrong here.
  std::optional<Error> ask_round(std::vector<ShardShare>& round) {
    std::vector<std::shared_ptr<Client>> clients(round.size());
    std::vector<std::future<Result<Answers>>> asked(round.size());
    for (std::size_t place = 0; place < round.size(); ++place) {
      if (round[place].questions.empty() || !instants_.of_shard[place].is_there) continue;
      clients[place] = links_.shard(place);
      if (clients[place]) asked[place] = clients[place]->ask_async(questions_of(round[place]), options_for(place));
    }
    std::optional<Error> failed;
    for (std::size_t place = 0; place < round.size(); ++place) {
      if (!asked[place].valid()) continue;
      Result<Answers> answers = asked[place].get();
      // Another server is in its place since it was last looked at: it must say who it is.
      if (answers && answers->epoch != links_.epoch(place) && links_.check(place))
        answers = clients[place]->ask(questions_of(round[place]), options_for(place));
      if (answers && answers->epoch == links_.epoch(place)) take(std::move(*answers), place, round[place]);
      else if (!answers && !is_silence(answers.error())) failed = in_shard(place, answers.error());
    }
    return failed;
  }

  Error in_shard(std::size_t place, Error error) const {
    error.message = "shard '" + map_.at(place).name + "': " + error.message;
    return error;
  }

  void take(Answers&& answers, std::size_t place, ShardShare& share) {
    const std::optional<std::uint64_t>& version = instants_.of_shard[place].version;
    is_outrun_ = is_outrun_ || (version && answers.version != *version);
    total_.compute += answers.compute;
    if (answers.oldest_pose_age)
      total_.oldest_pose_age =
          std::max(*answers.oldest_pose_age, total_.oldest_pose_age.value_or(std::chrono::nanoseconds(0)));
    const bool is_first = total_.world_time.count() == 0;
    total_.world_time = is_first ? answers.world_time : std::min(total_.world_time, answers.world_time);
    share.answers = std::move(answers.answers);
  }

  /// Of what was answered so far.
  Answer merged_of(std::size_t question) const {
    std::array<ShardAnswer, ShardMap::kMostShards> given;
    std::size_t count = 0;
    for_each_place(asked_[question], [&](std::size_t place) {
      const Answer* answer = answer_in(first_[place], question);
      if (answer == nullptr) answer = answer_in(second_[place], question);
      given[count++] = {.place = place, .answer = answer};
    });
    return merged(questions_[question], map_, options_, std::span(given).first(count));
  }

  static const Answer* answer_in(const ShardShare& share, std::size_t question) {
    if (share.answers.empty()) return nullptr;
    const auto found = std::ranges::lower_bound(share.questions, question);
    if (found == share.questions.end() || *found != question) return nullptr;
    return &share.answers[static_cast<std::size_t>(found - share.questions.begin())];
  }

  Answers merge() {
    total_.answers.reserve(questions_.size());
    for (std::size_t i = 0; i < questions_.size(); ++i) total_.answers.push_back(merged_of(i));
    if (instants_.time) total_.world_time = *instants_.time;
    return std::move(total_);
  }

  ShardLinks& links_;
  const std::shared_ptr<const ShardView> view_;
  const ShardMap& map_ = view_->asked;
  const std::span<const Question> questions_;
  const AskOptions& options_;
  ShardInstants instants_;
  bool is_outrun_ = false;
  std::vector<ShardShare> first_;   // by the shard's place
  std::vector<ShardShare> second_;  // of near
  std::vector<ShardSet> asked_;     // by question
  Answers total_;
};

}  // namespace

template <class Question>
Result<Answers> ask_shards(ShardLinks& links, std::span<const Question> questions, const AskOptions& options) {
  if (auto error = fault_of(questions)) return *error;
  return ShardBatch<Question>(links, questions, options).run();
}

template Result<Answers> ask_shards(ShardLinks&, std::span<const RayQuestion>, const AskOptions&);
template Result<Answers> ask_shards(ShardLinks&, std::span<const SphereQuestion>, const AskOptions&);
template Result<Answers> ask_shards(ShardLinks&, std::span<const BoxQuestion>, const AskOptions&);
template Result<Answers> ask_shards(ShardLinks&, std::span<const NearQuestion>, const AskOptions&);
template Result<Answers> ask_shards(ShardLinks&, std::span<const InsideQuestion>, const AskOptions&);

}  // namespace collided::client
