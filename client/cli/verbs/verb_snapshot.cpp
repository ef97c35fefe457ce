#include <collided/snapshot.hpp>
#include <fmt/format.h>

#include "client/cli/command.hpp"
#include "client/cli/input/number.hpp"
#include "client/cli/input/option.hpp"
#include "client/cli/output/described_record.hpp"
#include "client/cli/output/output.hpp"
#include "client/cli/output/progress.hpp"

namespace collided::cli {
namespace {

class SnapshotCommand : public Command {
 public:
  void declare(CLI::App& app) override { option(app, "file FILE", path_, "To write, a .cscene file")->required(); }

  Exit run(Session& session, const Globals& globals) override {
    if (!path_.ends_with(".cscene"))
      throw bad_use(fmt::format("'{}' does not end in .cscene, by which programs know a scene file", printable(path_)));
    Progress line(session.io, globals);
    const Result<WrittenSnapshot> written =
        write_snapshot(connect_options(session.io, globals), path_, [&](double fraction) {
          line.show(static_cast<std::uint64_t>(fraction * 100), "%", fraction);
          return !stop_requested;
        });
    line.clear();
    if (!written && stop_requested) throw Failure(Exit::interrupted, "", "nothing was written");
    print(session, globals, take(written), standing(session.client(globals)));
    return Exit::yes;
  }

 private:
  /// What is no part of the world's state and asks about it.
  static std::vector<std::string> standing(Client& client) {
    std::vector<std::string> kinds;
    if (const std::size_t count = take(client.standing()).size(); count > 0)
      kinds.push_back(counted(count, "standing question"));
    if (const std::size_t count = take(client.probes()).size(); count > 0) kinds.push_back(counted(count, "probe"));
    return kinds;
  }

  void print(Session& session, const Globals& globals, const WrittenSnapshot& written,
             const std::vector<std::string>& standing) const {
    std::vector<std::string> left = written.lacks;
    left.insert(left.end(), standing.begin(), standing.end());
    Printer printer = make_printer(session.io, globals);
    printer.set_usual_fields({"file", "parts", "objects", "triangles", "not_carried_over"});
    if (printer.human()) {
      printer.line(fmt::format("wrote {}: {}, {}, {}, {:.1f} MB (world {})", printable(path_),
                               counted(written.parts, "part"), counted(written.objects, "object"),
                               counted(written.triangles, "triangle"), static_cast<double>(written.bytes) * 1e-6,
                               format_count(written.version)));
      for (const std::string& one : left) printer.line("  not carried over: " + printable(one));
    } else {
      printer.record({{"file", path_},
                      {"parts", written.parts},
                      {"objects", written.objects},
                      {"triangles", written.triangles},
                      {"bytes", written.bytes},
                      {"world", written.version},
                      {"world_time", written.world_time.count()},
                      {"not_carried_over", raw_json(left)}});
    }
    printer.finish();
  }

  std::string path_;
};

}  // namespace

std::unique_ptr<Command> make_snapshot() { return std::make_unique<SnapshotCommand>(); }

}  // namespace collided::cli
