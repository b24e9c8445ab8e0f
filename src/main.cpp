#include "src/command/command.hpp"
#include "src/config/fabrics.hpp"
#include "src/linear/session.hpp"

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cstdio>
#include <cstdlib>
#include <new>

namespace {

using namespace taut;
using namespace taut::command;

struct Example {
  std::string_view command, line;
};

constexpr std::array examples{
    Example{"run", "taut run cases/drape/case.yaml                    one rank, results in out/drape"},
    Example{
        "run",
        "mpirun -n 8 taut run case.yaml --out out/fine     more ranks than cores: mpirun --oversubscribe"},
    Example{"run", "taut run case.yaml --set 'cloth.grid.vertices=[281, 281]' --set 'pins[0].near=[[0, 0, "
                   "0], [1, 0, 0]]'"},
    Example{"run", "taut run case.yaml --set velocity.solver=mumps -- -projection_ksp_monitor"},
    Example{"resume", "mpirun -n 3 taut resume out/fine                  go on from the last checkpoint"},
    Example{"resume", "taut resume out/drape --set time.end=5            the same with other settings"},
    Example{"check", "taut check case.yaml                              validate a case without running it"},
    Example{"check",
            "taut check out/drape                              verify the checksums of what a run wrote"},
    Example{"info", "taut info out/drape                               what a run holds, in words"},
    Example{"info",
            "taut info case.yaml --set cloth.edge=5mm          what a case would simulate, and its cost"},
    Example{"partition", "taut partition case.yaml --ranks 4096             how the cloth would be cut"},
    Example{"mesh",
            "taut mesh shirt.json --edge 5mm --out shirt.h5    mesh a sewing pattern; --svg FILE draws it"},
    Example{"mesh", "taut mesh shirt.json --edge 5mm --edge collar=2mm --out shirt.obj"},
    Example{"export",
            "taut export out/shirt --to shirt.pc2 --up y       the frames for Blender, with shirt.obj"},
    Example{"export", "taut export out/shirt --to last.usda --frame 75   one frame as USD"},
    Example{"fabrics", "taut fabrics                                      the fabrics that cases may name"},
    Example{"schema", "taut schema                                       all keys of a case, as JSON Schema"},
    Example{"schema", "taut schema --table                               the same as a table"}};

constexpr std::string_view notes = R"(
What stands behind -- are PETSc options: those of the velocity solve begin with -velocity_, those of the projection
with -projection_. Units are SI; a value may name another, as in '10 ms' or '1 %'.
Exit codes: 0 all accepted steps met the limits of the case; 1 a fault in the program; 2 a mistake in the case, mesh,
options or output folder; 3 no acceptable step could be found; 4 stopped by SIGTERM, SIGINT or SIGUSR1, to be resumed.)";

/// Of one command, or of all if none is named.
std::string examples_of(std::string_view command) {
  std::string text = "\nExamples:\n";
  for (const Example& e : examples)
    if (command.empty() || e.command == command) text += fmt::format("  {}\n", e.line);
  return text;
}

/// The command line, cut at "--".
struct Arguments {
  std::vector<const char*> own; ///< the program's name first
  std::vector<std::string> petsc;
};

Arguments split(int argc, char** argv) {
  char** const end = argv + argc;
  char** const cut = std::find_if(argv, end, [](const char* word) { return std::string_view(word) == "--"; });
  return {{argv, cut}, {cut == end ? end : cut + 1, end}};
}

Override parse_override(const std::string& text) {
  const auto equals = text.find('=');
  if (equals == std::string::npos || equals == 0)
    throw InputError(fmt::format("--set {}: write --set key=value, e.g. --set time.max_step=0.005", text));
  return {text.substr(0, equals), text.substr(equals + 1)};
}

/// The bar needs a terminal; mpirun puts something that looks like one between, so there only --progress bar
/// gives it.
ProgressStyle style_of(const std::string& word) {
  const bool under_mpirun = std::getenv("OMPI_COMM_WORLD_SIZE") || std::getenv("PMI_RANK");
  const bool bar = word == "bar" || (word == "auto" && !under_mpirun && isatty(STDOUT_FILENO));
  return bar ? ProgressStyle::bar : ProgressStyle::lines;
}

/// Of a value that was forgotten, CLI11 takes the next option for it.
std::string refuse_option(const std::string& value) {
  return value.starts_with("--") ? fmt::format("its value is missing before {}", value) : "";
}

/// What nothing here knows, in the order given.
void tell_of_extras(const std::vector<std::string>& extras) {
  const bool ranks = std::find(extras.begin(), extras.end(), "--ranks") != extras.end();
  fmt::print(stderr, "taut: {}: not known here; {}\n", fmt::join(extras, " "),
             ranks ? "ranks are what mpirun starts: mpirun -n 4 taut ..., of which taut info tells too"
                   : "taut COMMAND --help lists what is");
}

