#include <sys/wait.h>
#include <unistd.h>

#include <fcntl.h>

#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <memory>

#include "tests/studies/report/methods/peer.hpp"

namespace collided::report {
using namespace engine;

struct Peer::Process {
  pid_t id = -1;
  FILE* to = nullptr;
  FILE* from = nullptr;
  std::string answers_file;

  ~Process() {
    if (to) std::fclose(to);
    if (from) std::fclose(from);
    if (id > 0) waitpid(id, nullptr, 0);
  }
};

std::optional<Peer> Peer::start(const std::filesystem::path& program, const std::string& option,
                                const std::filesystem::path& problem) {
  if (!std::filesystem::exists(program)) return std::nullopt;
  // A peer that has died must not take us with it.
  std::signal(SIGPIPE, SIG_IGN);
  Peer peer;
  peer.process_ = std::make_shared<Process>();
  Process& process = *peer.process_;
  process.answers_file = problem.string() + "." + program.filename().string() + option + ".answers";
  std::filesystem::remove(process.answers_file);
  int questions[2];
  int results[2];
  if (pipe2(questions, O_CLOEXEC) != 0 || pipe2(results, O_CLOEXEC) != 0) return std::nullopt;
  process.id = fork();
  if (process.id == 0) {
    dup2(questions[0], STDIN_FILENO);
    dup2(results[1], STDOUT_FILENO);
    execl(program.c_str(), program.c_str(), problem.c_str(), process.answers_file.c_str(), option.c_str(), nullptr);
    _exit(127);
  }
  close(questions[0]);
  close(results[1]);
  process.to = fdopen(questions[1], "w");
  process.from = fdopen(results[0], "r");
  char line[64];
  if (!std::fgets(line, sizeof line, process.from) || std::string(line) != "ready\n") return std::nullopt;
  return peer;
}

std::optional<double> Peer::pass() {
  char line[64];
  if (std::fputs("go\n", process_->to) < 0 || std::fflush(process_->to) != 0) return std::nullopt;
  if (!std::fgets(line, sizeof line, process_->from)) return std::nullopt;
  return std::strtod(line, nullptr);
}

std::vector<PeerAnswer> Peer::finish() {
  std::fclose(process_->to);
  process_->to = nullptr;
  waitpid(process_->id, nullptr, 0);
  process_->id = -1;
  std::ifstream in(process_->answers_file, std::ios::binary);
  std::uint64_t count = 0;
  in.read(reinterpret_cast<char*>(&count), sizeof count);
  std::vector<PeerAnswer> answers(in ? count : 0);
  in.read(reinterpret_cast<char*>(answers.data()), static_cast<std::streamsize>(answers.size() * sizeof(PeerAnswer)));
  return answers;
}

}  // namespace collided::report
