#include <fmt/format.h>

#include <CLI/CLI.hpp>

#include "client/cli/command.hpp"

namespace collided::cli {
namespace {

class VersionCommand : public Command {
 public:
  void declare(CLI::App& app) override { app.add_flag("--server", ask_server_, "The server's too"); }

  Exit run(Session& session, const Globals& globals) override {
    Printer printer = make_printer(session.io, globals);
    const std::string server = ask_server_ ? take(session.client(globals).status()).version_text : std::string();
    if (printer.human()) {
      printer.line(fmt::format("collide {}", library_version()));
      if (ask_server_) printer.line(fmt::format("collided {}", server));
    } else {
      Record record{{"client", library_version()}};
      if (ask_server_) record.push_back({"server", server});
      printer.record(record);
    }
    return Exit::yes;
  }

 private:
  bool ask_server_ = false;
};

/// For its help: the lines are run in run.cpp.
class ShellCommand : public Command {
 public:
  void declare(CLI::App&) override {}
  Exit run(Session&, const Globals&) override { throw bad_use("'shell' has no meaning here"); }
};

/// All verbs by topic, in the order of the help.
constexpr Verb kVerbs[] = {
    {"ray", "Ask", "what a ray meets", "ray X Y Z  DX DY DZ\nray X Y Z --to X Y Z\nray FILE|-",
     "ray 0 0 5  0 0 -1\nray 0 0 5 --to 4 4 0 --all --only 'pallet_*' --json\nray - < rays.csv > hits.csv", make_ray},
    {"sphere", "Ask", "what touches a sphere", "sphere X Y Z R\nsphere FILE|-",
     "sphere 1 2 0.5 30cm\nsphere 1 2 0.5 0.3 --watch -n 3", make_sphere},
    {"box", "Ask", "what touches a box", "box X Y Z  X Y Z\nbox --center X Y Z --size X Y Z [--rpy R P Y]\nbox FILE|-",
     "box 0 0 0  1 1 1 --count\nbox --center 0 0 0 --size 1 1 1 --rpy 0 0 45deg", make_box},
    {"near", "Ask", "what is nearest to a point", "near X Y Z\nnear FILE|-",
     "near 0 0 0 -k 3\nnear 0 0 0 --reach 2 --json\nnear 0 0 0 --signed", make_near},
    {"inside", "Ask", "which solids hold a point, and how deep it is in them", "inside X Y Z\ninside FILE|-",
     "inside 0.2 0.2 0.2\ninside 0.2 0.2 0.2 --only crate\ninside - --json < points.csv", make_inside},
    {"sweep", "Ask", "what a shape meets first on its way from pose to pose",
     "sweep SHAPE NUMBERS --from X Y Z --to X Y Z",
     "sweep sphere 0.1 --from 0 0 1 --to 2 0 1\nsweep box 1 0.1 0.1 --from 0 0 0 --to 0 0 0 --to-rpy 0 0 90deg "
     "--json",
     make_sweep, false, true},
    {"pair", "Ask", "how two objects stand to each other", "pair A B",
     "pair crate warehouse/floor\npair gear_a gear_b --triangles --csv\npair crate shelf --certificate",
     make_pair_verb},
    {"clearance", "Ask", "how near two groups of objects are, and which pairs are nearest",
     "clearance GROUP [--to GROUP]",
     "clearance 'robot/*' --to 'cell/*'\nclearance 'robot/*' -k 5\nclearance 'robot/*' --to cell --nearer 5mm --json",
     make_clearance},
    {"clash", "Ask", "all pairs of a scene or group that touch, or are too near", "clash [SCENE|GLOB|FILE]",
     "clash\nclash plant --nearer 5mm --csv\nclash plant.glb --nearer 5mm\nclash 'pipe_*' --certificate", make_clash},
    {"what-if", "Ask", "whether objects would be free at other poses, and how near to the rest",
     "what-if FILE|-\nwhat-if --robot FILE.urdf --joints FILE.csv|-",
     "what-if plan.csv --against 'cell/*'\nwhat-if plan.csv --clearance --json\nwhat-if --robot arm.urdf --joints "
     "plan.csv\nwhat-if - --attach crate=robot/hand < "
     "plan.jsonl",
     make_what_if},
    {"watch", "Follow", "collisions as they begin and end", "watch",
     "watch --only 'drone_*' -n 1 --for 10s\nwatch --format '{t} {what} {a} {b} {depth}'\nwatch --since -10s\nwatch "
     "--exec 'notify-send \"{a} hit {b}\"'\nwatch --post http://127.0.0.1:8080/contacts",
     make_watch},
    {"probe", "Follow", "rays fixed to an object, a wheel each: signed clearance",
     "probe\nprobe NAME --on OBJECT  X Y Z  DX DY DZ\nprobe --rm GLOB",
     "probe front_left --on car  1.2 0.7 0  0 0 -1\nprobe --watch --only 'front_*' -n 10\nprobe --rm 'front_*'",
     make_probe},
    {"fence", "Follow", "regions, and which objects come in and go out",
     "fence add NAME REGION NUMBERS\nfence ls [GLOB]\nfence rm GLOB\nfence watch [GLOB]",
     "fence add dock box 0 0 0 5 5 3 --only 'forklift*' --detect enter,exit\nfence add around sphere 0 0 0 2 --to "
     "person --keep\nfence add yard prism 0 4  0 0  9 0  9 6  4 3  0 6\nfence watch dock -n 10",
     make_fence},
    {"margin", "Follow", "distance bands between objects: which come near, and how soon they would touch",
     "margin add NAME GLOB GLOB DISTANCE,...\nmargin ls [GLOB]\nmargin rm GLOB\nmargin watch [GLOB]",
     "margin add close 'drone*' 'person*' 5m,2m --hysteresis 10cm\nmargin add close 'drone*' 'person*' 5m,2m "
     "--dwell 200ms --keep\nmargin watch close -n 10 --json\nmargin rm close",
     make_margin},
    {"nearest", "Follow", "which object is nearest to another or to a point, and when that changes",
     "nearest add NAME GLOB OBJECT DISTANCE\nnearest add NAME GLOB X Y Z DISTANCE\nnearest ls [GLOB]\nnearest rm GLOB\n"
     "nearest watch [GLOB]",
     "nearest add escape 'door_*' person_7 20m --hysteresis 10cm\nnearest add yard 'truck_*' 4 0 1 50m --keep\nnearest "
     "watch escape -n 10 --json\nnearest rm escape",
     make_nearest},
    {"top", "Look", "rates, latencies, stages and ages as they change", "top",
     "top\ntop --once --json\ntop --every 200ms -n 10\ntop --steps 20", make_top},
    {"explain", "Follow", "why an answer is what it is: of a ray, two objects, a fence, the nearest, an event",
     "explain pair A B\nexplain ray X Y Z DX DY DZ\nexplain fence NAME\nexplain nearest NAME\nexplain event SEQ [--of "
     "standing]\nexplain ... --recording FILE [--as-of TIME]",
     "explain pair drone tower --last 5s\nexplain ray 0 0 5  0 0 -1 --why-not pallet_07\nexplain ray 0 0 5 --to 4 4 0 "
     "--as-of -2s --json\nexplain fence dock --why-not forklift_7\nexplain event 881\nexplain event 881 --recording "
     "run.mcap",
     make_explain},
    {"metrics", "Follow", "counts and latencies as Prometheus reads them", "metrics",
     "metrics\nmetrics > /var/lib/node_exporter/collided.prom", make_metrics},
    {"fleet", "Follow",
     "which servers of a namespace there are, and whether they fit together; shards planned and split",
     "fleet\nfleet --shards MAP\nfleet plan [--into N]\nfleet plan --shards MAP\nfleet publish --shards FILE --to "
     "ADDRESS\nfleet split --shards MAP --to MAP",
     "fleet\nfleet --json\nfleet --shards map.json\nfleet plan --into 4 -o map.json\nfleet plan --shards map.json "
     "--split west -o "
     "next.json\nfleet split --shards map.json --to next.json\nfleet publish --shards map.json --to "
     "etcd://10.0.0.1:2379/yard\nfleet split --shards etcd://10.0.0.1:2379/yard",
     nullptr},
    {"handover", "Follow", "a server that stands by takes the primary's place, and the primary ends", "handover [NAME]",
     "handover\nhandover south", make_handover},
    {"status", "Look", "how the server is", "status", "status\nstatus --json", make_status},
    {"ls", "Look", "what is in the world", "ls [GLOB]", "ls --moving 'drone_*' --json", make_ls},
    {"get", "Look", "everything about one object", "get NAME", "get crate", make_get},
    {"plan", "Look", "what this scene built and left out, and why", "plan", "plan\nplan --pairs\nplan --wings",
     make_plan},
    {"draw", "Files", "a technical drawing of what is there, by the server's own rays",
     "draw -o FILE.svg|FILE.png\ndraw --term",
     "draw -o scene.svg\ndraw --style obscured-line --from 6 -8 5 --at 0 0 0.5 -o scene.png\ndraw --style toon --ray "
     "0 0 5  0 0 -1 -o scene.svg\ndraw --term --width 100",
     nullptr},
    {"view", "Look", "the running world as a page in the browser", "view\nview --save FILE",
     "view\nview --port 0 --for 10min\nview --save run.html --last 30s", nullptr},
    {"add", "Change", "put an object into the world", "add NAME SHAPE NUMBERS [--at X Y Z]",
     "add crate box 0.4 0.4 0.4 --at 1 2 0.2 --rpy 0 0 30deg\nadd ball sphere 5cm --at 0 0 1", make_add, false, true},
    {"move", "Change", "move an object that no publisher owns", "move NAME X Y Z",
     "move crate 1.2 2 0.2\nmove crate 0 0 1cm --by", make_move},
    {"rm", "Change", "take objects out of the world", "rm NAME|GLOB ...", "rm crate", make_rm},
    {"publish", "Change", "move objects: from a file, a recording, a robot's joints, a path, or spheres in a cube",
     "publish FILE.csv|-\npublish FILE.bvh\npublish FILE.urdf --joints FILE.csv|-\npublish --spheres N\npublish --path "
     "FILE | --waypoints POINTS",
     "publish poses.csv --rate 200 --loop\npublish 01_01.bvh --unit 0.056444 --up z --loop\n"
     "publish --spheres 20 --polygons 256 --size 0.2 --seed 7 --bounce\npublish --waypoints \"0,0,1 2,0,1\" "
     "--speed 0.5m/s --shape sphere:20cm",
     make_publish},
    {"ros", "Change", "objects follow the frames of ROS 2, and contacts go back as markers; needs no ROS here", "ros",
     "ros\nros --frame map --ros-domain 7\nros --joint-states --only 'arm/*'", nullptr},
    {"load", "Change", "load a file as a scene", "load FILE",
     "load warehouse.obj --unit mm --up y\nload --upload part.stl --unit mm", make_load},
    {"clear", "Change", "empty the world, or one scene of it", "clear [SCENE]", "clear --moving", make_clear},
    {"allow", "Change", "pairs of objects that may touch", "allow GLOB GLOB [--because TEXT]\nallow",
     "allow arm/upper arm/fore --because 'they share a joint'\nallow 'cable_*' '*'\nallow", make_allow},
    {"deny", "Change", "take back that pairs may touch", "deny GLOB GLOB",
     "deny arm/upper arm/fore\ndeny 'human_*' '*'", make_deny},
    {"attach", "Change", "an object that moves along with another", "attach CHILD PARENT", "attach crate robot/hand",
     make_attach},
    {"detach", "Change", "an object that moves along with another no longer", "detach CHILD", "detach crate",
     make_detach},
    {"menu", "Look", "this scene's price list: error against time", "menu\nmenu --from FILE|- --of KIND",
     "menu\nmenu --questions 10000 --seed 7 --json\nmenu --from rays.csv --of ray\nmenu --opinion fcl", make_menu},
    {"audit", "Look", "answers that the server worked out again, exactly", "audit", "audit", make_audit},
    {"doctor", "Look", "what keeps programs from finding or hearing each other, and what to do about it", "doctor",
     "doctor\ndoctor --domain 3 --json", make_doctor},
    {"accept-loss", "Look", "go on without what a crash or a damaged disk took", "accept-loss",
     "accept-loss --show\naccept-loss", make_accept_loss},
    {"check", "Files", "what a file holds and what is wrong with it; needs no server", "check FILE",
     "check warehouse.obj --json", make_check, true},
    {"convert", "Files", "read a file, write a .cscene file; needs no server", "convert IN OUT.cscene",
     "convert scan.ply scene.cscene --unit mm --center", make_convert, true},
    {"implicit", "Files", "where a ray meets the surface of a polynomial, on which side a point is; needs no server",
     "implicit POLYNOMIAL X Y Z DX DY DZ\nimplicit POLYNOMIAL X Y Z\nimplicit POLYNOMIAL -",
     "implicit '(x^2+y^2+z^2+3)^2 - 16*(x^2+y^2)' 0 2 5  0 0 -1\nimplicit ring --file rings.surfaces 0 2 5  0 0 -1 "
     "--json",
     make_implicit, true},
    {"snapshot", "Files", "the world of now as a scene file, which another server or engine answers from",
     "snapshot FILE.cscene", "snapshot now.cscene", make_snapshot},
    {"record", "Files", "everything that goes over the namespace, into an MCAP file", "record FILE.mcap",
     "record run.mcap --for 60s\nrecord crash.mcap --last 30s", make_record},
    {"replay", "Files", "a recording again: poses in time, or every question with its answer compared",
     "replay FILE.mcap", "replay run.mcap --rate 0.5 --loop\nreplay run.mcap --ask", make_replay},
    {"events", "Files", "what touched what in a recording, and when; needs no server", "events FILE.mcap",
     "events run.mcap --only 'drone_*' --from +10s --to +12.5s\nevents crash.mcap "
     "--from -2s --json",
     make_events},
    {"demo", "More", "a server of its own with a small warehouse, some questions to it, and then yours", "demo",
     "demo\ndemo --for 10min", make_demo},
    {"shell", "More", "many verbs over one connection: at a prompt, or a line each from a pipe (then also -)",
     "shell\nshell < FILE", "shell\n- < questions.txt", make_shell},
    {"keys", "More", "who may join a server and do what there: makes authorities and folders of keys; needs no server",
     "keys init [DIR]\nkeys add NAME --role ROLE\nkeys revoke NAME\nkeys check",
     "keys init keys\nkeys add brain --role server\nkeys add robot7 --role publisher --objects 'robot7/*' --days "
     "30\nkeys revoke robot7\nkeys check",
     nullptr},
    {"help", "More", "what a verb does, or a guide", "help [VERB|GUIDE|options]", "help ray\nhelp asking\nhelp options",
     make_help},
    {"completion", "More", "completion of verbs, options and object names for a shell", "completion bash|zsh|fish",
     "completion bash > ~/.local/share/bash-completion/completions/collide", make_completion},
    {"complete", "", "what may stand where a command line is being typed, for a shell", "complete -- WORDS", "",
     make_complete, true},
    {"version", "More", "versions", "version", "version --server", make_version},
};

}  // namespace

std::unique_ptr<Command> make_shell() { return std::make_unique<ShellCommand>(); }

std::span<const Verb> verbs() { return kVerbs; }

const Verb* find_verb(std::string_view name) {
  for (const Verb& verb : verbs()) {
    if (verb.name == name) return &verb;
  }
  return nullptr;
}

std::unique_ptr<Command> make_version() { return std::make_unique<VersionCommand>(); }

}  // namespace collided::cli
