#include "client/cli/global_options.hpp"

#include "client/cli/input/option.hpp"
#include "idl/etcd_option.hpp"

namespace collided::cli {

void declare_globals(CLI::App& app, Globals& globals) {
  const std::string output(kOutputGroup);
  app.add_flag("--json", globals.json, "One JSON object a line")->group(output);
  app.add_flag("--csv", globals.csv, "CSV with a header")->group(output);
  app.add_flag("--plain", globals.plain, "Fields apart by tabs, no header (the default off a terminal)")->group(output);
  app.add_flag("--table", globals.table, "For people (the default on a terminal)")->group(output);
  option(app, "--fields NAMES", globals.fields, "Only these fields, in this order: a,b,c; 'help' lists them")
      ->group(output);
  app.add_flag("--header", globals.header, "Names of the columns above plain output")->group(output);
  app.add_flag("-q,--quiet", globals.quiet, "Data only: no hints, no progress")->group(output);
  app.add_flag("-v,--verbose", globals.verbose, "Every digit, with bounds, and what the answer cost")->group(output);
  option(app, "--color WHEN", globals.color, "auto, always or never")
      ->check(CLI::IsMember({"auto", "always", "never"}))
      ->group(output);
  app.add_flag("--exit-zero", globals.exit_zero, "Exit 0 for 'no' and 'undecided' too")->group(output);
  const std::string connection(kConnectionGroup);
  option(app, "--domain N", globals.domain, "DDS domain (COLLIDED_DOMAIN, ROS_DOMAIN_ID, 0)")->group(connection);
  option(app, "--namespace NAME", globals.name_space, "Of the server (COLLIDED_NAMESPACE, 'collided')")
      ->group(connection);
  option(app, "--interface NAME", globals.interface, "lo, eth0, auto (COLLIDED_INTERFACE, lo)")->group(connection);
  option(app, "--peer HOST", globals.peers, "Host to look for the server on; repeatable")
      ->allow_extra_args(false)
      ->group(connection);
  option(app, "--keys DIR", globals.keys, "Folder of keys, where the server has some (COLLIDED_KEYS)")
      ->group(connection);
  option(app, "--shards MAP", globals.shards,
         "Shard map of a world on several servers, a file or etcd://HOST:PORT/KEY, in place of one; see help shards")
      ->group(connection);
  option(app, std::string(etcd::kEtcdKeysFlag) + " DIR", globals.etcd_keys, etcd::kEtcdKeysHelp)->group(connection);
  option(app, "--wait", globals.wait, "At most so long for a server to answer hello (2s, and more on a busy machine)")
      ->group(connection);
  option(app, "--timeout", globals.timeout, "How long one answer may take")->group(connection);
  // A line's own option takes precedence over one for all lines.
  for (CLI::Option* one : app.get_options()) {
    const bool is_common = one->get_group() == output || one->get_group() == connection;
    if (is_common && one->get_items_expected_max() == 1) one->take_last();
  }
}

void declare_verb(CLI::App& app, Command& command, Globals& globals) {
  app.set_help_flag();
  // While parsing: before the value of another option is refused.
  app.add_flag_callback(
         "-h,--help", [] { throw CLI::CallForHelp(); }, "This help")
      ->trigger_on_parse();
  command.declare(app);
  declare_globals(app, globals);
}

}  // namespace collided::cli
