// Each role with every topic, both ways: what gets through is what the table in deploy/docs/roles.md says. Everybody here
// speaks DDS by himself and does not keep to his own permissions, so what is refused was refused by the other side.
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <fstream>
#include <set>
#include <sstream>

#include "client/keys/rights.hpp"
#include "tests/keys/key_folders.hpp"
#include "tests/keys/everything.hpp"

namespace collided {
namespace {

using namespace std::chrono_literals;
using keys::KeyRole;
using test::Everything;
using test::passes;
using test::Way;
using test::ways;

std::set<std::string> names_of(const std::set<std::string>& topics, const std::set<wire_contract::QueryRight>& queries,
                               bool reads_queries) {
  std::set<std::string> names;
  for (const Way& way : ways()) {
    const bool is_query = way.row == &wire_contract::kQueryTopic;
    const bool is_right = std::ranges::any_of(
        queries, [&](wire_contract::QueryRight right) { return way.partition == wire_contract::name_of(right); });
    if (is_query ? (reads_queries ? topics.contains(way.row->suffix) : is_right) : topics.contains(way.row->suffix))
      names.insert(way.name());
  }
  return names;
}

std::string lines(const std::set<std::string>& names) {
  std::string text;
  for (const std::string& name : names) text += name + '\n';
  return text;
}

class Matrix : public testing::TestWithParam<KeyRole> {};

TEST_P(Matrix, WhatARoleMayWriteIsWhatOthersHear) {
  const test::KeyFolders folders;
  const KeyRole role = GetParam();
  const std::array roles{role};
  const keys::TopicRights rights = keys::rights_of(roles);
  // Between the two, all rights are there: what one may not read, the other may.
  Everything server(folders.of("server", {KeyRole::standby}), 0);
  Everything admin(folders.of("admin", {KeyRole::admin}), 1);
  Everything member(folders.of("member", {role}), 2);
  const auto may_write = names_of(rights.write, rights.queries, false);
  std::set<std::string> heard = passes(member, admin, {});
  heard.merge(passes(member, server));
  test::eventually([&] {
    heard.merge(passes(member, server));
    heard.merge(admin.heard());
    return std::ranges::includes(heard, may_write);
  });
  EXPECT_EQ(lines(heard), lines(may_write));
}

TEST_P(Matrix, WhatARoleMayReadIsWhatItHears) {
  const test::KeyFolders folders;
  const KeyRole role = GetParam();
  const std::array roles{role};
  const keys::TopicRights rights = keys::rights_of(roles);
  Everything server(folders.of("server", {KeyRole::server}), 0);
  Everything admin(folders.of("admin", {KeyRole::admin}), 1);
  Everything member(folders.of("member", {role}), 2);
  const auto may_read = names_of(rights.read, rights.queries, true);
  std::set<std::string> heard;
  test::eventually(
      [&] {
        heard.merge(passes(server, member));
        heard.merge(passes(admin, member));
        return std::ranges::includes(heard, may_read);
      },
      10s);
  EXPECT_EQ(lines(heard), lines(may_read));
}

INSTANTIATE_TEST_SUITE_P(Roles, Matrix,
                         testing::ValuesIn(std::vector<KeyRole>(keys::all_roles().begin(), keys::all_roles().end())),
                         [](const auto& role) { return std::string(keys::name_of(role.param)); });

/// The letters of the guide's table: what the roles may do by one way.
std::string row_of_guide(const std::string& name) {
  std::string row = "| `" + name + "` |";
  for (const KeyRole role : keys::all_roles()) {
    const std::array roles{role};
    const keys::TopicRights rights = keys::rights_of(roles);
    const bool writes = names_of(rights.write, rights.queries, false).contains(name);
    const bool reads = names_of(rights.read, rights.queries, true).contains(name);
    row += std::string(" ") +
           (writes && reads ? "writes, reads"
            : writes        ? "writes"
            : reads         ? "reads"
                            : "") +
           (writes || reads ? " |" : "|");
  }
  return row;
}

TEST(Guide, ItsTableIsTheRights) {
  std::ifstream file(COLLIDED_SOURCE_DIR "/deploy/docs/roles.md");
  std::ostringstream guide;
  guide << file.rdbuf();
  for (const Way& way : ways())
    EXPECT_NE(guide.str().find(row_of_guide(way.name())), std::string::npos) << row_of_guide(way.name());
}

}  // namespace
}  // namespace collided