class CommandLine {
public:
  CommandLine() : app_("Taut - cloth that does not stretch, on many ranks", "taut") {
    app_.require_subcommand(1);
    app_.set_version_flag("--version", std::string("taut ") + TAUT_VERSION);
    app_.footer(examples_of("") + std::string(notes));
    run_ = app_.add_subcommand("run", "Simulate a case");
    resume_ = app_.add_subcommand("resume", "Go on with a run from its last checkpoint");
    check_ = app_.add_subcommand("check", "Validate a case, its mesh and options, and say what is wrong");
    info_ = app_.add_subcommand("info", "Say in words what a run folder or a case file holds");
    partition_ =
        app_.add_subcommand("partition", "Cut the cloth of a case for a number of ranks, without running it");
    mesh_ = app_.add_subcommand("mesh", "Mesh the panels of a sewing pattern, for cases and to look at");
    export_ = app_.add_subcommand("export", "Write the frames of a run as other programs read them");
    fabrics_ =
        app_.add_subcommand("fabrics", "Print the named fabrics: values, drape and where they are from");
    schema_ = app_.add_subcommand("schema", "Print the JSON Schema of case files");
    check_
        ->add_option("case", case_, "The case file (YAML); or a folder with a run: verifies the files in it")
        ->required();
    check_->add_flag("--thorough", thorough_, "Also try what may take long: to untangle the start");
    for (CLI::App* command : {run_, partition_})
      command->add_option("case", case_, "The case file (YAML)")->required();
    for (CLI::App* command : {run_, resume_, check_, info_, partition_})
      command->add_option("--set", sets_, "Replace a key of the case: --set time.max_step=0.005")
          ->type_name("KEY=VALUE")
          ->take_all();
    run_->add_option("--out", out_, "Folder for the results (default: out/<name of the case>)")
        ->type_name("FOLDER");
    run_->add_option("--from", from_, "Begin with the cloth of this run as it is in its last frame")
        ->type_name("FOLDER");
    run_->add_flag("--overwrite", overwrite_, "Replace a run that the folder holds already");
    run_->add_option("--counters", counters_,
                     "Also count messages, bytes and reductions of each phase, into this file (JSON)")
        ->type_name("FILE");
    for (CLI::App* command : {run_, resume_})
      command->add_option("--progress", progress_, "How to tell of progress: auto, lines or bar")
          ->check(CLI::IsMember({"auto", "lines", "bar"}));
    resume_->add_option("folder", path_, "The folder of the run")->required();
    resume_
        ->add_option("--checkpoint", checkpoint_, "Go on from this one (default: the latest in the folder)")
        ->type_name("FILE");
    info_->add_option("path", path_, "A folder with a run, or a case file")->required();
    partition_->add_option("--ranks", ranks_, "The number of ranks to cut it for")->required();
    partition_->add_option("--json", json_, "Also write the figures to this file")->type_name("FILE");
    add_options_of_files();
    schema_->add_flag("--table", table_, "A Markdown table instead");
    for (CLI::App* command : app_.get_subcommands(nullptr)) complete(*command);
  }

  int execute(MPI_Comm comm, const Arguments& arguments) {
    check_command(arguments);
    check_dashes(arguments);
    try {
      app_.parse(int(arguments.own.size()), arguments.own.data());
    } catch (const CLI::ExtrasError&) {
      if (rank_of(comm) == 0) tell_of_extras(app_.remaining(true));
      return input_error;
    } catch (const CLI::ParseError& e) {
      const int code = rank_of(comm) == 0 ? app_.exit(e) : e.get_exit_code();
      return code == 0 ? success : input_error;
    }
    if (*schema_) return print(comm, table_ ? case_table() : case_schema());
    if (*fabrics_) return print(comm, config::fabric_table());
    if (*mesh_) return mesh(comm, {case_, edges_, out_, svg_});
    if (*export_) return export_frames(comm, {path_, out_, up_, unit_, frame_});
    std::vector<Override> overrides;
    for (const std::string& s : sets_) overrides.push_back(parse_override(s));
    if (*resume_) return resume(comm, {path_, overrides, arguments.petsc, checkpoint_, style_of(progress_)});
    const CaseSource source{case_, overrides, arguments.petsc};
    if (*info_) return info(comm, {path_, overrides, arguments.petsc});
    if (*check_) return is_folder(comm, case_) ? check_run(comm, case_) : check(comm, {source, depth()});
    if (*partition_) return partition(comm, {source, ranks_, json_});
    return run(comm, {source, out_, overwrite_ ? ExistingRun::overwrite : ExistingRun::refuse,
                      style_of(progress_), from_, counters_});
  }

private:
  /// Of the commands that read one file and write others.
  void add_options_of_files() {
    mesh_->add_option("pattern", case_, "The sewing pattern: of GarmentCode (.json), or by hand (.yaml)")
        ->required();
    mesh_->add_option("--edge", edges_, "How long edges are to be: 5mm; those of a panel: collar=2mm")
        ->type_name("LENGTH or PANEL=LENGTH")
        ->required()
        ->take_all();
    mesh_->add_option("-o,--out", out_, "The mesh file to write, .h5 or .obj")->type_name("FILE");
    mesh_->add_option("--svg", svg_, "Draw the panels into this file")->type_name("FILE");
    export_->add_option("folder", path_, "The folder of the run")->required();
    export_
        ->add_option("--to", out_,
                     "cloth.pc2 (with cloth.obj), .obj or .ply (a file a frame), .usda (one frame)")
        ->required();
    export_->add_option("--up", up_, "The axis that points up there: z (as in the run) or y")
        ->type_name("AXIS");
    export_->add_option("--unit", unit_, "Of lengths there: m, cm or mm")->type_name("UNIT");
    export_->add_option("--frame", frame_, "Only this one");
  }

