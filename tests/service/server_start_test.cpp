#include <csignal>

#include "tests/service/server_process.hpp"

namespace collided {
namespace {

using namespace std::chrono_literals;
using ServerStart = testing_support::ServerProcess;

TEST_F(ServerStart, ASecondServerIsRefused) {
  testing_support::ChildProcess& first = start();
  const Ended second = run({"--domain", std::to_string(domain_), "--state-dir", folder_.path()});
  EXPECT_EQ(second.code, 2);
  EXPECT_EQ(second.errors, "error: another collided (pid " + std::to_string(first.pid()) +
                               ") serves namespace 'collided' on domain " + std::to_string(domain_) +
                               "\n       stop it, or use another --namespace or --domain\n");
  start({"--namespace", "other"}, "other");
}

TEST_F(ServerStart, TheEpochGrows) {
  const auto epoch_of = [](const std::string& output) {
    const std::size_t place = output.find("epoch ");
    return std::stoull(output.substr(place + 6));
  };
  testing_support::ChildProcess& first = start({}, "first");
  const auto before = epoch_of(first.output());
  first.signal(SIGKILL);
  first.wait(5s);
  EXPECT_GT(epoch_of(start({"--namespace", "collided"}, "second").output()), before);
}

TEST_F(ServerStart, ConfigErrorsSayWhereAndWhatWasMeant) {
  const auto refused = [&](const std::string& text) {
    const std::string path = folder_.write("collided.toml", text);
    const Ended ended = run({"--check-config", "--config", path});
    EXPECT_EQ(ended.code, 2);
    EXPECT_EQ(ended.output, "");
    const std::size_t place = ended.errors.find(path);
    return place == std::string::npos ? ended.errors : std::string(ended.errors).replace(place, path.size(), "FILE");
  };
  EXPECT_EQ(refused("[server]\nthread = 2\n"),
            "error: FILE line 2, column 1: unknown key 'thread' in [server]; did you mean 'threads'?\n");
  EXPECT_EQ(refused("[word]\nscenes = []\n"),
            "error: FILE line 1, column 2: unknown table [word]; did you mean 'world'?\n");
  EXPECT_EQ(refused("[server]\nthreads = \"many\"\n"),
            "error: server.threads is 'many'; allowed: a whole number from 0 to 256 (0: one a core) (from FILE:2)\n");
  EXPECT_EQ(refused("threads = 1\n"),
            "error: FILE line 1, column 1: key 'threads' stands outside of a table such as [server]\n");
  EXPECT_EQ(refused("[server]\nthreads = \n").substr(0, 28), "error: FILE line 2, column 1");
}

TEST_F(ServerStart, TheCheckNamesEverySceneThatCannotBeRead) {
  const std::string scene = folder_.write("cell.csv", "name,x,y,z,sx,sy,sz\ntank,0,0,0,1,1,1\n");
  const Ended ended = run({"--check-config", "/nowhere/a.obj", scene, "/nowhere/b.obj"});
  EXPECT_EQ(ended.code, 2);
  EXPECT_EQ(ended.errors,
            "error: scene '/nowhere/a.obj': No such file or directory\n"
            "error: scene '/nowhere/b.obj': No such file or directory\n");
  EXPECT_EQ(run({"--check-config", scene}).code, 0);
}

// The file that is shipped says what holds without it.
TEST_F(ServerStart, TheShippedConfigHoldsTheDefaults) {
  const auto without_origins = [](const std::string& text) {
    std::string values;
    for (std::size_t start = 0; start < text.size();) {
      const std::size_t end = text.find('\n', start);
      values += text.substr(start, std::min(end, text.find('#', start)) - start);
      start = end + 1;
    }
    return values;
  };
  const Ended shipped = run({"--print-config", "--config", COLLIDED_SOURCE_DIR "/deploy/collided.toml"});
  ASSERT_EQ(shipped.code, 0) << shipped.errors;
  EXPECT_EQ(without_origins(shipped.output), without_origins(run({"--print-config"}).output));
}

// A T-vertex on the long edge of a second panel: kept and not spoken of, or cut and said.
TEST_F(ServerStart, StartScenesAreMendedWhereThatIsAskedFor) {
  const std::string panels = folder_.write(
      "panels.obj",
      "v 0 0 0\nv 1 0 0\nv 1 .5 0\nv 1 1 0\nv 0 1 0\nv 2 0 0\nv 2 1 0\nf 1 2 3\nf 1 3 5\nf 3 4 5\nf 2 6 7\nf 2 7 4\n");
  const Ended as_it_is = run({"--once", panels});
  EXPECT_EQ(as_it_is.code, 0) << as_it_is.errors;
  EXPECT_EQ(as_it_is.output.find("mended"), std::string::npos) << as_it_is.output;
  EXPECT_NE(as_it_is.output.find("panels: 5 triangles"), std::string::npos) << as_it_is.output;
  const std::string config = folder_.write("mend.toml", "[world]\nmend = \"0.1mm\"\n");
  for (const std::vector<std::string>& options : {std::vector<std::string>{"--mend", "auto"}, {"--config", config}}) {
    std::vector<std::string> words{"--once", panels};
    words.insert(words.end(), options.begin(), options.end());
    const Ended mended = run(words);
    EXPECT_EQ(mended.code, 0) << mended.errors;
    EXPECT_NE(mended.output.find("mended   1 T-vertices: the edges cut there"), std::string::npos) << mended.output;
    EXPECT_NE(mended.output.find("panels: 6 triangles"), std::string::npos) << mended.output;
  }
  EXPECT_EQ(run({"--once", panels, "--mend", "0"}).errors,
            "error: world.mend is '0'; allowed: 'off', 'auto' or the widest crack to close, such as 0.1mm (from flag "
            "--mend)\n");
}

TEST_F(ServerStart, OptionErrorsSayWhatIsAllowed) {
  const auto refused = [&](const std::vector<std::string>& options) {
    const Ended ended = run(options);
    EXPECT_EQ(ended.code, 2);
    return ended.errors;
  };
  EXPECT_EQ(refused({"--thread", "2"}), "error: unknown option '--thread'; did you mean '--threads'?\n");
  EXPECT_EQ(refused({"--domain", "-1"}),
            "error: dds.domain is '-1'; allowed: a whole number from 0 to 230 (from flag --domain)\n");
  EXPECT_EQ(refused({"--step", "-.5"}),
            "error: server.step is '-.5'; allowed: 'on-sample' or a time from 100us to 10s (from flag --step)\n");
  EXPECT_NE(refused({"--once", "no_such.obj"}).find("no_such.obj"), std::string::npos);
}

TEST_F(ServerStart, OnceComparesWithBruteForce) {
  const Ended ended = run({"--once"});
  EXPECT_EQ(ended.code, 0) << ended.output << ended.errors;
  EXPECT_NE(ended.output.find("800 of 800 answers equal to brute force by rationals"), std::string::npos)
      << ended.output;
}

TEST_F(ServerStart, StopsWithinASecond) {
  testing_support::ChildProcess& server = start();
  server.signal(SIGINT);
  EXPECT_EQ(server.wait(3s), 0);
  EXPECT_EQ(server.errors(), "");
}

}  // namespace
}  // namespace collided
