#include <unistd.h>

#include <fstream>
#include <tuple>

#include <fmt/format.h>

#include "client/cli/command.hpp"
#include "client/cli/input/number.hpp"
#include "client/cli/input/option.hpp"
#include "client/cli/pace.hpp"
#include "client/cli/verbs/undo.hpp"
#include "client/view/recording.hpp"
#include "client/view/viewer.hpp"

namespace collided::cli {
namespace {

class ViewCommand : public Command {
 public:
  void declare(CLI::App& app) override {
    option(app, "--port N", port_, "0: any that is free (8765)");
    option(app, "--bind ADDRESS", options_.address.address,
           "Address to be reached at; others than 127.0.0.1 open it to who has the token that it prints");
    option(app, "--host NAME", options_.rules.hosts,
           "A name that it may be asked under, beside that address and localhost");
    option(app, "--origin URL", options_.rules.origins, "Another page that may connect, https://app.foxglove.dev");
    option(app, "--up AXIS", up_, "Which way is up: y or z (z)");
    option(app, "--for", most_time_, "End after this time");
    option(app, "--save FILE", file_, "Write one file that shows the next --last instead of serving");
    option(app, "--last", length_, "How much --save records (30s)");
  }

  Exit run(Session& session, const Globals& globals) override {
    if (up_ != "y" && up_ != "z") throw bad_use(fmt::format("--up {}; allowed: y, z", up_));
    options_.y_is_up = up_ == "y";
    options_.connection = connection_words(session.io, globals);
    return file_.empty() ? serve(session, globals) : save(session, globals);
  }

 private:
  /// The options that connect another `collide` to the same server, including those that this one has from its
  /// environment.
  static std::string connection_words(const Io& io, const Globals& globals) {
    const ConnectOptions ours = connect_options(io, globals);
    const ConnectOptions usual;
    std::string words;
    if (ours.domain != usual.domain) words += fmt::format("--domain {} ", ours.domain);
    for (const auto& [option, value, usually] : {std::tuple("--namespace", ours.name_space, usual.name_space),
                                                 std::tuple("--interface", ours.interface, usual.interface)})
      if (value != usually) words += fmt::format("{} {} ", option, shell_word(value));
    return words;
  }

  Exit serve(Session& session, const Globals& globals) {
    constexpr std::uint64_t kLastPort = 65535;
    const std::uint64_t port = parse_count(port_);
    if (port > kLastPort) throw bad_use(fmt::format("--port {}; allowed: 0 to {}", port, kLastPort));
    options_.address.port = static_cast<std::uint16_t>(port);
    const Until until(0, most_time_);
    const std::unique_ptr<view::Viewer> viewer = start(session, globals);
    const std::string& address = options_.address.address;
    const bool is_long = address.find(':') != std::string::npos;
    const std::string host = fmt::format("{}{}{}:{}", is_long ? "[" : "", address, is_long ? "]" : "", viewer->port());
    const std::string query = viewer->token().empty() ? "" : "/?token=" + viewer->token();
    if (!query.empty())
      print_warning(session.io, "anybody on the network who reaches " + address +
                                    " and has the token may watch; it goes over the network in the clear");
    Printer printer = make_printer(session.io, globals);
    const std::string url = "http://" + host + query;
    const std::string foxglove = "ws://" + host + query;
    if (printer.human())
      printer.line(fmt::format("{}  (Foxglove or Lichtblick: {})        Ctrl-C ends", url, foxglove));
    else printer.record({{"url", url}, {"foxglove", foxglove}});
    session.io.out.flush();
    static_cast<void>(sleep_until(until.end()));
    const view::WebCounts& counts = viewer->counts();
    print_hint(session.io, globals,
               fmt::format("{} connections; {} sent away since it was full, {} forbidden, {} dropped since they took "
                           "too little or said too much",
                           format_count(counts.connections), format_count(counts.full), format_count(counts.forbidden),
                           format_count(counts.slow + counts.flooding)));
    return stop_requested ? Exit::interrupted : Exit::yes;
  }

  std::unique_ptr<view::Viewer> start(Session& session, const Globals& globals) {
    Client& client = session.client(globals);
    try {
      return take(view::Viewer::start(client, options_));
    } catch (const Failure&) { throw; } catch (const std::runtime_error& failed) {
      throw bad_use(failed.what(), "--port 0 takes a free one; --bind names the address");
    }
  }

  Exit save(Session& session, const Globals& globals) {
    constexpr std::chrono::minutes kLongest{10};
    if (length_ <= std::chrono::nanoseconds(0) || length_ > kLongest)
      throw bad_use(fmt::format("--last {}; allowed: more than 0, up to 10min", format_duration(length_)));
    std::ofstream out(file_, std::ios::binary);
    if (!out) throw bad_use(fmt::format("{}: cannot be written", file_));
    const view::RecordingOptions options{
        .length = length_, .y_is_up = options_.y_is_up, .connection = options_.connection, .is_stopped = [] {
          return stop_requested.load();
        }};
    const view::SavedRun saved = take(view::record_run(session.client(globals), options));
    out << saved.page;
    out.close();
    if (!out) throw Failure(Exit::refused, fmt::format("{}: could not be written whole: is the disk full?", file_));
    if (saved.is_full)
      print_hint(session.io, globals,
                 fmt::format("{} MiB were full before the time was over", options.most_bytes >> 20));
    Printer printer = make_printer(session.io, globals);
    if (printer.human())
      printer.line(fmt::format("{}  {:.1f} s, {} frames, {} kB", file_, saved.seconds, format_count(saved.frames),
                               format_count(saved.page.size() / 1000)));
    else
      printer.record({{"file", std::string(file_)},
                      {"seconds", saved.seconds},
                      {"frames", std::uint64_t{saved.frames}},
                      {"bytes", std::uint64_t{saved.page.size()}}});
    return Exit::yes;
  }

  view::ViewerOptions options_;
  std::string port_ = "8765";
  std::string up_ = "z";
  std::chrono::nanoseconds most_time_ = std::chrono::nanoseconds::max();
  std::string file_;
  std::chrono::nanoseconds length_ = std::chrono::seconds(30);
};

}  // namespace

std::unique_ptr<Command> make_view() { return std::make_unique<ViewCommand>(); }

}  // namespace collided::cli
