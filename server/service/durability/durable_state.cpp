#include "server/service/durability/durable_state.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <future>
#include <nlohmann/json.hpp>
#include <utility>

#include "idl/commands.hpp"
#include "server/service/runtime/named_thread.hpp"

namespace collided::engine::service {
namespace {

// The kinds of entries, in the order in which they are carried out again.
constexpr std::string_view kCleared = "cleared/";  // a scene out of the start options
constexpr std::string_view kScene = "scene/";
constexpr std::string_view kGone = "gone/";  // a member of a scene
constexpr std::string_view kObject = "object/";
constexpr std::string_view kMemberMoved = "member_moved/";
constexpr std::string_view kMoved = "moved/";
constexpr std::string_view kProbe = "probe/";
constexpr std::string_view kFence = "fence/";
constexpr std::string_view kAttached = "attached/";      // by the name of the child
constexpr std::string_view kRule = "rule/";              // with the place in their order
constexpr std::string_view kSuccession = "succession/";  // of the shard's map, of which there is one
// These are no commands.
constexpr std::string_view kPublisher = "publisher/";
constexpr std::string_view kCovers = "covers";
constexpr std::string_view kLoss = "loss/";

std::string key(std::string_view kind, std::string_view name) { return fmt::format("{}{}", kind, name); }
std::string key(std::uint64_t publisher) { return fmt::format("{}{:016x}", kPublisher, publisher); }
/// No name has a line feed in it.
std::string member_key(std::string_view kind, std::string_view scene, std::string_view member) {
  return fmt::format("{}{}\n{}", kind, scene, member);
}

/// Visits the entries that are commands, in the order in which they are carried out again.
template <class Visit>
void for_each_command(const Journal& journal, const Visit& visit) {
  for (const std::string_view kind :
       {kCleared, kScene, kGone, kObject, kMemberMoved, kMoved, kProbe, kFence, kRule, kAttached, kSuccession}) {
    for (const Journal::Entry& entry : journal.entries()) {
      if (entry.key.starts_with(kind)) visit(entry);
    }
  }
}

bool is_carried_out_again(const CommandAsk& ask) { return ask.client == 0 && ask.request != 0; }

}  // namespace

DurableState::DurableState(std::unique_ptr<Disk> disk, const std::string& file, PastEnd past, Notice notice)
    : journal_(std::move(disk), file), notice_(std::move(notice)), jobs_(kMostJobs) {
  using Left = Journal::Left;
  const bool says_nothing = journal_.left() == Left::none || journal_.left() == Left::unknown;
  crashed_ = journal_.left() == Left::open || (says_nothing && past == PastEnd::running) ||
             (journal_.left() == Left::unknown && past == PastEnd::unknown);
  if (!journal_.damage().empty()) notice_(journal_.damage());
  if (crashed_) {
    read_left();
    if (journal_.may_have_lost()) lose(key(kLoss, journal_.damage()), journal_.damage());
    if (journal_.left() == Left::none) {
      const std::string missing = fmt::format("{} is missing or cannot be read: all that commands had added", file);
      lose(key(kLoss, missing), missing);
    }
    // A loss must be known to the next process, too, when the damaged file has been replaced.
    for (const auto& [key, sentence] : losses_)
      journal_.put({.key = key, .text = sentence, .blob = {}}, Journal::Sync::now);
  } else {
    journal_.clear();
  }
  is_restoring_ = !commands_left_.empty();
  publishers_.insert(publishers_left_.begin(), publishers_left_.end());
  say_problem();
  thread_ = named_thread("journal", [this] {
    while (std::optional<Job> job = jobs_.pop()) (*job)();
  });
}

void DurableState::read_left() {
  for_each_command(journal_, [&](const Journal::Entry& entry) {
    commands_left_.push_back({0, commands_left_.size() + 1, entry.text, entry.blob});
    keys_left_.push_back(entry.key);
  });
  for (const Journal::Entry& entry : journal_.entries()) {
    had_covers_ = had_covers_ || entry.key == kCovers;
    if (entry.key.starts_with(kLoss)) lose(entry.key, entry.text);
    std::uint64_t publisher = 0;
    const char* end = entry.key.data() + entry.key.size();
    if (!entry.key.starts_with(kPublisher)) continue;
    if (std::from_chars(entry.key.data() + kPublisher.size(), end, publisher, 16).ptr == end)
      publishers_left_.push_back(publisher);
  }
}

DurableState::~DurableState() { finish(); }

void DurableState::finish() {
  jobs_.close();
  if (thread_.joinable()) thread_.join();
}

/// Reports each new problem, and the end of one.
void DurableState::say_problem() {
  const std::string& problem = journal_.problem();
  {
    const std::lock_guard lock(said_mutex_);
    if (problem == said_) return;
    said_ = problem;
  }
  notice_(problem.empty() ? "what is added is kept over a crash again"
                          : problem + "; what is added now is lost with a crash");
}

std::string DurableState::problem() const {
  const std::lock_guard lock(said_mutex_);
  return said_;
}

void DurableState::change(std::vector<std::string> erased, std::vector<Journal::Entry> put, Journal::Sync sync) {
  {
    const std::lock_guard lock(losses_mutex_);
    for (const std::string& key : erased) note_erased(key);
    for (const Journal::Entry& entry : put) {
      keys_.insert(entry.key);
      losses_.erase(entry.key);
    }
    has_losses_.store(!losses_.empty());
  }
  jobs_.push([this, erased = std::move(erased), put = std::move(put), sync] {
    journal_.change(erased, put, sync);
    say_problem();
  });
}

/// With losses_mutex_ held.
void DurableState::note_erased(const std::string& key) {
  keys_.erase(key);
  losses_.erase(key);
  has_losses_.store(!losses_.empty());
  if (is_restoring_) erased_.insert(key);
}

/// Erases what is kept of a scene's members, those, too, that a crashed process left and that could not be carried out
/// again, and changes the rest in the same write: a crash must not find the one without the other.
void DurableState::change_without_members(const std::string& scene, std::vector<std::string> erased,
                                          std::vector<Journal::Entry> put) {
  const std::vector<std::string> stems{member_key(kGone, scene, ""), member_key(kMemberMoved, scene, "")};
  const auto is_one = [stems](const std::string& key) {
    return std::ranges::any_of(stems, [&](const std::string& stem) { return key.starts_with(stem); });
  };
  {
    const std::lock_guard lock(losses_mutex_);
    const std::set<std::string> known = keys_;
    for (const std::string& key : known) {
      if (is_one(key)) note_erased(key);
    }
    for (const std::string& key : keys_left_) {
      if (is_one(key)) note_erased(key);
    }
    for (const std::string& key : erased) note_erased(key);
    for (const Journal::Entry& entry : put) {
      keys_.insert(entry.key);
      losses_.erase(entry.key);
    }
    has_losses_.store(!losses_.empty());
  }
  jobs_.push([this, is_one, gone = std::move(erased), put = std::move(put)]() mutable {
    for (const auto& entry : journal_.entries()) {
      if (is_one(entry.key)) gone.push_back(entry.key);
    }
    journal_.change(gone, put, Journal::Sync::now);
    say_problem();
  });
}

// ---- losses

void DurableState::lose(const std::string& key, const std::string& why) {
  const std::lock_guard lock(losses_mutex_);
  if (keys_.contains(key)) return;  // meanwhile a client has put something in its place
  losses_[key] = why;
  has_losses_.store(true);
}

std::vector<std::string> DurableState::losses() const {
  const std::lock_guard lock(losses_mutex_);
  std::vector<std::string> sentences;
  for (const auto& [key, sentence] : losses_) sentences.push_back(sentence);
  return sentences;
}

void DurableState::not_restored(std::uint64_t request, const std::string& why) {
  if (request >= 1 && request <= keys_left_.size()) lose(keys_left_[request - 1], why);
}

bool DurableState::is_due(std::uint64_t request) const {
  const std::string& key = keys_left_.at(request - 1);
  const std::lock_guard lock(losses_mutex_);
  return !keys_.contains(key) && !erased_.contains(key);
}

void DurableState::accept_losses() {
  std::vector<std::string> keys;
  {
    const std::lock_guard lock(losses_mutex_);
    for (const auto& [key, sentence] : losses_) keys.push_back(key);
    losses_.clear();
    has_losses_.store(false);
  }
  change(std::move(keys), {});
}

void DurableState::note_restored() {
  const std::lock_guard lock(losses_mutex_);
  is_restoring_ = false;
  erased_.clear();
}

// ---- what commands did

void DurableState::scene_loaded(const std::string& scene, const CommandAsk& ask) {
  // What had been taken out of a scene that this one replaces, and moved in it, is there again. That a crashed process
  // left is still to be carried out again.
  std::vector<Journal::Entry> put{{.key = key(kScene, scene), .text = ask.text, .blob = {}}};
  if (is_carried_out_again(ask)) change({}, std::move(put));
  else change_without_members(scene, {}, std::move(put));
}

void DurableState::scene_removed(const std::string& scene) {
  std::vector<Journal::Entry> put;
  if (start_scenes_.contains(scene)) {
    const nlohmann::json again{{"command", wire_contract::command::kClear}, {"scene", scene}};
    put.push_back({.key = key(kCleared, scene), .text = again.dump(), .blob = {}});
  }
  change_without_members(scene, {key(kScene, scene)}, std::move(put));
}

void DurableState::removed(const std::vector<Removed>& gone) {
  std::vector<std::string> erased;
  std::vector<Journal::Entry> put;
  for (const Removed& one : gone) {
    if (one.scene.empty()) {
      erased.push_back(key(kObject, one.name));
      erased.push_back(key(kMoved, one.name));
      continue;
    }
    const nlohmann::json again{{"command", wire_contract::command::kRemove}, {"name", one.name}};
    erased.push_back(member_key(kMemberMoved, one.scene, one.name));
    put.push_back({.key = member_key(kGone, one.scene, one.name), .text = again.dump(), .blob = {}});
  }
  if (!erased.empty()) change(std::move(erased), std::move(put));
}

void DurableState::covers_stated() { change({}, {{.key = std::string(kCovers), .text = {}, .blob = {}}}); }

void DurableState::object_added(const std::string& object, const CommandAsk& ask) {
  // The move of an earlier object of this name must not apply to the new one. One that a crashed process left waits to
  // be carried out again.
  std::vector<std::string> erased;
  if (!is_carried_out_again(ask)) erased.push_back(key(kMoved, object));
  change(std::move(erased), {{.key = key(kObject, object), .text = ask.text, .blob = ask.blob}});
}

void DurableState::object_moved(const std::string& scene, const std::string& object, const CommandAsk& ask) {
  const std::string moved = scene.empty() ? key(kMoved, object) : member_key(kMemberMoved, scene, object);
  change({}, {{.key = moved, .text = ask.text, .blob = {}}});
}

void DurableState::probe_set(const std::string& probe, const CommandAsk& ask) {
  change({}, {{.key = key(kProbe, probe), .text = ask.text, .blob = {}}});
}

void DurableState::probes_removed(const std::vector<std::string>& probes) {
  std::vector<std::string> gone;
  for (const std::string& probe : probes) gone.push_back(key(kProbe, probe));
  if (!gone.empty()) change(std::move(gone), {});
}

void DurableState::fences_set(const std::vector<std::pair<std::string, CommandAsk>>& fences) {
  std::vector<Journal::Entry> put;
  for (const auto& [name, ask] : fences) put.push_back({.key = key(kFence, name), .text = ask.text, .blob = ask.blob});
  if (!put.empty()) change({}, std::move(put));
}

void DurableState::fences_removed(const std::vector<std::string>& fences) {
  std::vector<std::string> gone;
  for (const std::string& fence : fences) gone.push_back(key(kFence, fence));
  if (!gone.empty()) change(std::move(gone), {});
}

void DurableState::rules_set(std::size_t earlier_count, const std::vector<std::string>& rules) {
  const auto rule_key = [](std::size_t place) { return key(kRule, fmt::format("{:02}", place)); };
  std::vector<std::string> gone;
  std::vector<Journal::Entry> come;
  for (std::size_t i = rules.size(); i < earlier_count; ++i) gone.push_back(rule_key(i));
  for (std::size_t i = 0; i < rules.size(); ++i) come.push_back({.key = rule_key(i), .text = rules[i], .blob = {}});
  change(std::move(gone), std::move(come));
}

void DurableState::attached(const std::string& child, const std::string& command) {
  change({}, {{.key = key(kAttached, child), .text = command, .blob = {}}});
}

void DurableState::succession_set(const CommandAsk& ask) {
  change({}, {{.key = key(kSuccession, "map"), .text = ask.text, .blob = {}}});
}

void DurableState::detached(const std::string& child) { change({key(kAttached, child)}, {}); }

void DurableState::set_publishers(const std::set<std::uint64_t>& publishers) {
  if (publishers == publishers_ || !jobs_.has_room()) return;
  std::vector<std::string> gone;
  std::vector<Journal::Entry> come;
  for (const std::uint64_t publisher : publishers_) {
    if (!publishers.contains(publisher)) gone.push_back(key(publisher));
  }
  for (const std::uint64_t publisher : publishers) {
    if (!publishers_.contains(publisher)) come.push_back({.key = key(publisher), .text = {}, .blob = {}});
  }
  change(std::move(gone), std::move(come), Journal::Sync::later);
  publishers_ = publishers;
}

void DurableState::wait(std::chrono::milliseconds longest) {
  const auto written = std::make_shared<std::promise<void>>();
  then([written](const std::string&) { written->set_value(); });
  written->get_future().wait_for(longest);
}

void DurableState::then(std::function<void(const std::string&)> done) {
  const bool taken = jobs_.push([this, done] { done(journal_.problem()); });
  if (!taken) done("the server is stopping");
}

void DurableState::list_kept(std::function<void(std::vector<CommandAsk>)> done) {
  jobs_.push([this, done = std::move(done)] {
    std::vector<CommandAsk> kept;
    for_each_command(journal_, [&](const Journal::Entry& entry) { kept.push_back({0, 0, entry.text, entry.blob}); });
    done(std::move(kept));
  });
}

void DurableState::ask_room(std::uint64_t bytes, std::function<void(const std::string&)> done) {
  const bool taken = jobs_.push([this, bytes, done] { done(journal_.has_room(bytes) ? "" : journal_.problem()); });
  if (!taken) done("the server is stopping");
}

}  // namespace collided::engine::service
