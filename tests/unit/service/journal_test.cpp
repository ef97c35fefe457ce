// What outlives a crash, under every failure of the disk, losses of power, cuts and flipped bits.
#include "server/service/durability/journal.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cerrno>
#include <cstdint>
#include <ctime>
#include <filesystem>
#include <limits>
#include <list>
#include <map>
#include <random>
#include <unistd.h>

#include "server/service/durability/journal_layout.hpp"
#include "tests/oracle/seed.hpp"

namespace collided::engine::service {
namespace {

using Entries = std::list<Journal::Entry>;
using JournalBytes = std::vector<std::byte>;

/// A disk in memory: what was not synced may be gone, in part, when the power fails.
struct Platter {
  struct Overwritten {
    std::size_t at = 0;
    JournalBytes before;
  };
  struct File {
    JournalBytes content;
    std::size_t synced = 0;
    std::vector<Overwritten> unsynced;
  };
  std::map<std::string, File> files;
  int calls = 0;
  int fails_at = -1;            // this call, and with it a part of what it was to do
  int error = EIO;              // why
  std::size_t room = SIZE_MAX;  // of all files together
  bool dies = false;            // all calls after that one fail, and do nothing

  void lose_power(std::mt19937_64& random) {
    for (auto& [name, file] : files) {
      // Of what was overwritten an end is as it was, from nothing to all.
      for (auto old = file.unsynced.rbegin(); old != file.unsynced.rend(); ++old) {
        const std::size_t back = random() % (old->before.size() + 1);
        std::copy(old->before.end() - static_cast<std::ptrdiff_t>(back), old->before.end(),
                  file.content.begin() + static_cast<std::ptrdiff_t>(old->at + old->before.size() - back));
      }
      file.unsynced.clear();
      file.content.resize(file.synced + random() % (file.content.size() - file.synced + 1));
      file.synced = file.content.size();
    }
  }
};

class MemoryDisk final : public Disk {
 public:
  explicit MemoryDisk(Platter& platter) : platter_(platter) {}
  std::optional<JournalBytes> read(const std::string& name) override {
    const auto found = platter_.files.find(name);
    return found == platter_.files.end() ? std::nullopt : std::optional(found->second.content);
  }
  bool create(const std::string& name) override {
    if (fails()) return false;
    platter_.files[name] = {};
    return true;
  }
  bool append(const std::string& name, std::span<const std::byte> bytes) override {
    const bool failed = fails();
    JournalBytes& content = platter_.files[name].content;
    const std::size_t part = std::min(done_of(bytes.size(), failed), room_left());
    content.insert(content.end(), bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(part));
    if (!failed && part < bytes.size()) errno = ENOSPC;
    return part == bytes.size();
  }
  bool overwrite(const std::string& name, std::uint64_t at, std::span<const std::byte> bytes) override {
    const bool failed = fails();
    Platter::File& file = platter_.files[name];
    const auto first = file.content.begin() + static_cast<std::ptrdiff_t>(at);
    const auto part = static_cast<std::ptrdiff_t>(done_of(bytes.size(), failed));
    file.unsynced.push_back({.at = at, .before = JournalBytes(first, first + part)});
    std::copy_n(bytes.begin(), part, first);
    return !failed;
  }
  bool cut(const std::string& name, std::uint64_t bytes) override {
    if (fails()) return false;
    Platter::File& file = platter_.files[name];
    file.content.resize(std::min<std::size_t>(bytes, file.content.size()));
    file.synced = std::min(file.synced, file.content.size());
    return true;
  }
  bool sync(const std::string& name) override {
    if (fails()) return false;
    platter_.files[name].synced = platter_.files[name].content.size();
    platter_.files[name].unsynced.clear();
    return true;
  }
  bool rename(const std::string& from, const std::string& to) override {
    if (fails()) return false;
    platter_.files[to] = platter_.files[from];
    platter_.files.erase(from);
    return true;
  }
  bool remove(const std::string& name) override {
    if (fails()) return false;
    platter_.files.erase(name);
    return true;
  }
  bool link(const std::string& name, const std::string& second) override {
    if (fails()) return false;
    platter_.files[second] = platter_.files[name];
    return true;
  }
  bool reserve(const std::string&, std::uint64_t bytes) override {
    if (bytes > room_left()) errno = ENOSPC;
    return !fails() && bytes <= room_left();
  }

