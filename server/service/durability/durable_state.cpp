#include "server/service/durability/durable_state.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <future>
#include <nlohmann/json.hpp>
#include <utility>

#include "server/service/durability/journal_layout.hpp"
#include "server/service/runtime/named_thread.hpp"

namespace collided::engine::service {
namespace {

// Entries that are not commands.
constexpr std::string_view kPublisher = "publisher/";
constexpr std::string_view kCovers = "covers";
constexpr std::string_view kLoss = "loss/";

std::string key(std::string_view kind, std::string_view name) { return fmt::format("{}{}", kind, name); }
std::string key(std::uint64_t publisher) { return fmt::format("{}{:016x}", kPublisher, publisher); }

std::string this_layout() {
  const std::string_view number = journal_layout::kMagic.substr(journal_layout::kMagicStem.size());
  return std::string(number.substr(0, number.size() - 1));
}

/// How much a journal keeps of each kind, such as "2 scenes, 1 probes"; empty: nothing added by commands.
std::string counts_of(const Journal& journal) {
  constexpr std::string_view kWords[] = {"removed scenes",  "scenes",      "removed parts", "objects",
                                         "moves in scenes", "moves",       "probes",        "standing questions",
                                         "rules",           "attachments", "shard maps"};
  std::map<std::size_t, std::size_t> counts;  // by kind; losses come last
  for (const Journal::Entry& entry : journal.entries()) {
    if (const std::optional<KeptKey> key = KeptKey::parse(entry.key)) ++counts[static_cast<std::size_t>(key->kind)];
    else if (entry.key.starts_with(kLoss)) ++counts[std::size(kWords)];
  }
  std::string text;
  for (const auto& [kind, count] : counts) {
    const std::string_view word = kind < std::size(kWords) ? kWords[kind] : "losses";
    text += fmt::format("{}{} {}", text.empty() ? "" : ", ", count, word);
  }
  return text;
}

}  // namespace

DurableState::DurableState(std::unique_ptr<Disk> disk, const std::string& file, PastEnd past, Notice notice,
                           Start start)
    : journal_(std::move(disk), file), notice_(std::move(notice)), jobs_(kMostJobs) {
  if (start == Start::drops) {
    const std::string& other = journal_.other_layout();
    dropped_ = other.empty() ? counts_of(journal_) : fmt::format("a journal of layout {}", other);
    journal_.clear();
  } else {
    take_over(file, past);
  }
  say_problem();
  thread_ = named_thread("journal", [this] {
    while (std::optional<Job> job = jobs_.pop()) (*job)();
  });
}

/// Reads the state that the earlier process left, and what is missing of it.
void DurableState::take_over(const std::string& file, PastEnd past) {
  using Left = Journal::Left;
  if (!journal_.other_layout().empty())
    throw StateError(
        fmt::format("{}: its layout is {}, and this version reads layout {}. Nothing was started, and the file is as "
                    "it was",
                    file, journal_.other_layout(), this_layout()));
  const bool says_nothing = journal_.left() == Left::none || journal_.left() == Left::unknown;
  crashed_ = journal_.left() == Left::open || (says_nothing && past == PastEnd::running) ||
             (journal_.left() == Left::unknown && past == PastEnd::unknown);
  if (!journal_.damage().empty()) notice_(journal_.damage());
  read_left();
  if (journal_.may_have_lost()) lose(key(kLoss, journal_.damage()), journal_.damage());
  // Every process makes a journal at its start, so a missing one was lost if there was a process.
  if (journal_.left() == Left::none && past != PastEnd::unknown) {
    const std::string missing = fmt::format("{} is missing or cannot be read: all that commands had added", file);
    lose(key(kLoss, missing), missing);
  }
  // The next process must know of the loss too, when the damaged file has been replaced.
  for (const auto& [key, sentence] : losses_)
    journal_.put({.key = key, .text = sentence, .blob = {}}, Journal::Sync::now);
  if (!crashed_) {
    journal_.open();
    forget_publishers();
  }
  publishers_.insert(publishers_left_.begin(), publishers_left_.end());
}

/// The publishers of a server that was stopped may never come back.
void DurableState::forget_publishers() {
  std::vector<std::string> gone;
  for (const std::uint64_t publisher : publishers_left_) gone.push_back(key(publisher));
  if (!gone.empty()) journal_.erase(gone, Journal::Sync::later);
  publishers_left_.clear();
}

void DurableState::read_left() {
  KeptCommands left;
  for (const Journal::Entry& entry : journal_.entries()) {
    if (std::optional<KeptKey> key = KeptKey::parse(entry.key))
      left.put({.key = std::move(*key), .text = entry.text, .blob = entry.blob});
    had_covers_ = had_covers_ || entry.key == kCovers;
    if (entry.key.starts_with(kLoss)) lose(entry.key, entry.text);
    std::uint64_t publisher = 0;
    const char* end = entry.key.data() + entry.key.size();
    if (!entry.key.starts_with(kPublisher)) continue;
    if (std::from_chars(entry.key.data() + kPublisher.size(), end, publisher, 16).ptr == end)
      publishers_left_.push_back(publisher);
  }
  left.for_each([&](const KeptCommand& command) {
    commands_left_.push_back(command);
    due_.insert(command.key.text());
  });
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
  notice_(problem.empty() ? "what is added is kept again"
                          : problem + "; what is added now is lost when the server ends");
}

std::string DurableState::problem() const {
  const std::lock_guard lock(said_mutex_);
  return said_;
}

void DurableState::change(std::vector<std::string> erased, std::vector<Journal::Entry> put, Journal::Sync sync) {
  {
    const std::lock_guard lock(losses_mutex_);
    const auto settle = [&](const std::string& key) { losses_.erase(key), due_.erase(key); };
    for (const std::string& key : erased) settle(key);
    for (const Journal::Entry& entry : put) settle(entry.key);
    has_losses_.store(!losses_.empty());
  }
  jobs_.push([this, erased = std::move(erased), put = std::move(put), sync] {
    journal_.change(erased, put, sync);
    say_problem();
  });
}

// ---- losses

/// With losses_mutex_ held, once there are other threads.
void DurableState::lose(const std::string& key, const std::string& why) {
  losses_[key] = why;
  has_losses_.store(true);
}

std::vector<std::string> DurableState::losses() const {
  const std::lock_guard lock(losses_mutex_);
  std::vector<std::string> sentences;
  for (const auto& [key, sentence] : losses_) sentences.push_back(sentence);
  return sentences;
}

void DurableState::not_restored(std::uint64_t place, const std::string& why) {
  if (place < 1 || place > commands_left_.size()) return;
  const KeptKey& key = commands_left_[place - 1].key;
  // No part of the world depends on it: the server has since received another shard map.
  if (key.kind == KeptKind::succession) return;
  const std::lock_guard lock(losses_mutex_);
  if (due_.contains(key.text())) lose(key.text(), why);
}

bool DurableState::is_due(const KeptKey& key) const {
  const std::lock_guard lock(losses_mutex_);
  return due_.contains(key.text());
}

std::vector<KeptKey> DurableState::accept_losses() {
  std::vector<std::string> keys;
  std::vector<KeptKey> not_restored;
  {
    const std::lock_guard lock(losses_mutex_);
    for (const auto& [key, sentence] : losses_) keys.push_back(key);
  }
  for (const std::string& key : keys) {
    if (std::optional<KeptKey> command = KeptKey::parse(key)) not_restored.push_back(std::move(*command));
  }
  change(std::move(keys), {});
  return not_restored;
}

// ---- what commands did

void DurableState::restore(Inventory& inventory) {
  const std::set<std::string>& start_scenes = inventory.start_scenes();
  std::set<std::string> kept;   // scenes that commands had loaded
  std::set<std::string> given;  // of these, loaded by the start options now, and not put in place by a command
  for (const KeptCommand& command : commands_left_) {
    if (command.key.kind != KeptKind::scene) continue;
    const std::string& scene = command.key.name;
    kept.insert(scene);
    const nlohmann::json load = nlohmann::json::parse(command.text, nullptr, false);
    const bool replaces = is_due({KeptKind::cleared, scene}) || (load.is_object() && load.value("replace", false));
    // After a crash the options have hardly been changed on purpose: the scene is a loss, and stays for a start that
    // has room for it.
    if (!crashed_ && start_scenes.contains(scene) && !replaces) given.insert(scene);
  }
  const auto is_moot = [&](const KeptKey& key) {
    if (key.kind == KeptKind::scene) return given.contains(key.name);
    if (key.kind == KeptKind::cleared) return !start_scenes.contains(key.name);
    const std::string scene = key.scene();
    const bool is_there = start_scenes.contains(scene) || kept.contains(scene);
    return !scene.empty() && (!is_there || given.contains(scene));
  };
  std::vector<std::string> moot;
  for (const KeptCommand& command : commands_left_) {
    if (is_moot(command.key)) moot.push_back(command.key.text());
    else inventory.restore(command);
  }
  if (moot.empty()) return;
  notice_(fmt::format("the start options name other scenes than before: {} of what was kept about scenes is dropped",
                      moot.size()));
  change(std::move(moot), {});
}

void DurableState::keep(const Inventory::Changes& changes) {
  std::vector<std::string> erased;
  std::vector<Journal::Entry> put;
  for (const KeptKey& key : changes.erased) {
    if (key.kind != KeptKind::published) erased.push_back(key.text());
  }
  for (const KeptCommand& command : changes.put) {
    if (command.owner == 0) put.push_back({.key = command.key.text(), .text = command.text, .blob = command.blob});
  }
  if (!erased.empty() || !put.empty()) change(std::move(erased), std::move(put));
}

std::vector<KeptCommand> DurableState::followed(const Inventory& inventory) const {
  std::vector<KeptCommand> all;
  inventory.commands().for_each([&](const KeptCommand& command) {
    const bool waits = command.key.kind == KeptKind::attached && is_due(command.key);
    if (command.owner == 0 && !waits) all.push_back(command);
  });
  return all;
}

void DurableState::covers_stated() { change({}, {{.key = std::string(kCovers), .text = {}, .blob = {}}}); }

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

void DurableState::ask_room(std::uint64_t bytes, std::function<void(const std::string&)> done) {
  const bool taken = jobs_.push([this, bytes, done] { done(journal_.has_room(bytes) ? "" : journal_.problem()); });
  if (!taken) done("the server is stopping");
}

}  // namespace collided::engine::service