  void complete(CLI::App& command) {
    for (CLI::Option* option : command.get_options())
      if (option->get_items_expected_min() > 0) option->check(CLI::Validator(refuse_option, ""));
    command.footer(examples_of(command.get_name()) + (&command == run_ ? std::string(notes) : ""));
  }

  /// CLI11 would only say that a command is missing.
  void check_command(const Arguments& arguments) const {
    if (arguments.own.size() < 2 || arguments.own[1][0] == '-') return;
    const std::string word = arguments.own[1];
    std::vector<std::string> commands;
    for (const CLI::App* command : app_.get_subcommands(nullptr)) commands.push_back(command->get_name());
    if (std::ranges::find(commands, word) != commands.end()) return;
    throw InputError(fmt::format("there is no command '{}'; commands are {}, see taut --help", word,
                                 fmt::join(commands, ", ")));
  }

  /// PETSc's own way to write options, before --.
  static void check_dashes(const Arguments& arguments) {
    for (const std::string word : arguments.own)
      if (word.size() > 2 && word[0] == '-' && std::isalpha(static_cast<unsigned char>(word[1])))
        throw InputError(
            fmt::format("{}: PETSc options stand behind --, as in: taut run case.yaml -- {}; those of "
                        "taut begin with two dashes",
                        word, word));
  }

  CheckDepth depth() const { return thorough_ ? CheckDepth::thorough : CheckDepth::quick; }

  static bool is_folder(MPI_Comm comm, const std::string& path) {
    return any_of(comm, rank_of(comm) == 0 && std::filesystem::is_directory(path));
  }

  static int print(MPI_Comm comm, const std::string& text) {
    if (rank_of(comm) == 0) fmt::print("{}\n", text);
    return success;
  }

  CLI::App app_;
  CLI::App *run_, *resume_, *check_, *info_, *partition_, *mesh_, *export_, *fabrics_, *schema_;
  std::string case_, out_, svg_, path_, from_, checkpoint_, json_, counters_, progress_ = "auto", up_ = "z",
                                                                              unit_ = "m";
  std::optional<Global> frame_;
  int ranks_ = 1;
  std::vector<std::string> sets_, edges_;
  bool overwrite_ = false, table_ = false, thorough_ = false;
};

/// Of this rank alone. Installed as the handler of `new`: an exception would close files on its way here,
/// which is collective, and so wait for ranks that know of nothing.
[[noreturn]] void end_without_memory() {
  fmt::print(stderr, "taut: rank {}: not enough memory; use more ranks on more machines, or a smaller mesh\n",
             rank_of(MPI_COMM_WORLD));
  MPI_Abort(MPI_COMM_WORLD, internal_error);
  std::abort();
}

} // namespace

int main(int argc, char** argv) {
  const Arguments arguments = split(argc, argv);
  const Session session(argc, argv, arguments.petsc);
  const int rank = rank_of(MPI_COMM_WORLD);
  std::set_new_handler(end_without_memory);
  try {
    return CommandLine().execute(MPI_COMM_WORLD, arguments);
  } catch (const InputError& e) { // thrown on all ranks alike
    if (rank == 0) fmt::print(stderr, "taut: {}\n", e.what());
    return input_error;
  } catch (const std::bad_alloc&) { // of memory that did not come from `new`
    end_without_memory();
  } catch (const std::exception& e) { // perhaps on this rank only: the others must not wait for it
    fmt::print(stderr, "taut: rank {}: {}\n", rank, e.what());
    MPI_Abort(MPI_COMM_WORLD, internal_error);
  }
}