 private:
  std::size_t room_left() const {
    std::size_t taken = 0;
    for (const auto& [name, file] : platter_.files) taken += file.content.size();
    return platter_.room - std::min(taken, platter_.room);
  }
  bool is_dead() const { return platter_.dies && platter_.fails_at >= 0 && platter_.calls > platter_.fails_at + 1; }
  bool fails() {
    errno = platter_.error;
    return platter_.calls++ == platter_.fails_at || is_dead();
  }
  std::size_t done_of(std::size_t bytes, bool failed) const { return is_dead() ? 0 : failed ? bytes / 2 : bytes; }
  Platter& platter_;
};

Journal open(Platter& platter) { return Journal(std::make_unique<MemoryDisk>(platter), "it"); }

Journal::Entry entry(std::uint64_t number, std::mt19937_64& random) {
  JournalBytes blob(random() % 300);
  for (std::byte& byte : blob) byte = static_cast<std::byte>(random());
  return {.key = "object/" + std::to_string(number), .text = "add " + std::to_string(random() % 1000), .blob = blob};
}

/// What the journal's user has done; the journal's entries must always be these.
struct Book {
  Entries entries;
  void put(const Journal::Entry& entry) {
    const auto known = std::ranges::find(entries, entry.key, &Journal::Entry::key);
    if (known != entries.end()) {
      *known = entry;
    } else {
      entries.push_back(entry);
    }
  }
  void erase(const std::string& key) {
    std::erase_if(entries, [&](const Journal::Entry& e) { return e.key == key; });
  }
};

/// Some changes; every state on the way, the last one last.
std::vector<Entries> work(Journal& journal, int changes, std::mt19937_64& random) {
  Book book{journal.entries()};
  std::vector<Entries> states{book.entries};
  for (int i = 0; i < changes; ++i) {
    if (random() % 4 == 0) {
      const std::string key = "object/" + std::to_string(random() % 8);
      journal.erase(std::span(&key, 1), Journal::Sync::now);
      book.erase(key);
    } else {
      const Journal::Entry made = entry(random() % 8, random);
      journal.put(made, Journal::Sync::now);
      book.put(made);
    }
    EXPECT_EQ(journal.entries(), book.entries);
    states.push_back(book.entries);
  }
  return states;
}

TEST(ServiceJournal, WhatWasPutIsThereForTheNextProcess) {
  std::mt19937_64 random = oracle::seeded(91);
  const auto folder = std::filesystem::temp_directory_path() / ("journal_" + std::to_string(::getpid()));
  std::filesystem::create_directories(folder);
  Entries last;
  for (int life = 0; life < 5; ++life) {
    Journal journal(disk_in(folder.string()), "it.journal");
    EXPECT_EQ(journal.entries(), last);
    EXPECT_EQ(journal.damage(), "");
    last = work(journal, 30, random).back();
    EXPECT_EQ(journal.problem(), "");
  }
  std::filesystem::remove_all(folder);
  Journal gone(disk_in(folder.string()), "it.journal");
  EXPECT_TRUE(gone.entries().empty());
  gone.put(entry(1, random), Journal::Sync::now);
  EXPECT_NE(gone.problem(), "") << "a folder that is not there cannot be written";
}

// The n-th call of the disk fails, half done: nothing is lost as long as the disk works again, and it is said until it
// does; a loss of power at the end leaves the last state of which nothing was said.
// The kernel says a page for each of its own files, and gives a line: so does a file that is cut while it is read.
TEST(ServiceJournal, AFileThatHoldsLessThanItSaysIsReadToItsEnd) {
  const std::filesystem::path file = "/sys/kernel/cpu_byteorder";
  if (!std::filesystem::exists(file)) GTEST_SKIP() << "there is no " << file;
  const auto bytes = disk_in("/sys/kernel")->read("cpu_byteorder");
  ASSERT_TRUE(bytes);
  EXPECT_EQ(std::string(reinterpret_cast<const char*>(bytes->data()), bytes->size()), "little\n");
}

TEST(ServiceJournal, EveryFailureOfTheDiskIsSurvivedAndSaid) {
  std::mt19937_64 random = oracle::seeded(92);
  int said = 0;
  for (int n = 0; n < 500; ++n) {
    Platter platter;
    Journal journal = open(platter);
    platter.fails_at = n % 160;
    platter.error = n % 2 == 0 ? EIO : ENOSPC;
    std::vector<Entries> states{{}};
    std::size_t safe = 0;  // newest state of which no problem was said
    for (int i = 0; i < 40; ++i) {
      states.push_back(work(journal, 1, random).back());
      if (journal.problem().empty()) {
        safe = states.size() - 1;
      } else {
        ++said;
      }
      if (random() % 20 == 0) break;
    }
    platter.lose_power(random);
    const Journal next = open(platter);
    const auto kept = std::find(states.begin() + static_cast<std::ptrdiff_t>(safe), states.end(), next.entries());
    ASSERT_NE(kept, states.end()) << "call " << n << ": neither the last safe state nor a later one";
  }
  EXPECT_GT(said, 10) << "the failures must be worth testing";
}

TEST(ServiceJournal, CutsAndFlippedBitsAreDetected) {
  std::mt19937_64 random = oracle::seeded(93);
  Platter good;
  Journal journal = open(good);
  const std::vector<Entries> states = work(journal, 40, random);
  const JournalBytes& whole = good.files["it"].content;
  const auto damage_of = [&](const JournalBytes& content) {
    Platter damaged;
    damaged.files["it"].content = content;
    const Journal next = open(damaged);
    EXPECT_NE(std::ranges::find(states, next.entries()), states.end()) << "a state that never was";
    return next.damage();
  };
  ASSERT_EQ(damage_of(whole), "");
  // Every cut, those exactly between two records included.
  for (std::size_t size = 0; size < whole.size(); ++size) {
    ASSERT_NE(damage_of(JournalBytes(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(size))), "")
        << "cut at " << size;
  }
  for (std::size_t bit = 0; bit < 8 * whole.size(); bit += 1 + random() % 16) {
    JournalBytes content = whole;
    content[bit / 8] ^= static_cast<std::byte>(1u << bit % 8);
    ASSERT_NE(damage_of(content), "") << "bit " << bit;
  }
}

// The power goes during a call of a change, whatever had not been synced is lost in part: either state may be there, and
// nothing that was acknowledged is missed. A torn record or count is said to be just that.
TEST(ServiceJournal, ALossOfPowerIsNotTakenForALossOfWhatWasAcknowledged) {
  std::mt19937_64 random = oracle::seeded(96);
  int uncounted = 0;
  int torn = 0;
  for (int round = 0; round < 3'000; ++round) {
    Platter platter;
    Journal journal = open(platter);
    std::vector<Entries> states = work(journal, 1 + static_cast<int>(random() % 6), random);
    const std::size_t acknowledged_bytes = platter.files["it"].content.size();
    platter.fails_at = platter.calls + static_cast<int>(random() % 4);
    platter.dies = true;
    const Journal::Entry last = entry(99, random);
    journal.put(last, Journal::Sync::now);
    platter.lose_power(random);
    platter.fails_at = -1;
    const Journal next = open(platter);
    // Whatever became of the count that was being written, the other one still says what had been acknowledged.
    if (acknowledged_bytes > 0) {
      const auto count = journal_layout::head_of(platter.files["it"].content).newest;
      ASSERT_TRUE(count && count->bytes >= acknowledged_bytes);
    }
    const bool has_last = next.entries().size() == states.back().size() + 1 && next.entries().back() == last;
    ASSERT_TRUE(has_last || next.entries() == states.back());
    ASSERT_EQ(next.damage().find("what came after is lost"), std::string::npos) << next.damage();
    uncounted += has_last ? 1 : 0;
    torn += next.damage().empty() ? 0 : 1;
  }
  EXPECT_GT(uncounted, 100);
  EXPECT_GT(torn, 100);
}

TEST(ServiceJournal, AFileOfAnotherVersionIsNamedAndLeftAlone) {
  std::mt19937_64 random = oracle::seeded(97);
  Platter platter;
  { Journal(open(platter)).put(entry(1, random), Journal::Sync::now); }
  JournalBytes& content = platter.files["it"].content;
  const auto put_magic = [&](std::string_view magic) {
    std::ranges::copy(std::as_bytes(std::span(magic)), content.begin());
    return open(platter).other_layout();
  };
  EXPECT_EQ(put_magic("collided journal 3\n"), "3");
  EXPECT_EQ(put_magic("collided journal 12\n"), "12");
  EXPECT_TRUE(open(platter).entries().empty());
  EXPECT_EQ(open(platter).damage(), "") << "it is whole, and not for this version";
  EXPECT_EQ(put_magic("collided journal x\n"), "") << "that is damage";
  EXPECT_NE(open(platter).damage(), "");
  EXPECT_EQ(put_magic(journal_layout::kMagic), "");
}

TEST(ServiceJournal, AClosedFileThatIsOpenedAgainCountsAsOpen) {
  std::mt19937_64 random = oracle::seeded(103);
  Platter platter;
  for (int life = 0; life < 3; ++life) {
    Journal journal = open(platter);
    EXPECT_EQ(journal.left(), life == 0 ? Journal::Left::none : Journal::Left::closed);
    journal.open();
    EXPECT_EQ(open(platter).left(), Journal::Left::open) << "a crash before the first change";
    EXPECT_EQ(open(platter).entries(), journal.entries());
    journal.put(entry(static_cast<std::uint64_t>(life), random), Journal::Sync::now);
    journal.close();
    EXPECT_EQ(open(platter).damage(), "");
  }
  EXPECT_EQ(open(platter).entries().size(), 3U);
}

TEST(ServiceJournal, StaleRecordsDoNotPileUp) {
  std::mt19937_64 random = oracle::seeded(94);
  Platter platter;
  Journal journal = open(platter);
  for (int i = 0; i < 20'000; ++i) journal.put(entry(random() % 4, random), Journal::Sync::later);
  EXPECT_LT(platter.files["it"].content.size(), std::size_t{2} << 20);
  EXPECT_EQ(open(platter).entries(), journal.entries());
}

/// Seconds of the processor for so many entries, of which every second one is replaced and every fourth one erased.
double seconds_for(std::uint64_t entries) {
  Platter platter;
  Journal journal = open(platter);
  const std::clock_t before = std::clock();
  const auto put = [&](std::uint64_t i, const char* text) {
    journal.put({.key = "object/" + std::to_string(i), .text = text, .blob = {}}, Journal::Sync::now);
  };
  for (std::uint64_t i = 0; i < entries; ++i) put(i, "there");
  for (std::uint64_t i = 0; i < entries; i += 2) put(i, "elsewhere");
  for (std::uint64_t i = 0; i < entries; i += 4) {
    const std::string key = "object/" + std::to_string(i);
    journal.erase(std::span(&key, 1), Journal::Sync::now);
  }
  const double seconds = static_cast<double>(std::clock() - before) / CLOCKS_PER_SEC;
  EXPECT_EQ(journal.entries().size(), entries - entries / 4);
  return seconds;
}

// A hundred thousand objects are added one at a time. A search through the entries would take four times as long for
// twice as many.
TEST(ServiceJournal, TwiceAsManyEntriesTakeTwiceAsLong) {
  double few = std::numeric_limits<double>::infinity();
  double many = few;
  for (int i = 0; i < 5; ++i) {
    few = std::min(few, seconds_for(20'000));
    many = std::min(many, seconds_for(40'000));
  }
  EXPECT_LT(many / few, 3) << few << " s for 20,000, " << many << " s for 40,000";
}

TEST(ServiceJournal, AFileOfSomethingElseIsLeftAlone) {
  Platter platter;
  platter.files["it"].content = JournalBytes(100, std::byte{7});
  const Journal journal = open(platter);
  EXPECT_TRUE(journal.entries().empty());
  EXPECT_NE(journal.damage().find("not a journal"), std::string::npos);
}

// Its head counts every record, those of one call too: the sentence about a loss says how many there were.
TEST(ServiceJournal, RecordsThatAreErasedTogetherAreEachCounted) {
  std::mt19937_64 random = oracle::seeded(98);
  Platter platter;
  Journal journal = open(platter);
  for (std::uint64_t i = 0; i < 5; ++i) journal.put(entry(i, random), Journal::Sync::now);
  const std::vector<std::string> keys{"object/1", "object/none", "object/2", "object/3"};
  journal.erase(keys, Journal::Sync::now);
  const JournalBytes& content = platter.files["it"].content;
  EXPECT_EQ(journal_layout::head_of(content).newest->records, 8U) << "five put, three of the four were there to erase";
  EXPECT_EQ(journal_layout::head_of(content).newest->bytes, content.size());
  const Journal next = open(platter);
  EXPECT_EQ(next.damage(), "");
  EXPECT_EQ(next.entries(), journal.entries());
  ASSERT_EQ(next.entries().size(), 2U);
  EXPECT_EQ(next.entries().front().key, "object/0");
  EXPECT_EQ(next.entries().back().key, "object/4");
  // The last record goes: of eight there are seven.
  Platter cut = platter;
  JournalBytes& shorter = cut.files["it"].content;
  shorter.resize(shorter.size() - journal_layout::encode({.key = "object/3", .text = {}, .blob = {}}, true).size());
  EXPECT_NE(open(cut).damage().find("8 records and"), std::string::npos) << open(cut).damage();
  EXPECT_NE(open(cut).damage().find("acknowledged, 7 and"), std::string::npos) << open(cut).damage();
}

// A journal that is opened again goes on counting where the last process ended.
TEST(ServiceJournal, CountsGoOnAcrossLives) {
  std::mt19937_64 random = oracle::seeded(99);
  Platter platter;
  for (std::uint64_t life = 1; life <= 6; ++life) {
    Journal journal = open(platter);
    journal.put(entry(life, random), Journal::Sync::now);
    const auto count = journal_layout::head_of(platter.files["it"].content).newest;
    EXPECT_EQ(count->records, life);
    EXPECT_EQ(count->bytes, platter.files["it"].content.size());
    EXPECT_EQ(open(platter).damage(), "");
  }
}

TEST(ServiceJournal, WhatIsClearedIsGoneForTheNextProcessToo) {
  std::mt19937_64 random = oracle::seeded(100);
  Platter platter;
  Journal journal = open(platter);
  work(journal, 10, random);
  journal.clear();
  EXPECT_TRUE(journal.entries().empty());
  EXPECT_TRUE(open(platter).entries().empty());
  EXPECT_EQ(journal_layout::head_of(platter.files["it"].content).newest->records, 0U);
  journal.put(entry(1, random), Journal::Sync::now);
  EXPECT_EQ(open(platter).entries(), journal.entries());
}

// The disk fills up. What was acknowledged is there for the next process, which can write nothing, and for the one
// after that; what was not was told.
TEST(ServiceJournal, AFullDiskKeepsWhatItHasAndGoesOnWhenThereIsRoom) {
  std::mt19937_64 random = oracle::seeded(102);
  Platter platter;
  platter.room = 6'000;
  Entries acknowledged;
  {
    Journal journal = open(platter);
    for (std::uint64_t i = 0; i < 100; ++i) {
      journal.put(entry(i, random), Journal::Sync::now);
      if (journal.problem().empty()) acknowledged = journal.entries();
    }
    EXPECT_NE(journal.problem().find("No space left"), std::string::npos) << journal.problem();
    EXPECT_FALSE(journal.has_room(1'000));
  }
  ASSERT_GT(acknowledged.size(), 10u);
  for (int life = 0; life < 2; ++life) {
    const Journal next = open(platter);
    EXPECT_EQ(next.damage(), "");
    ASSERT_GE(next.entries().size(), acknowledged.size());
    EXPECT_TRUE(std::equal(acknowledged.begin(), acknowledged.end(), next.entries().begin()));
  }
  Journal journal = open(platter);
  for (std::uint64_t i = 200; i < 260; ++i) journal.put(entry(i, random), Journal::Sync::now);
  EXPECT_NE(journal.problem(), "");
  platter.room = SIZE_MAX;
  EXPECT_TRUE(journal.has_room(1'000));
  journal.put(entry(300, random), Journal::Sync::now);
  EXPECT_EQ(journal.problem(), "");
  EXPECT_EQ(open(platter).entries(), journal.entries()) << "what had waited for room came with it";
}

}  // namespace
}  // namespace collided::engine::service
