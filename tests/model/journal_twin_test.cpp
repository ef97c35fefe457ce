#include <gtest/gtest.h>

#include <cerrno>
#include <cstdlib>
#include <list>

#include "server/service/durability/journal.hpp"
#include "tests/model/random_world.hpp"
#include "tests/oracle/seed.hpp"
#include "tests/model/rounds_asked.hpp"

// One journal, written, rewritten and opened again at random, beside a plain list of what it must hold.
namespace collided::model {
using namespace engine;
namespace {

using service::Disk;
using service::Journal;
using Bytes = std::vector<std::byte>;

/// Files in memory; some calls fail, and half of what they were to do is done.
class FlakyDisk final : public Disk {
 public:
  using Files = std::map<std::string, Bytes>;
  FlakyDisk(Files& files, const bool& fails) : files_(files), fails_(fails) {}
  std::optional<Bytes> read(const std::string& name) override {
    return files_.contains(name) ? std::optional(files_.at(name)) : std::nullopt;
  }
  bool create(const std::string& name) override {
    files_[name].clear();
    return !fails_;
  }
  bool append(const std::string& name, std::span<const std::byte> bytes) override {
    const std::span<const std::byte> taken = bytes.first(fails_ ? bytes.size() / 2 : bytes.size());
    files_[name].insert(files_[name].end(), taken.begin(), taken.end());
    if (fails_) errno = files_[name].size() % 2 == 0 ? ENOSPC : EIO;
    return !fails_;
  }
  bool overwrite(const std::string& name, std::uint64_t at, std::span<const std::byte> bytes) override {
    if (!fails_) std::copy(bytes.begin(), bytes.end(), files_[name].begin() + static_cast<std::ptrdiff_t>(at));
    return !fails_;
  }
  bool cut(const std::string& name, std::uint64_t bytes) override {
    files_[name].resize(bytes);
    return true;
  }
  bool remove(const std::string& name) override {
    files_.erase(name);
    return true;
  }
  bool link(const std::string&, const std::string&) override { return !fails_; }
  bool reserve(const std::string&, std::uint64_t) override { return !fails_; }
  bool sync(const std::string&) override { return !fails_; }
  bool rename(const std::string& from, const std::string& to) override {
    if (fails_) return false;
    files_[to] = files_.at(from);
    files_.erase(from);
    return true;
  }

 private:
  Files& files_;
  const bool& fails_;
};

TEST(JournalTwin, WhatIsReadBackIsWhatWasPutWhileItSaidNoProblem) {
  std::mt19937_64 random = oracle::seeded(174);
  RandomWorld make(random);
  FlakyDisk::Files files;
  bool fails = false;
  const auto open = [&] { return std::make_unique<Journal>(std::make_unique<FlakyDisk>(files, fails), "state"); };
  std::unique_ptr<Journal> journal = open();
  std::list<Journal::Entry> plain;
  const auto find = [&](const std::string& key) {
    return std::find_if(plain.begin(), plain.end(), [&](const Journal::Entry& entry) { return entry.key == key; });
  };
  for (int i = 0; i < rounds_asked(3'000); ++i) {
    fails = make.chance(0.03);
    const double what = make.uniform(0, 1);
    if (what < 0.6) {
      const Journal::Entry entry{.key = make.name(),
                                 .text = std::to_string(i),
                                 .blob = Bytes(static_cast<std::size_t>(make.below(20'000)), std::byte(i))};
      journal->put(entry, make.chance(0.5) ? Journal::Sync::now : Journal::Sync::later);
      if (find(entry.key) == plain.end()) plain.push_back(entry);
      else *find(entry.key) = entry;
    } else if (what < 0.8) {
      const std::vector<std::string> keys{make.name(), make.name()};
      journal->erase(keys, Journal::Sync::now);
      std::erase_if(plain, [&](const Journal::Entry& entry) { return entry.key == keys[0] || entry.key == keys[1]; });
    } else if (what < 0.802) {
      journal->clear();
      plain.clear();
    } else if (what < 0.9 && journal->problem().empty()) {
      journal = open();
      ASSERT_EQ(journal->damage(), "") << "round " << i;
    }
    ASSERT_EQ(journal->entries(), plain) << "round " << i;
  }
}

}  // namespace
}  // namespace collided::model
