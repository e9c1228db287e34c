#include <chrono>
#include <filesystem>

#include "app/verbs/describe.h"
#include "app/verbs/record.h"
#include "app/verbs/verb.h"
#include "core/deform/fold_guard.h"
#include "core/session/case_file.h"

namespace homolog {

namespace fs = std::filesystem;

namespace {

struct ReplayVerb {
  fs::path file, out;
  std::string scheme;
  double spacing = -1;
  int events = 0;
  int frame = -1;
  std::string structure;
  GivenCommand command;
};

ReplayOptions replay_options(const ReplayVerb& verb, Progress& progress) {
  ReplayOptions options;
  if (verb.scheme == "anchored") options.scheme = Scheme::anchored;
  if (verb.scheme == "paper") options.scheme = Scheme::paper;
  if (verb.scheme == "raw") options.scheme = Scheme::raw;
  if (verb.spacing >= 0) options.even_spacing = verb.spacing;
  if (verb.events > 0) options.paper_events = verb.events;
  options.from_checkpoint = false;  // what is asked for is what the lines give
  options.progress = &progress;
  return options;
}

Result<Report> replay(const ReplayVerb& verb, Progress& progress) {
  const auto start = std::chrono::steady_clock::now();
  auto read = read_case(verb.file, replay_options(verb, progress));
  if (!read) return fail(read.error());
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  const Document& document = read->session.document();
  const int frame = verb.frame >= 0 ? verb.frame : document.frame;
  const auto chosen = choose_structure(document, verb.file, verb.structure);
  if (!chosen) return fail(chosen.error());
  const Structure* structure = document.structure(chosen->id);
  const Shape* shape = structure != nullptr ? structure->shape(frame) : nullptr;
  if (shape == nullptr) {
    return fail(verb.file.string(), "has no mesh in frame " + std::to_string(frame) + "; choose another with --frame");
  }
  auto record = record_of(verb.command, progress);
  if (!record) return fail(record.error());
  MeshFile mesh = to_mesh_file({*structure, *shape, frame}, document.scan.frames() > 1);
  mesh.record = std::move(*record);
  if (auto written = write_mesh_file(mesh, verb.out); !written) return fail(written.error());
  const auto turned = turned_triangles(*structure->the_template->topology, *shape->placed, mesh.points);
  if (!chosen->warning.empty()) read->warnings.push_back(chosen->warning);
  return Report{{{"strokes", read->session.strokes()},
                 {"turned_triangles", turned.size()},
                 {"solves", read->session.solves()},
                 {"seconds", seconds}},
                read->warnings};
}

}  // namespace

void add_replay(CLI::App& app, CommandLine& asked) {
  auto options = std::make_shared<ReplayVerb>();
  CLI::App* verb = add_verb(app, "replay", "Plays a case file and writes the mesh it gives");
  verb->add_option("CASE", options->file, "The case file")->required();
  keeps_correspondence(verb->add_option("-o,--output", options->out, "The mesh to write")->required());
  verb->add_option("--scheme", options->scheme, "Overrides the case's scheme")
      ->check(CLI::IsMember({"anchored", "paper", "raw"}));
  verb->add_option("--spacing", options->spacing, "Overrides the case's even spacing, 0 to 1")
      ->check(CLI::Range(0.0, 1.0));
  verb->add_option("--events", options->events, "Mouse events that a stroke stands for in the scheme paper")
      ->check(CLI::Range(1, 1000));
  verb->add_option("--structure", options->structure,
                   "Of a case of several structures the mesh of this one, by name (default: the first)");
  verb->add_option("--frame", options->frame, "Which frame's mesh to write (default: the one shown last)")
      ->check(CLI::NonNegativeNumber);
  verb->callback([options, verb, &asked] {
    if (!options->scheme.empty() && options->scheme != "paper")
      refuse_without_effect(*verb, "--events", "the scheme paper");
    options->command = given_command(*verb);
    asked.run = [options](Progress& progress) { return replay(*options, progress); };
  });
}

}  // namespace homolog
